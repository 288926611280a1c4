// verify_structure: files that are wrong in every way we could think of.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>

#include "io/store/durable.h"
#include "io/store/guarded_child.h"
#include "io/store/schema.h"
#include "tests/io/store_samples.h"

namespace ricci {
namespace {

using namespace store_samples;

void write_bytes(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

TEST(StoreVerify, TruncationIsFoundAtAnyLength) {
    const TemporaryFolder folder;
    write_sample_run(folder.file("run.h5"), false);
    const std::string bytes = read_text(folder.file("run.h5"));
    const std::string bad = folder.file("bad.h5");
    for (std::size_t part = 0; part < 20; ++part) {
        write_bytes(bad, bytes.substr(0, bytes.size() * part / 20));
        EXPECT_FALSE(verify_structure(bad).empty()) << part << "/20";
    }
    write_bytes(bad, bytes.substr(0, bytes.size() - 1));
    EXPECT_FALSE(verify_structure(bad).empty());
    write_bytes(bad, bytes);
    EXPECT_EQ(verify_structure(bad), std::vector<std::string>());
}

// What a sound verdict promises: whatever read_run returns is what was written. Bits that carry nothing (gaps
// between objects) may flip unseen.
TEST(StoreVerify, FlippedBitsAreFoundOrHarmless) {
    const TemporaryFolder folder;
    write_sample_run(folder.file("run.h5"), false);
    const std::string reference = describe(read_run(folder.file("run.h5")));
    const std::string bytes = read_text(folder.file("run.h5"));
    const std::string bad = folder.file("bad.h5");
    std::mt19937 random(7);
    int found = 0;
    constexpr int kFlips = 400;
    for (int i = 0; i < kFlips; ++i) {
        const std::size_t bit = std::uniform_int_distribution<std::size_t>(0, 8 * bytes.size() - 1)(random);
        std::string flipped = bytes;
        flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
        write_bytes(bad, flipped);
        if (!verify_structure(bad).empty())
            ++found;
        else
            EXPECT_EQ(describe(read_run(bad)), reference) << "bit " << bit;
    }
    RecordProperty("found", found);
    EXPECT_GT(found, kFlips / 2);
}

TEST(StoreVerify, FlippedBitInAFilteredDatasetIsFound) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    const ItemRecord item = sample_item("a@20000", 100);  // points: 240 kB, one filtered chunk
    {
        RunStore store(path, sample_info(), false);
        store.write_item(item);
        store.assemble({item.name}, kSampleKeep);
    }
    std::string bytes = read_text(path);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    write_bytes(path, bytes);
    EXPECT_FALSE(verify_structure(path).empty());
}

// A result file whose checksums are right whatever else is wrong.
struct Forgery {
    ItemRecord item = sample_item("a@32", 4);
    std::vector<SweepRow> rows;
    std::optional<KeptFactor> best, worst;
    std::vector<Index> kept{2};
    StatusNames names = sample_info().status;       // of the root
    StatusNames enum_names = sample_info().status;  // of sweep/status
    std::int64_t keep_count = 3;
    std::int32_t complete = 1;
    std::string without;  // link below the item to leave out, "" for none
    Forgery() {
        for (const Index v : {0, 1, 2, 4, 6}) rows.push_back(sample_row(v));
        best = sample_factor(6, item.vertices);   // |sin 4| = 0.757
        worst = sample_factor(2, item.vertices);  // |sin 2| = 0.909
        kept = {0, 1};                            // |sin 1| = 0.841, both
    }

