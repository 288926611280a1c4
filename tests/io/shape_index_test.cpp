// The index file and the store that makes it: reading back, resuming after death, order, contracts.
#include "io/store/shape_index.h"

#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <tuple>

#include "io/store/durable.h"
#include "io/store/index_store.h"
#include "tests/io/store_samples.h"

namespace ricci {
namespace {

using namespace store_samples;
namespace fs = std::filesystem;

constexpr std::int32_t kVersion = 3;

/// Shape number k: types g2b0 and g1b0 in turn, every fifth without coordinates, every third with
/// resolutions.
ShapeRecord shape_of(int k) {
    ShapeRecord shape;
    const double x = 0.1 * k;
    shape.hash = 0xf000000000000000ULL + static_cast<std::uint64_t>(k);
    shape.message = k % 4 == 0 ? "a near-tie in the marking" : "";
    shape.genus = k % 2 == 0 ? 2 : 1;
    shape.vertices = 100 + k;
    shape.faces = 204 + 2 * k;
    shape.fingerprint = shape.genus == 2 ? std::vector<double>{1.0 + x, 2.0 - x, 1.0 / (3.0 + x)}
                                         : std::vector<double>{x, 1.0 + x};
    if (k % 5 != 4) {
        shape.coordinates = shape.genus == 2 ? std::vector<double>{x, x * x} : std::vector<double>{1.0 + x};
        shape.names =
            shape.genus == 2 ? std::vector<std::string>{"a", "b"} : std::vector<std::string>{"ratio"};
    }
    for (int i = 0; i < k % 7; ++i) {
        shape.lengths.push_back(1.0 + 0.3 * i + x);
        shape.primitive.push_back(static_cast<std::uint8_t>(i % 3 != 1));
    }
    shape.complete_up_to = 4.0 + x;
    shape.marking_gap = x;
    shape.residual_max = 1e-13 * x;
    shape.gauss_bonnet_error = 1e-12 * x;
    shape.precision_digits = 19;
    shape.seconds = {0.5, 0.25, 0.125, x};
    if (k % 3 == 0)
        for (const double shift : {0.5, -0.25, 0.0}) {
            ShapeResolution r{50 + k, shape.fingerprint, shape.coordinates};
            for (double& value : r.fingerprint) value += shift;
            for (double& value : r.coordinates) value += 2.0 * shift;
            shape.resolutions.push_back(r);
        }
    return shape;
}

IndexSource source_of(int k) {
    const ShapeRecord shape = shape_of(k);
    return {"meshes/shape \xe2\x88\x9e " + std::to_string(k) + ".off", shape.hash, 0};
}

std::vector<IndexSource> sources_of(int count) {
    std::vector<IndexSource> sources;
    for (int k = 0; k < count; ++k) sources.push_back(source_of(k));
    return sources;
}

/// Describes shapes 0 .. count - 1 that are not known, in blocks of three, and assembles.
int build(const std::string& path, int count, bool resume) {
    IndexStore store(path, sample_info(), kVersion, resume);
    std::vector<ShapeRecord> block;
    int described = 0;
    for (int k = 0; k < count; ++k) {
        if (store.known_components(shape_of(k).hash) == 0) {
            block.push_back(shape_of(k));
            ++described;
        }
        if (block.size() == 3 || k == count - 1) {
            store.write_shapes(block);
            block.clear();
        }
    }
    store.assemble(sources_of(count), {{"bad.off", "load", "invalid_input", "no faces"}});
    return described;
}

void expect_equal(const ShapeRecord& a, const ShapeRecord& b) {
    EXPECT_EQ(a.hash, b.hash);
    EXPECT_EQ(a.component, b.component);
    EXPECT_EQ(a.components, b.components);
    EXPECT_EQ(a.status, b.status);
    EXPECT_EQ(a.message, b.message);
    EXPECT_EQ(std::tie(a.genus, a.boundaries, a.vertices, a.faces),
              std::tie(b.genus, b.boundaries, b.vertices, b.faces));
    EXPECT_EQ(a.fingerprint, b.fingerprint);
    EXPECT_EQ(a.coordinates, b.coordinates);
    EXPECT_EQ(a.names, b.names);
    EXPECT_EQ(a.lengths, b.lengths);
    EXPECT_EQ(a.primitive, b.primitive);
    EXPECT_EQ(a.complete_up_to, b.complete_up_to);
    EXPECT_EQ(a.marking_gap, b.marking_gap);
    EXPECT_EQ(a.residual_max, b.residual_max);
    EXPECT_EQ(a.gauss_bonnet_error, b.gauss_bonnet_error);
    EXPECT_EQ(a.precision_digits, b.precision_digits);
    EXPECT_EQ(a.seconds, b.seconds);
    ASSERT_EQ(a.resolutions.size(), b.resolutions.size());
    for (std::size_t r = 0; r < a.resolutions.size(); ++r) {
        EXPECT_EQ(a.resolutions[r].faces, b.resolutions[r].faces);
        EXPECT_EQ(a.resolutions[r].fingerprint, b.resolutions[r].fingerprint);
        EXPECT_EQ(a.resolutions[r].coordinates, b.resolutions[r].coordinates);
    }
}

TEST(ShapeIndexFile, HoldsWhatWasWrittenInTheOrderOfItsSources) {
    const TemporaryFolder folder;
    const std::string path = folder.file("index.h5");
    EXPECT_EQ(build(path, 20, false), 20);
    EXPECT_EQ(verify_structure(path), std::vector<std::string>());
    EXPECT_FALSE(fs::exists(path + ".parts"));
    const ShapeIndex index = read_shape_index(path);
    EXPECT_EQ(index.descriptor_version, kVersion);
    EXPECT_EQ(index.info.fingerprint, sample_info().fingerprint);
    ASSERT_EQ(index.entries.size(), 20U);
    for (int k = 0; k < 20; ++k) {
        const IndexEntry& entry = index.entries[static_cast<std::size_t>(k)];
        EXPECT_EQ(entry.file, source_of(k).file);
        expect_equal(entry.shape, shape_of(k));
    }
    ASSERT_EQ(index.failures.size(), 1U);
    EXPECT_EQ(index.failures[0].item, "bad.off");
}

TEST(ShapeIndexFile, ReaderGivesOneTypeAsMatrices) {
    const TemporaryFolder folder;
    const std::string path = folder.file("index.h5");
    build(path, 10, false);
    const IndexReader reader(path);
    EXPECT_EQ(reader.types(), (std::vector<std::array<Index, 2>>{{1, 0}, {2, 0}}));
    EXPECT_FALSE(reader.bucket(3, 0).has_value());
    const IndexBucket bucket = reader.bucket(2, 0).value();
    ASSERT_EQ(bucket.files.size(), 5U);
    EXPECT_EQ(bucket.fingerprint_size, 3U);
    EXPECT_EQ(bucket.names, (std::vector<std::string>{"a", "b"}));
    for (std::size_t i = 0; i < 5; ++i) {
        const ShapeRecord shape = shape_of(static_cast<int>(2 * i));
        EXPECT_EQ(bucket.files[i], source_of(static_cast<int>(2 * i)).file);
        EXPECT_EQ(bucket.hash[i], shape.hash);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(bucket.fingerprint[3 * i + c], shape.fingerprint[c]);
        for (std::size_t c = 0; c < 2; ++c) {
            if (shape.coordinates.empty())
                EXPECT_TRUE(std::isnan(bucket.coordinates[2 * i + c]));
            else
                EXPECT_EQ(bucket.coordinates[2 * i + c], shape.coordinates[c]);
        }
    }
}

TEST(ShapeIndexFile, ErrorBarsAreTheLargestDifferenceFromTheEntry) {
    const TemporaryFolder folder;
    const std::string path = folder.file("index.h5");
    build(path, 7, false);
    const hdf5::Session session;
    const hdf5::Handle file = hdf5::open_input(path);
    const hdf5::Handle group = hdf5::open_group(file, "buckets/g2b0/resolutions");
    const auto spread = hdf5::read_array<double>(group, "fingerprint_spread", hdf5::Shape{4, 3});
    const auto coordinates = hdf5::read_array<double>(group, "coordinates_spread", hdf5::Shape{4, 2});
    // Shapes 0, 2, 4, 6: the first and the last have resolutions, shifted by 1/2 and twice that at most; the
    // third has no coordinates. The shifts are exact up to the rounding of the sum.
    for (const std::size_t row : {0U, 3U}) {
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(spread[3 * row + c], 0.5, 1e-15);
        for (std::size_t c = 0; c < 2; ++c) EXPECT_NEAR(coordinates[2 * row + c], 1.0, 1e-15);
    }
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(spread[3 + c], 0.0);
    EXPECT_TRUE(std::isnan(coordinates[4]));
}

TEST(ShapeIndexFile, RefusesWhatDoesNotFitTogether) {
    const TemporaryFolder folder;
    IndexStore store(folder.file("index.h5"), sample_info(), kVersion, false);
    const auto refused = [&](const std::function<void(ShapeRecord&)>& spoil) {
        ShapeRecord shape = shape_of(0);
        spoil(shape);
        EXPECT_THROW(store.write_shapes({shape}), std::invalid_argument);
    };
    refused([](ShapeRecord& s) { s.fingerprint.clear(); });
    refused([](ShapeRecord& s) { s.fingerprint[1] = std::numeric_limits<double>::quiet_NaN(); });
    refused([](ShapeRecord& s) { s.names.pop_back(); });
    refused([](ShapeRecord& s) { s.primitive.push_back(1); });
    refused([](ShapeRecord& s) { s.component = 1; });
    refused([](ShapeRecord& s) { s.resolutions[0].fingerprint.pop_back(); });
    ShapeRecord longer = shape_of(2);
    longer.fingerprint.push_back(1.0);
    EXPECT_THROW(store.write_shapes({shape_of(0), longer}), std::invalid_argument) << "one size per type";
    store.write_shapes({shape_of(0)});
    EXPECT_THROW(store.write_shapes({shape_of(0)}), std::invalid_argument) << "known";
    store.write_shapes({longer});
    EXPECT_THROW(store.assemble(sources_of(3), {}), std::invalid_argument) << "one is not described";
    EXPECT_THROW(store.assemble({source_of(0), source_of(2)}, {}), std::invalid_argument) << "other sizes";
    store.assemble({source_of(0)}, {});
    EXPECT_THROW(store.write_shapes({shape_of(1)}), std::logic_error);
}

TEST(ShapeIndexFile, AFileWithResultsIsNoIndex) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    write_sample_run(path, false);
    EXPECT_THROW(read_shape_index(path), FileError);
    EXPECT_THROW(IndexReader{path}, FileError);
    EXPECT_THROW(read_shape_index(folder.file("none.h5")), FileError);
}

TEST(IndexStore, LendsTheShapesOfAnIndexMadeAlike) {
    const TemporaryFolder folder;
    const std::string path = folder.file("index.h5"), fresh = folder.file("fresh.h5");
    build(path, 8, false);
    EXPECT_EQ(build(path, 12, false), 4) << "eight are known";
    build(fresh, 12, false);
    EXPECT_EQ(digests(path), digests(fresh));
    RunInfo other = sample_info();
    other.fingerprint += " changed";
    EXPECT_EQ(IndexStore(path, other, kVersion, false).known_components(shape_of(0).hash), 0);
    EXPECT_EQ(IndexStore(path, sample_info(), kVersion + 1, false).known_components(shape_of(0).hash), 0);
    const IndexStore same(path, sample_info(), kVersion, false);
    EXPECT_EQ(same.known_components(shape_of(0).hash), 1);
    EXPECT_TRUE(same.notes().empty());
}

TEST(IndexStore, TwoFilesWithTheSameBytesAreOneShapeAndTwoEntries) {
    const TemporaryFolder folder;
    const std::string path = folder.file("index.h5");
    {
        IndexStore store(path, sample_info(), kVersion, false);
        store.write_shapes({shape_of(0)});
        store.assemble({source_of(0), {"copy.off", shape_of(0).hash, 0}}, {});
    }
    const ShapeIndex index = read_shape_index(path);
    ASSERT_EQ(index.entries.size(), 2U);
    EXPECT_EQ(index.entries[1].file, "copy.off");
    expect_equal(index.entries[0].shape, index.entries[1].shape);
}

TEST(IndexStore, WhatDidNotConvergeIsAFailureAndKnownToAResume) {
    const TemporaryFolder folder;
    const std::string path = folder.file("index.h5");
    ShapeRecord good = shape_of(0), bad = shape_of(1);
    good.components = bad.components = 2;
    bad.hash = good.hash;
    bad.component = 1;
    bad.status = 1;
    bad.message = "why";
    { IndexStore(path, sample_info(), kVersion, false).write_shapes({bad, good}); }
    IndexStore store(path, sample_info(), kVersion, true);
    EXPECT_EQ(store.known_components(good.hash), 2);
    EXPECT_EQ(store.shape(good.hash, 1).message, "why");
    store.assemble({{"two.off", good.hash, 0}, {"two.off", good.hash, 1}}, {});
    const ShapeIndex index = read_shape_index(path);
    ASSERT_EQ(index.entries.size(), 1U);
    ASSERT_EQ(index.failures.size(), 1U);
    EXPECT_EQ(index.failures[0].item, "two.off#c1");
    EXPECT_EQ(index.failures[0].status, sample_info().status.names[1]);
    EXPECT_EQ(index.failures[0].message, "why");
    EXPECT_EQ(IndexStore(path, sample_info(), kVersion, false).known_components(good.hash), 0)
        << "a later build tries again";
}

TEST(IndexStore, AnotherRunsPartsCannotBeResumed) {
    const TemporaryFolder folder;
    const std::string path = folder.file("index.h5");
    { IndexStore(path, sample_info(), kVersion, false).write_shapes({shape_of(0)}); }
    EXPECT_THROW(IndexStore(path, sample_info(), kVersion + 1, true), std::invalid_argument);
    EXPECT_EQ(IndexStore(path, sample_info(), kVersion, true).known_components(shape_of(0).hash), 1);
}

bool killed_at(const std::string& path, const std::string& fault, bool resume) {
    const pid_t child = ::fork();
    if (child == 0) {
        ::setenv("RICCI_FAULT", fault.c_str(), 1);
        try {
            build(path, 10, resume);
        } catch (const std::exception&) {
            ::_exit(9);
        }
        ::_exit(0);
    }
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    const bool killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
    EXPECT_TRUE(killed || (WIFEXITED(status) && WEXITSTATUS(status) == 0)) << fault << ": " << status;
    return killed;
}

/// Four segments of three shapes at most, a journal line each; blocks in flight at death are lost, no others.
TEST(IndexStore, KilledAnywhereAndResumedEqualsUndisturbed) {
    const TemporaryFolder folder;
    build(folder.file("reference.h5"), 10, false);
    const auto reference = digests(folder.file("reference.h5"));
    const std::vector<std::pair<std::string, int>> points = {
        {"segment_filled", 4},  {"segment_written", 4},    {"segment_renamed", 4}, {"journal_half", 4},
        {"journal_written", 4}, {"segment_journalled", 4}, {"assembled", 1},       {"assembled_renamed", 1}};
    for (const auto& [point, passes] : points) {
        for (int pass = 1; pass <= passes; ++pass) {
            const std::string fault = point + ":" + std::to_string(pass);
            const std::string path = folder.file(fault + ".h5");
            ASSERT_TRUE(killed_at(path, fault, false)) << fault;
            const bool proved = point == "journal_written" || point == "segment_journalled";
            const int lost = std::max(0, 10 - 3 * (proved ? pass : pass - 1));
            EXPECT_EQ(build(path, 10, true), passes == 1 ? 0 : lost) << fault;
            EXPECT_EQ(digests(path), reference) << fault;
            EXPECT_EQ(verify_structure(path), std::vector<std::string>()) << fault;
            EXPECT_FALSE(fs::exists(path + ".parts")) << fault;
        }
    }
}

TEST(IndexStore, ADamagedSegmentCountsAsUnfinished) {
    const TemporaryFolder folder;
    const std::string path = folder.file("index.h5");
    ASSERT_TRUE(killed_at(path, "segment_journalled:3", false));
    const std::string segment = path + ".parts/shapes-000002.h5";
    std::string bytes = ricci::read_text(segment);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
    write_text_durably(segment, bytes);
    {
        const IndexStore store(path, sample_info(), kVersion, true);
        ASSERT_EQ(store.notes().size(), 1U);
        EXPECT_NE(store.notes()[0].find("3 shapes"), std::string::npos) << store.notes()[0];
    }
    EXPECT_EQ(build(path, 10, true), 4) << "three of the damaged block, and the last";
    build(folder.file("reference.h5"), 10, false);
    EXPECT_EQ(digests(path), digests(folder.file("reference.h5")));
}

TEST(IndexStore, VerifyFindsADamagedIndex) {
    const TemporaryFolder folder;
    const std::string path = folder.file("index.h5");
    build(path, 6, false);
    {
        const hdf5::Session session;
        const hdf5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), path);
        const hdf5::Handle order(H5Dopen2(file, "buckets/g2b0/order", H5P_DEFAULT), path);
        const std::vector<std::int32_t> values{0, 2, 2};
        hdf5::check(H5Dwrite(order, H5T_NATIVE_INT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path);
    }
    const std::vector<std::string> complaints = verify_structure(path);
    EXPECT_GE(complaints.size(), 2U) << "the checksum, and the numbering";
    EXPECT_THROW(read_shape_index(path), FileError);
}

}  // namespace
}  // namespace ricci
