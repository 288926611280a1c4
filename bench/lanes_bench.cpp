// The passes over lanes under each instruction set of this processor. ns_per_face_lane: time of one pass over
// faces times lanes. The baseline to beat is the same pass with plain SSE2 code.
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>

#include "bench/surfaces.h"
#include "kernels/intrinsic_triangulation.h"
#include "kernels/lane_kernels.h"
#include "kernels/lanes.h"

namespace {

using namespace ricci;
using bench::at;

constexpr Index kSizes[] = {11000, 200000};

/// Every lane with a smooth factor of its own and one cone, around which it is -log(distance) as that of a
/// single-cone metric.
struct Input {
    LaneFaces faces;
    LaneEdges edges;
    LaneArray<double> u, shrink, change;
    std::vector<LaneMask> owned;
};

Input make_input(Index face_count) {
    const SurfaceMesh& mesh = bench::generated("eight", face_count, 0.2);
    const auto t = intrinsic_triangulation<long double>(mesh);
    const auto vertices = at(t.connectivity.vertex_count);
    std::vector<Index> row(vertices);
    for (std::size_t v = 0; v < vertices; ++v) row[v] = static_cast<Index>(v);
    Input input{make_lane_faces(t.connectivity, t.log_chord, row),
                make_lane_edges(t.connectivity, t.log_chord, row),
                LaneArray<double>(vertices),
                LaneArray<double>(vertices),
                LaneArray<double>(vertices),
                {}};
    input.owned.assign(at(input.faces.face_count()), 0);
    const double spacing = std::exp(static_cast<double>(t.log_chord[0]));
    for (std::size_t l = 0; l < kLanes; ++l) {
        const Point& cone = mesh.points[(2 * l + 1) * vertices / (2 * kLanes)];
        for (std::size_t v = 0; v < vertices; ++v) {
            const Point& p = mesh.points[v];
            const double distance = std::hypot(p[0] - cone[0], p[1] - cone[1], p[2] - cone[2]);
            input.u[v].lane[l] = -0.5 * std::log(distance + spacing) + 0.2 * std::sin(3 * p[0] + p[1]);
        }
    }
    lane_exponentials(input.u, input.shrink);
    return input;
}

void count(benchmark::State& state, const Input& input, double bytes_per_row_pass, double rows) {
    const double work = static_cast<double>(input.faces.face_count()) * kLanes;
    state.counters["ns_per_face_lane"] = benchmark::Counter(
        work * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    state.SetItemsProcessed(state.iterations() * input.faces.face_count() * kLanes);
    state.SetBytesProcessed(static_cast<std::int64_t>(static_cast<double>(state.iterations()) *
                                                      bytes_per_row_pass * rows * 8 * kLanes));
}

void angle_changes(benchmark::State& state, InstructionSet set, Index faces) {
    Input input = make_input(faces);
    LaneMask broken = 0;
    for (auto _ : state) {
        broken |= detail::add_angle_changes(set, input.faces, input.shrink, input.owned, input.change);
        benchmark::ClobberMemory();
    }
    if (broken != 0) state.SkipWithError("broken triangles");
    // The angles of a face keep their sum.
    double sum = 0.0, size = 0.0;
    for (const auto& row : input.change) {
        sum += row.lane[3];
        size += std::abs(row.lane[3]);
    }
    if (!(std::abs(sum) < 1e-12 * size)) state.SkipWithError("changes do not add up");
    count(state, input, 3, static_cast<double>(input.u.size()));
}

void flips(benchmark::State& state, InstructionSet set, Index faces) {
    const Input input = make_input(faces);
    std::vector<LaneFlip> found;
    for (auto _ : state) {
        detail::find_lane_flips(set, input.edges, input.shrink, input.owned, found);
        benchmark::ClobberMemory();
    }
    state.counters["hits"] = static_cast<double>(found.size());
    count(state, input, 1, static_cast<double>(input.u.size()));
}

void exponentials(benchmark::State& state, InstructionSet set, Index faces) {
    Input input = make_input(faces);
    for (auto _ : state) {
        detail::lane_exponentials(set, input.u, input.shrink);
        benchmark::ClobberMemory();
    }
    for (std::size_t v = 0; v < input.u.size(); ++v)
        if (!(std::abs(input.shrink[v].lane[5] * std::exp(input.u[v].lane[5]) - 1.0) < 1e-14))
            state.SkipWithError("wrong exponential");
    count(state, input, 2, static_cast<double>(input.u.size()));
}

using Pass = void (*)(benchmark::State&, InstructionSet, Index);

const int kRegistered = [] {
    const std::pair<const char*, Pass> passes[] = {{"add_angle_changes", angle_changes},
                                                   {"find_lane_flips", flips},
                                                   {"lane_exponentials", exponentials}};
    for (const auto& [name, pass] : passes)
        for (const Index faces : kSizes)
            for (const InstructionSet set :
                 {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512}) {
                if (set > best_instruction_set()) continue;
                const std::string title =
                    std::string(name) + "/" + std::string(name_of(set)) + "/" + std::to_string(faces);
                benchmark::RegisterBenchmark(title.c_str(), pass, set, faces)->Unit(benchmark::kMicrosecond);
            }
    return 0;
}();

}  // namespace
