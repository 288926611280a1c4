// Small made-up runs for the tests of the result store.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "io/store/hdf5_file.h"
#include "io/store/run_store.h"
#include "tests/support/digests.h"

namespace ricci::store_samples {

using ricci::testing::digests;

/// A fresh folder, removed with the object.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "ricci-store-XXXXXX").string();
        if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
        path_ = pattern;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }

  private:
    std::string path_;
};

inline RunInfo sample_info() {
    RunInfo info;
    info.software_version = "0.1.0";
    info.git = "0123abcd";
    info.command = "ricci sweep a.off";
    info.config = "[sweep]\nvertices = \"all\"\n";
    info.host = "node-1";
    info.fingerprint = "tolerance=1e-10";
    info.threads = 2;
    info.status.names = {"converged",
                         "max_iterations",
                         "inadmissible_target",
                         "inadmissible_metric",
                         "factorization_failed",
                         "stalled",
                         "not_finite",
                         "timeout",
                         "out_of_memory",
                         "cancelled",
                         "invalid_input",
                         "internal_error"};
    return info;
}

/// A torus of n by n quadrilaterals, each cut in two: V = n^2, F = 2 n^2.
inline ItemRecord sample_item(const std::string& name, Index n) {
    ItemRecord item;
    item.name = name;
    item.source = "meshes/" + name + ".off";
    item.source_hash = "00112233445566ff";
    item.units = "mm";
    item.vertices = n * n;
    item.faces = 2 * n * n;
    item.genus = 1;
    const double angle = 2 * std::numbers::pi / n;
    const auto at = [&](Index i, Index j) { return (i % n) * n + j % n; };
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j) {
            const double r = 2 + std::cos(angle * j);
            item.points.push_back({r * std::cos(angle * i), r * std::sin(angle * i), std::sin(angle * j)});
            item.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            item.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
            item.source_vertex.push_back(2 * at(i, j));
        }
    return item;
}

/// Every fifth vertex fails; distortions come in equal pairs, so that ties occur.
inline SweepRow sample_row(Index vertex) {
    SweepRow row;
    row.vertex = vertex;
    row.status = vertex % 5 == 4 ? 1 : 0;
    const Index pair = vertex / 2;
    row.area_distortion =
        row.status == 0 ? std::abs(std::sin(1.0 + pair)) : std::numeric_limits<double>::quiet_NaN();
    row.newton_iterations = static_cast<std::uint16_t>(5 + vertex % 7);
    row.residual_max = 1e-11 / (1 + vertex);
    row.flips = 3 * vertex;
    row.seconds = 0.25F;
    row.gauss_bonnet_error = 0.25 * vertex;
    row.precision_digits = vertex % 3 == 0 ? 19 : 16;
    return row;
}

inline KeptFactor sample_factor(Index vertex, Index vertex_count) {
    KeptFactor factor{vertex, sample_row(vertex).area_distortion, {}};
    for (Index v = 0; v < vertex_count; ++v)
        factor.conformal_factor.push_back(std::sin(vertex + 78.233 * v * v));
    return factor;
}

/// Rows of these vertices, every converged one a candidate.
inline SweepBlock sample_block(const ItemRecord& item, const std::vector<Index>& vertices) {
    SweepBlock block;
    block.item = item.name;
    for (const Index v : vertices) {
        block.rows.push_back(sample_row(v));
        if (block.rows.back().status == 0) block.kept.push_back(sample_factor(v, item.vertices));
    }
    return block;
}

inline std::vector<Index> range(Index from, Index to) {
    std::vector<Index> values;
    for (Index v = from; v < to; ++v) values.push_back(v);
    return values;
}

inline FlowRecord sample_flow(const ItemRecord& item) {
    FlowRecord flow;
    flow.item = item.name;
    flow.geometry = "euclidean";
    flow.scheme = "vertex-scaling";
    flow.method = "newton";
    flow.boundary = "geodesic";
    flow.status = 1;
    flow.newton_iterations = 7;
    flow.flips = 12;
    flow.residual_max = 3e-12;
    flow.gauss_bonnet_error = 1e-14;
    flow.seconds = 0.5;
    flow.precision_digits = 50;
    flow.doubled = true;
    for (Index v = 0; v < item.vertices; ++v) {
        flow.conformal_factor.push_back(0.1 * v);
        flow.conformal_factor_low.push_back(1e-18 * v);
        flow.target_curvature.push_back(0.0);
        flow.curvature.push_back(1e-13 * v);
    }
    flow.triangles = item.triangles;
    for (Index h = 0; h < 3 * item.faces; ++h) {
        flow.twin.push_back(h ^ 1);
        flow.edge_length.push_back(1.0 + h);
    }
    flow.log_residual_max = {1.0, 0.1, 3e-12};
    flow.log_step = {1.0, 0.5, 1.0};
    flow.log_seconds = {0.1, 0.2, 0.2};
    flow.log_flips = {10, 2, 0};
    return flow;
}

/// A result of a further kind with every type of attribute and array, subgroups, scalars and empty arrays; in
/// the order in which it is read back.
inline ResultGroup sample_result(const ItemRecord& item) {
    ResultGroup result{item.name, "layout", 1};
    result.attributes = {{"generators", std::int32_t{4}},
                         {"holonomy_error", 2.5e-13},
                         {"lifted", std::uint8_t{1}},
                         {"sides", std::vector<std::string>{"a1", "b1", "a1'", "b1'"}},
                         {"steps", std::int64_t{-5000000000}},
                         {"surface", std::string("torus \xC3\xA9")},
                         {"warnings", std::vector<std::string>{}}};
    std::vector<double> corners;
    std::vector<std::int32_t> vertices;
    for (Index v = 0; v < item.vertices; ++v) {
        corners.push_back(std::cos(1.0 + v));
        corners.push_back(std::sin(1.0 + v));
        vertices.push_back(v);
    }
    const auto rows = static_cast<std::uint64_t>(item.vertices);
    result.arrays = {{"domain/side", {2}, std::vector<std::string>{"", "a1\nb1"}},
                     {"empty", {0, 3}, std::vector<double>{}},
                     {"generators/deep/er/bit", {2, 1, 2}, std::vector<std::uint8_t>{0, 1, 255, 3}},
                     {"generators/matrix", {}, std::vector<double>{-0.0}},
                     {"no_text", {0}, std::vector<std::string>{}},
                     {"position", {rows, 2}, corners},
                     {"title", {}, std::vector<std::string>{"one"}},
                     {"vertex", {rows}, vertices}};
    return result;
}

/// Everything read_run returns but seconds and the time of creation, as text.
std::string describe(const StoredRun& run);

/// Two items with sweeps, a flow, a result of a further kind and a failure, written as far as it is not
/// finished yet, and assembled.
void write_sample_run(const std::string& path, bool resume);

inline const KeepPolicy kSampleKeep{true, true, 3};

}  // namespace ricci::store_samples
