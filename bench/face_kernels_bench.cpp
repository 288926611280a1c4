// Angles of all faces, with and without derivatives: the vectorised kernel against the same mathematics in
// scalar form and in long double. One item is one face.
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>

#include "bench/reference_triangle.h"
#include "bench/surfaces.h"
#include "engine/flow/scheme.h"
#include "kernels/face_kernels.h"
#include "kernels/intrinsic_triangulation.h"
#include "kernels/parallel.h"

namespace {

using namespace ricci;
using bench::at;

constexpr Index kSizes[] = {1000, 10000, 100000};

/// A metric with chords of about 0.1: far from flat, and a triangle of every geometry.
struct Input {
    IntrinsicTriangulation<long double> exact;
    IntrinsicTriangulation<double> rounded;
    std::vector<double> u;
};

Input make_input(Index faces) {
    Input input;
    input.exact = intrinsic_triangulation<long double>(bench::generated("eight", faces, 0.2));
    input.rounded = rounded(input.exact);
    double mean = 0.0;
    for (const double x : input.rounded.log_chord) mean += x;
    mean /= static_cast<double>(input.rounded.log_chord.size());
    const Index vertices = input.rounded.connectivity.vertex_count;
    for (Index v = 0; v < vertices; ++v) input.u.push_back(std::log(0.1) - mean + 0.02 * std::sin(v));
    return input;
}

template <class Real>
struct Output {
    explicit Output(std::size_t halfedges, bool derivatives)
        : angle(halfedges), off(derivatives ? halfedges : 0), diagonal(off.size()) {}
    [[nodiscard]] FaceFields<Real> fields() { return {angle, off, diagonal, {}}; }
    std::vector<Real> angle;
    std::vector<double> off, diagonal;
};

template <int kappa>
void reference_pass(const Input& input, bool derivatives, Output<double>& out) {
    const std::vector<Index>& tail = input.rounded.connectivity.tail;
    for (std::size_t f = 0; f < tail.size(); f += 3) {
        double chord[3];
        for (std::size_t k = 0; k < 3; ++k)
            chord[k] = std::exp(input.rounded.log_chord[f + k] +
                                0.5 * (input.u[at(tail[f + k])] + input.u[at(tail[f + (k + 1) % 3])]));
        const bench::ReferenceTriangle t = bench::reference_triangle<kappa>(chord, derivatives);
        for (std::size_t k = 0; k < 3; ++k) {
            out.angle[f + k] = t.angle[k];
            if (!derivatives) continue;
            out.off[f + k] = t.off[k];
            out.diagonal[f + k] = t.diagonal[k];
        }
    }
}

void reference(Geometry geometry, const Input& input, bool derivatives, Output<double>& out) {
    with_geometry(geometry, [&]<class G>(G) { reference_pass<G::kappa>(input, derivatives, out); });
}

template <class Real>
double difference(const std::vector<Real>& a, const std::vector<double>& b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, std::abs(static_cast<double>(a[i]) - b[i]));
    return largest;
}

/// Both are rounded sums of a few terms of triangles with angles above a few degrees: 1e-11 is generous, and
/// far below any error of substance.
template <class Real>
void check(benchmark::State& state, Geometry geometry, const Input& input, bool derivatives,
           const Output<Real>& out) {
    Output<double> expected(out.angle.size(), derivatives);
    reference(geometry, input, derivatives, expected);
    if (difference(out.angle, expected.angle) > 1e-11) state.SkipWithError("wrong angles");
    if (difference(out.off, expected.off) > 1e-9) state.SkipWithError("wrong derivatives");
    if (difference(out.diagonal, expected.diagonal) > 1e-9) state.SkipWithError("wrong diagonal");
}

/// Faces and bytes: corners read an index and a chord, vertices a factor, and the fields are written.
template <class Real>
void count(benchmark::State& state, const Input& input, bool derivatives) {
    const auto corners = static_cast<std::int64_t>(input.u.empty() ? 0 : input.rounded.log_chord.size());
    state.SetItemsProcessed(state.iterations() * corners / 3);
    const auto per_corner =
        static_cast<std::int64_t>(sizeof(Index) + 2 * sizeof(Real) + (derivatives ? 16 : 0));
    state.SetBytesProcessed(state.iterations() *
                            (corners * per_corner + static_cast<std::int64_t>(8 * input.u.size())));
}

