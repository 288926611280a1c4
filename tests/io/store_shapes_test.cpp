// Files of distances and of paths: written, read back, and refused where they do not keep the contract.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/store/distance_file.h"
#include "io/store/file_kind.h"
#include "io/store/hdf5_file.h"
#include "io/store/path_file.h"
#include "tests/io/store_samples.h"

namespace ricci {
namespace {

using namespace store_samples;

DistanceRecord sample_distances() {
    DistanceRecord r;
    r.type = "g1b0";
    r.metric = "spectrum";
    r.linkage = "average";
    r.shapes = {"a.off", "b.off", "c.off#c1"};
    r.distances = {0, 1, 3, 1, 0, 2, 3, 2, 0};
    r.merge_first = {0, 3};
    r.merge_second = {1, 2};
    r.merge_height = {1.0, 2.5};
    r.leaf_order = {0, 1, 2};
    r.cluster = {0, 0, 1};
    return r;
}

PathRecord sample_path() {
    PathRecord r;
    const double none = std::numeric_limits<double>::quiet_NaN();
    r.type = "g1b0";
    r.names = {"modulus_re", "modulus_im"};
    r.files = {"0.off", "1.off"};
    r.marking = {"own", "none"};
    r.message = {"", "did not converge"};
    r.status = {0, 1};
    r.marking_number = {0, -1};
    r.coordinates = {0.25, 1.5, none, none};
    r.fingerprint = {0.1, 0.2, 0.3, none, none, none};
    r.step = r.free_step = r.length = r.marking_gap = r.marking_spread = {0.0, none};
    return r;
}

/// Equal, NaN to NaN.
void expect_same(const std::vector<double>& a, const std::vector<double>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        EXPECT_TRUE(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i])));
}

TEST(DistanceFile, ComesBackAsItWas) {
    const TemporaryFolder folder;
    const std::string path = folder.file("d.h5");
    const DistanceRecord r = sample_distances();
    write_distance_file(path, sample_info(), {r});
    EXPECT_EQ(kind_of_file(path), "distances");
    const DistanceFile file = read_distance_file(path);
    ASSERT_EQ(file.records.size(), 1U);
    const DistanceRecord& s = file.records.front();
    EXPECT_EQ(std::tie(s.type, s.metric, s.linkage, s.shapes, s.distances),
              std::tie(r.type, r.metric, r.linkage, r.shapes, r.distances));
    EXPECT_EQ(std::tie(s.merge_first, s.merge_second, s.merge_height, s.leaf_order, s.cluster),
              std::tie(r.merge_first, r.merge_second, r.merge_height, r.leaf_order, r.cluster));
    EXPECT_TRUE(verify_structure(path).empty());
    EXPECT_THROW(read_path_file(path), FileError);
}

TEST(DistanceFile, ATreeThatJoinsWhatIsNotThereYetIsRefused) {
    const TemporaryFolder folder;
    for (int k = 0; k < 6; ++k) {
        DistanceRecord r = sample_distances();
        if (k == 0) r.merge_first = {3, 3};
        if (k == 1) r.leaf_order = {0, 1, 3};
        if (k == 2) r.cluster = {0, -1, 1};
        if (k == 3) r.merge_second = {1, 1};  // a shape that is joined already
        if (k == 4) r.leaf_order = {0, 1, 1};
        if (k == 5) r.merge_height[1] = std::numeric_limits<double>::infinity();
        // The writer reads back what it wrote, and so refuses it itself.
        EXPECT_THROW(write_distance_file(folder.file("bad.h5"), sample_info(), {r}), FileError) << k;
    }
}

TEST(PathFile, ComesBackAsItWas) {
    const TemporaryFolder folder;
    const std::string path = folder.file("p.h5");
    const PathRecord r = sample_path();
    write_path_file(path, sample_info(), {r, r});
    EXPECT_EQ(kind_of_file(path), "paths");
    const PathFile file = read_path_file(path);
    ASSERT_EQ(file.records.size(), 2U);
    for (const PathRecord& s : file.records) {
        EXPECT_EQ(std::tie(s.type, s.names, s.files, s.marking, s.message, s.status, s.marking_number),
                  std::tie(r.type, r.names, r.files, r.marking, r.message, r.status, r.marking_number));
        expect_same(s.coordinates, r.coordinates);
        expect_same(s.fingerprint, r.fingerprint);
        expect_same(s.length, r.length);
    }
    EXPECT_TRUE(verify_structure(path).empty());
    PathRecord bad = r;
    bad.names.pop_back();
    EXPECT_THROW(write_path_file(folder.file("bad.h5"), sample_info(), {bad}), FileError);
}

}  // namespace
}  // namespace ricci