    [[nodiscard]] std::vector<std::string> verdict() const {
        const TemporaryFolder folder;
        const std::string path = folder.file("forged.h5");
        {
            const hdf5::Session session;
            hdf5::write_file(path, [&](hdf5::OutputFile& file) { write(file.root()); });
        }
        return verify_structure(path);
    }
    void write(hid_t root) const {
        RunInfo info = sample_info();
        info.status = names;
        schema::write_run_info(root, info, "2000-01-01T00:00:00Z");
        const hdf5::Handle items = hdf5::create_group(root, "items");
        const hdf5::Handle group = hdf5::create_group(items, item.name);
        schema::write_item(group, item);
        const hdf5::Handle sweep = hdf5::create_group(group, "sweep");
        hdf5::write_attribute<std::uint8_t>(sweep, "keep_best", 1);
        hdf5::write_attribute<std::uint8_t>(sweep, "keep_worst", 1);
        hdf5::write_attribute<std::int64_t>(sweep, "keep_count", keep_count);
        hdf5::seal(sweep);
        schema::write_rows(sweep, rows, enum_names);
        if (best) schema::write_extreme(sweep, "best", *best);
        if (worst) schema::write_extreme(sweep, "worst", *worst);
        const hdf5::Handle others = hdf5::create_group(sweep, "kept");
        hdf5::write_array(others, "vertex", kept);
        hdf5::RowWriter writer(others, "conformal_factor", kept.size(), 16);
        for (const Index v : kept) writer.append(sample_factor(v, 16).conformal_factor);
        writer.finish();
        schema::write_flow(hdf5::create_group(group, "flow"), sample_flow(item), names);
        if (!without.empty()) hdf5::check(H5Ldelete(group, without.c_str(), H5P_DEFAULT), without);
        schema::write_failures(root, {});
        hdf5::write_attribute<std::int32_t>(root, "complete", complete);
    }
};

// Expects a first complaint that holds `text`.
void expect_complaint(const Forgery& forgery, const std::string& text) {
    const std::vector<std::string> complaints = forgery.verdict();
    ASSERT_FALSE(complaints.empty()) << "expected: " << text;
    EXPECT_NE(complaints.front().find(text), std::string::npos) << complaints.front();
}

TEST(StoreVerify, TheForgerKnowsTheTrade) {
    EXPECT_EQ(Forgery().verdict(), std::vector<std::string>());
}

TEST(StoreVerify, RowsOutOfOrder) {
    Forgery forgery;
    std::swap(forgery.rows[1], forgery.rows[2]);
    expect_complaint(forgery, "/items/a@32/sweep/vertex: not ascending at row 2");
    forgery = {};
    forgery.rows.push_back(sample_row(16));
    expect_complaint(forgery, "row 5 names no vertex");
    forgery.rows.back() = sample_row(6);
    expect_complaint(forgery, "not ascending at row 5");
}

TEST(StoreVerify, EnumOfOtherNames) {
    Forgery forgery;
    forgery.enum_names.names[1] = "max_iterationz";
    expect_complaint(forgery, "/items/a@32/sweep/status has the wrong type");
    forgery = {};
    forgery.enum_names.names.pop_back();
    expect_complaint(forgery, "sweep/status has the wrong type");
    forgery = {};
    std::swap(forgery.enum_names.names[2], forgery.enum_names.names[3]);
    expect_complaint(forgery, "sweep/status has the wrong type");
    forgery = {};
    forgery.rows[1].status = 200;
    expect_complaint(forgery, "value 200 has no name");
}

TEST(StoreVerify, BestAndWorstAgainstTheRows) {
    Forgery forgery;
    forgery.best = sample_factor(0, 16);
    expect_complaint(forgery, "sweep/best: vertex 0, but the rows say 6");
    forgery = {};
    forgery.worst->area_distortion += 1e-9;
    expect_complaint(forgery, "sweep/worst: vertex 2, but the rows say 2");
    forgery = {};
    forgery.worst.reset();
    expect_complaint(forgery, "sweep/worst is missing");
    forgery = {};
    for (SweepRow& row : forgery.rows) row.status = 1;
    expect_complaint(forgery, "sweep/best: should not be there");
    forgery = {};
    forgery.best->conformal_factor[3] = std::numeric_limits<double>::quiet_NaN();
    expect_complaint(forgery, "not finite");
    forgery = {};
    forgery.best->conformal_factor.pop_back();
    expect_complaint(forgery, "sweep/best/conformal_factor has shape (15), expected (16)");
}

TEST(StoreVerify, KeptAgainstTheRows) {
    Forgery forgery;
    forgery.kept = {1, 0};
    expect_complaint(forgery, "sweep/kept: not the best first at vertex 0");
    forgery.kept = {4};
    expect_complaint(forgery, "sweep/kept: vertex 4 did not converge");
    forgery.kept = {5};
    expect_complaint(forgery, "sweep/kept: vertex 5 did not converge");
    forgery = {};
    forgery.keep_count = 1;
    expect_complaint(forgery, "more factors than keep_count");
}

TEST(StoreVerify, EveryDatasetIsMissed) {
    for (const char* link : {"mesh",
                             "mesh/triangles",
                             "sweep/vertex",
                             "sweep/status",
                             "sweep/area_distortion",
                             "sweep/newton_iterations",
                             "sweep/residual_max",
                             "sweep/flips",
                             "sweep/seconds",
                             "sweep/gauss_bonnet_error",
                             "sweep/best/vertex",
                             "sweep/best/conformal_factor",
                             "sweep/best/area_distortion",
                             "sweep/worst",
                             "sweep/kept/vertex",
                             "sweep/kept/conformal_factor",
                             "flow/conformal_factor",
                             "flow/target_curvature",
                             "flow/curvature",
                             "flow/triangles",
                             "flow/twin",
                             "flow/edge_length",
                             "flow/log",
                             "flow/log/step",
                             "mesh/points"}) {
        Forgery forgery;
        forgery.without = link;
        EXPECT_FALSE(forgery.verdict().empty()) << link;
    }
}

TEST(StoreVerify, IncompleteFile) {
    Forgery forgery;
    forgery.complete = 0;
    expect_complaint(forgery, "attribute complete is not 1");
}

TEST(StoreVerify, NotAResultFile) {
    const TemporaryFolder folder;
    const std::string path = folder.file("x.h5");
    EXPECT_EQ(verify_structure(path).size(), 1U);
    write_bytes(path, "no HDF5 at all");
    EXPECT_EQ(verify_structure(path).size(), 1U);
    {
        const hdf5::Session session;
        hdf5::write_file(path, [](hdf5::OutputFile&) {});
    }
    const std::vector<std::string> complaints = verify_structure(path);
    ASSERT_EQ(complaints.size(), 1U);
    EXPECT_NE(complaints[0].find("attribute format is missing"), std::string::npos) << complaints[0];
    EXPECT_THROW(read_run(path), FileError);
}

TEST(StoreVerify, ChildThatCrashesLoopsOrDevours) {
    const hdf5::Session session;
    const auto verdict = [](const std::function<std::vector<std::string>()>& work) {
        return run_guarded({1, std::uint64_t{64} << 20U}, work);
    };
    EXPECT_EQ(verdict([] {
                  return std::vector<std::string>{"one", "two"};
              }),
              (std::vector<std::string>{"one", "two"}));
    EXPECT_EQ(verdict([]() -> std::vector<std::string> {
                  std::raise(SIGSEGV);
                  return {};
              }),
              std::vector<std::string>{"reading it crashes (signal 11)"});
    EXPECT_EQ(verdict([]() -> std::vector<std::string> {
                  std::atomic<bool> stop = false;
                  while (!stop) {
                  }
                  return {};
              }),
              std::vector<std::string>{"reading it takes too long"});
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    EXPECT_EQ(verdict([]() -> std::vector<std::string> { return {std::string(std::size_t{1} << 30U, 'x')}; }),
              std::vector<std::string>{"reading it takes too much memory"});
#endif
}

}  // namespace
}  // namespace ricci