template <class Real>
void kernel(benchmark::State& state, Geometry geometry, bool derivatives, Index faces, int threads) {
    const Input input = make_input(faces);
    Output<Real> out(input.rounded.log_chord.size(), derivatives);
    std::int64_t broken = 0;
    with_thread_limit(threads, [&] {
        for (auto _ : state) {
            if constexpr (std::is_same_v<Real, double>) {
                const ScaledChords<double> chords{input.rounded.connectivity.tail, input.rounded.log_chord,
                                                  input.u};
                broken = evaluate_faces<double>(geometry, chords, out.fields(), threads > 1);
            } else {
                const ScaledChords<Real> chords{input.exact.connectivity.tail, input.exact.log_chord,
                                                input.u};
                broken = evaluate_faces<Real>(geometry, chords, out.fields(), threads > 1);
            }
            benchmark::ClobberMemory();
        }
    });
    if (broken != 0) state.SkipWithError("broken triangles");
    check(state, geometry, input, derivatives, out);
    count<Real>(state, input, derivatives);
}

void scalar(benchmark::State& state, Geometry geometry, bool derivatives, Index faces) {
    const Input input = make_input(faces);
    Output<double> out(input.rounded.log_chord.size(), derivatives);
    for (auto _ : state) {
        reference(geometry, input, derivatives, out);
        benchmark::ClobberMemory();
    }
    count<double>(state, input, derivatives);
}

/// Circle packings (inversive distance); angles are checked against the formula of the chords.
void packing(benchmark::State& state, Geometry geometry, bool derivatives, Index faces, int threads) {
    const SurfaceMesh& mesh = bench::generated("eight", faces, 0.2);
    std::vector<double> length = mesh.edge_length;
    const double longest = *std::max_element(length.begin(), length.end());
    for (double& l : length) l *= 0.2 / longest;
    const CirclePacking circles =
        initial_circle_packing(mesh.connectivity, length, geometry, Scheme::inversive_distance);
    const PackedCircles view{mesh.connectivity.tail, circles.eta, circles.eps, circles.u};
    Output<double> out(length.size(), derivatives);
    std::int64_t broken = 0;
    with_thread_limit(threads, [&] {
        for (auto _ : state) {
            broken = evaluate_faces(geometry, view, out.fields(), threads > 1);
            benchmark::ClobberMemory();
        }
    });
    if (broken != 0) state.SkipWithError("broken triangles");
    // The packing reproduces the lengths it was made from, so its angles are theirs.
    std::vector<double> packed(length.size());
    packed_edge_lengths(geometry, view, packed);
    const double kappa = curvature_sign(geometry);
    for (std::size_t f = 0; f < length.size(); f += 3) {
        double chord[3];
        for (std::size_t k = 0; k < 3; ++k)
            chord[k] = kappa == 0 ? packed[f + k]
                                  : (kappa < 0 ? 2.0 * std::sinh(0.5 * packed[f + k])
                                               : 2.0 * std::sin(0.5 * packed[f + k]));
        const auto expected = with_geometry(
            geometry, [&]<class G>(G) { return bench::reference_triangle<G::kappa>(chord, false); });
        for (std::size_t k = 0; k < 3; ++k)
            if (!(std::abs(out.angle[f + k] - expected.angle[k]) <= 1e-10))
                state.SkipWithError("wrong angles");
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(length.size() / 3));
}

void register_group(Geometry geometry, bool derivatives) {
    const std::string group =
        std::string(derivatives ? "derivatives/" : "angles/").append(name_of(geometry)).append("/");
    const auto add = [&group](const char* kind, Index faces, auto... arguments) {
        std::string name = group;
        name.append(kind).append("/faces:").append(std::to_string(faces));
        return benchmark::RegisterBenchmark(name.c_str(), arguments...);
    };
    for (const Index faces : kSizes) {
        add("vectorised", faces, kernel<double>, geometry, derivatives, faces, 1);
        add("scalar", faces, scalar, geometry, derivatives, faces);
        add("long_double", faces, kernel<long double>, geometry, derivatives, faces, 1);
        add("packing", faces, packing, geometry, derivatives, faces, 1);
    }
    for (int threads = 2; threads <= hardware_threads(); threads *= 2) {
        std::string kind = "vectorised/threads:";
        kind.append(std::to_string(threads));
        add(kind.c_str(), kSizes[2], kernel<double>, geometry, derivatives, kSizes[2], threads)
            ->UseRealTime();
    }
}

const bool kRegistered = [] {
    for (const Geometry geometry : {Geometry::euclidean, Geometry::hyperbolic, Geometry::spherical})
        for (const bool derivatives : {false, true}) register_group(geometry, derivatives);
    return true;
}();

}  // namespace
