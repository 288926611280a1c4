// Results of further kinds: what goes in comes out; what cannot come out is refused; what was forged is
// found.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <numeric>

#include "io/store/schema.h"
#include "tests/io/store_samples.h"

namespace ricci {
namespace {

using namespace store_samples;

TEST(StoreResults, RoundTripOfEveryType) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    const ItemRecord item = sample_item("a@20000", 100);  // position: 160 kB, chunked and filtered
    ResultGroup shuffled = sample_result(item);
    std::reverse(shuffled.attributes.begin(), shuffled.attributes.end());
    std::rotate(shuffled.arrays.begin(), shuffled.arrays.begin() + 3, shuffled.arrays.end());
    const ResultGroup bare{item.name, "atlas_2", 0};
    {
        RunStore store(path, sample_info(), false);
        store.write_item(item);
        EXPECT_FALSE(store.has_result(item.name, "layout"));
        store.write_result(shuffled);
        store.write_result(bare);
        EXPECT_TRUE(std::filesystem::exists(path + ".parts/layout-000002.h5"));
        EXPECT_TRUE(store.has_result(item.name, "layout") && store.has_result(item.name, "atlas_2"));
        EXPECT_FALSE(store.has_result(item.name, "spectrum") || store.has_result("b", "layout"));
        store.assemble({item.name}, kSampleKeep);
        EXPECT_TRUE(store.has_result(item.name, "layout"));
    }
    EXPECT_EQ(verify_structure(path), std::vector<std::string>());
    const StoredRun run = read_run(path);
    ASSERT_EQ(run.items.at(0).results.size(), 2U);
    EXPECT_EQ(run.items[0].results[0], bare);
    EXPECT_EQ(run.items[0].results[1], sample_result(item));
    const auto& zero = std::get<std::vector<double>>(run.items[0].results[1].arrays[3].values);
    EXPECT_TRUE(std::signbit(zero.at(0)));  // which == does not see
}

TEST(StoreResults, ResumeKeepsThemAndOrderDoesNotMatter) {
    const TemporaryFolder folder;
    const ItemRecord a = sample_item("a@32", 4);
    const ItemRecord b = sample_item("b@32", 4);
    std::vector<ResultGroup> results = {sample_result(a), sample_result(b), {a.name, "spectrum", 0}};
    std::map<std::string, std::uint64_t> reference;
    for (int turn = 0; turn < 3; ++turn) {
        const std::string path = folder.file("run.h5");
        std::filesystem::remove(path);
        {
            RunStore store(path, sample_info(), false);
            store.write_item(a);
            store.write_item(b);
        }
        for (const ResultGroup& result : results) RunStore(path, sample_info(), true).write_result(result);
        RunStore store(path, sample_info(), true);
        for (const ResultGroup& result : results) EXPECT_TRUE(store.has_result(result.item, result.kind));
        EXPECT_THROW(store.write_result(results[0]), std::invalid_argument);
        store.assemble({a.name, b.name}, kSampleKeep);
        if (turn == 0) reference = digests(path);
        EXPECT_EQ(digests(path), reference);
        EXPECT_TRUE(reference.contains("/items/b@32/layout/generators/deep/er/bit"));
        std::rotate(results.begin(), results.begin() + 1, results.end());
    }
}

TEST(StoreResults, CompleteOutputTakesAnotherKind) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    write_sample_run(path, false);
    {
        RunStore store(path, sample_info(), true);
        EXPECT_TRUE(store.has_result("a@32", "layout"));
        store.write_result({"b@18", "spectrum", 3});
        store.assemble({"a@32", "b@18"}, kSampleKeep);
    }
    EXPECT_EQ(verify_structure(path), std::vector<std::string>());
    const StoredRun run = read_run(path);
    EXPECT_EQ(run.items.at(0).results, std::vector{sample_result(sample_item("a@32", 4))});
    EXPECT_EQ(run.items.at(1).results, (std::vector{ResultGroup{"b@18", "spectrum", 3}}));
}

TEST(StoreResults, TextThatIsNotUtf8IsEscaped) {
    const TemporaryFolder folder;
    const std::string path = folder.file("run.h5");
    const ItemRecord item = sample_item("a@32", 4);
    RunStore store(path, sample_info(), false);
    store.write_item(item);
    store.write_result({item.name,
                        "layout",
                        0,
                        {{"a", std::string("caf\xE9")}, {"b", std::vector<std::string>{"\xFF"}}},
                        {{"c", {1}, std::vector<std::string>{std::string("x\0y", 3)}}}});
    store.assemble({item.name}, kSampleKeep);
    const ResultGroup read = read_run(path).items.at(0).results.at(0);
    EXPECT_EQ(std::get<std::string>(read.attributes.at(0).value), "caf\\xe9");
    EXPECT_EQ(std::get<std::vector<std::string>>(read.attributes.at(1).value).at(0), "\\xff");
    EXPECT_EQ(std::get<std::vector<std::string>>(read.arrays.at(0).values).at(0), "x\\x00y");
}

TEST(StoreResults, RefusesWhatWouldNotComeBack) {
    const TemporaryFolder folder;
    const ItemRecord item = sample_item("a@32", 4);
    RunStore store(folder.file("run.h5"), sample_info(), false);
    EXPECT_THROW(store.write_result(sample_result(item)), std::invalid_argument);  // no mesh yet
    store.write_item(item);
    const auto refuses = [&](const char* what, const std::function<void(ResultGroup&)>& spoil) {
        ResultGroup result = sample_result(item);
        spoil(result);
        EXPECT_THROW(store.write_result(result), std::invalid_argument) << what;
    };
    for (const char* kind : {"", "mesh", "sweep", "flow", "item", "run", "failure", "retract", "drop", "base",
                             "Layout", "2d", "_x", "a-b", "a/b", "a b", "caf\xC3\xA9", ".."})
        refuses(kind, [&](ResultGroup& r) { r.kind = kind; });
    refuses("status", [](ResultGroup& r) { r.status = 12; });
    for (const char* name : {"", "status", "complete", "xxh3", "attributes_xxh3", "surface", "A", "a/b"})
        refuses(name, [&](ResultGroup& r) { r.attributes[0].name = name; });
    for (const char* path : {"", "/a", "a/", "a//b", "a/B", ".", "a/../b", "vertex", "position", "generators",
                             "vertex/below", "generators/matrix/below", "generators/deep"})
        refuses(path, [&](ResultGroup& r) { r.arrays[1].path = path; });
    using Shape = std::vector<std::uint64_t>;
    const std::uint64_t huge = std::uint64_t{1} << 32U;
    const std::uint64_t third = 0xAAAAAAAAAAAAAAAB;  // 3 * third = 1 modulo 2^64
    for (const Shape& shape : {Shape{3}, Shape{}, Shape{2, 2, 2}, Shape{0, 4}, Shape{huge, huge},
                               Shape{huge, huge, 4}, Shape{3, third, 4}, Shape(33, 1)})
        refuses("shape", [&](ResultGroup& r) { r.arrays[2].shape = shape; });
    store.write_result(sample_result(item));  // nothing of all that stuck
}

// A result file whose checksums are right whatever `spoil` did to the group layout/.
std::string verdict(const std::function<void(hid_t layout)>& spoil, bool sealed = true) {
    const TemporaryFolder folder;
    const std::string path = folder.file("forged.h5");
    const ItemRecord item = sample_item("a@32", 4);
    {
        const hdf5::Session session;
        hdf5::write_file(path, [&](hdf5::OutputFile& file) {
            schema::write_run_info(file.root(), sample_info(), "2000-01-01T00:00:00Z");
            const hdf5::Handle items = hdf5::create_group(file.root(), "items");
            const hdf5::Handle group = hdf5::create_group(items, item.name);
            schema::write_item(group, item);
            const hdf5::Handle layout = hdf5::create_group(group, "layout");
            schema::write_result(layout, sample_result(item), sample_info().status);
            hdf5::check(H5Adelete(layout, "attributes_xxh3"), "seal");
            spoil(layout);
            if (sealed && H5Aexists(layout, "attributes_xxh3") == 0) hdf5::seal(layout);
            schema::write_failures(file.root(), {});
            hdf5::write_attribute<std::int32_t>(file.root(), "complete", 1);
        });
    }
    const std::vector<std::string> complaints = verify_structure(path);
    if (complaints.empty()) {
        EXPECT_EQ(read_run(path).items.at(0).results.size(), 1U);
    }
    return complaints.empty() ? "" : complaints.front();
}

TEST(StoreResults, ForgedGroupsAreFound) {
    const auto names = [](const std::string& text, const std::function<void(hid_t)>& spoil) {
        const std::string complaint = verdict(spoil);
        EXPECT_NE(complaint.find(text), std::string::npos) << text << ": " << complaint;
    };
    EXPECT_EQ(verdict([](hid_t) {}), "");
    EXPECT_NE(verdict([](hid_t) {}, false).find("the attributes have no checksum"), std::string::npos);
    names("attribute status is missing", [](hid_t layout) { H5Adelete(layout, "status"); });
    names("attribute status has other names", [](hid_t layout) {
        H5Adelete(layout, "status");
        hdf5::write_attribute<std::uint8_t>(layout, "status", 1);
    });
    names("the status has no name", [](hid_t layout) {
        H5Adelete(layout, "status");
        schema::write_status(layout, 77, sample_info().status);
    });
    names("attribute size has a type that no result has",
          [](hid_t layout) { hdf5::write_attribute<std::uint64_t>(layout, "size", 1); });
    names("lower-case identifier", [](hid_t layout) { hdf5::write_attribute(layout, "Size", 1.0); });
    names("layout/wide has a type that no result has",
          [](hid_t layout) { hdf5::write_array(layout, "wide", std::vector<std::uint16_t>{1}); });
    names("layout/generators: a subgroup has attributes", [](hid_t layout) {
        const hdf5::Handle generators = hdf5::open_group(layout, "generators");
        hdf5::write_attribute(generators, "order", 1.0);
        hdf5::seal(generators);
    });
    names("layout/void: a subgroup without arrays", [](hid_t layout) { hdf5::create_group(layout, "void"); });
    names("layout/domain/side: attribute xxh3 is missing", [](hid_t layout) {
        const hdf5::Input texts(layout, "domain/side");
        H5Adelete(texts.id(), "xxh3");
    });
    names("layout/domain/side: the values do not match", [](hid_t layout) {
        const hdf5::Input texts(layout, "domain/side");
        const std::vector<const char*> other = {"", "a1\nb2"};
        H5Dwrite(texts.id(), hdf5::text_type(), H5S_ALL, H5S_ALL, H5P_DEFAULT, other.data());
    });
    names("layout: the attributes do not match", [](hid_t layout) {
        hdf5::seal(layout);
        hdf5::write_attribute(layout, "late", 1.0);
    });
}

TEST(StoreResults, ForeignObjectsBesideTheMeshAreFound) {
    const TemporaryFolder folder;
    for (const bool group : {false, true}) {
        const std::string path = folder.file("forged.h5");
        const hdf5::Session session;
        hdf5::write_file(path, [&](hdf5::OutputFile& file) {
            schema::write_run_info(file.root(), sample_info(), "2000-01-01T00:00:00Z");
            const hdf5::Handle items = hdf5::create_group(file.root(), "items");
            const hdf5::Handle item = hdf5::create_group(items, "a@32");
            schema::write_item(item, sample_item("a@32", 4));
            if (group)
                schema::write_result(hdf5::create_group(item, "Layout"), {"a@32", "layout", 0},
                                     sample_info().status);
            else
                hdf5::write_scalar(item, "layout", 1.0);
            schema::write_failures(file.root(), {});
            hdf5::write_attribute<std::int32_t>(file.root(), "complete", 1);
        });
        EXPECT_EQ(verify_structure(path).size(), 1U) << group;
        EXPECT_THROW(read_run(path), FileError) << group;
    }
}

}  // namespace
}  // namespace ricci
