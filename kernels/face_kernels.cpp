#include "kernels/face_kernels.h"

#include <array>
#include <cmath>
#include <type_traits>
#include <vector>

#include "kernels/extended.h"
#include "kernels/parallel.h"
#include "kernels/triangle.h"
#include "kernels/vector_math.h"
#include "kernels/wide_sides.h"

namespace ricci {
namespace {

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// Scratch of one block, one array per halfedge of the face, so that loops over faces load contiguously.
/// Chords are loaded as logarithms and then exponentiated in place.
template <class Real>
struct BlockChords {
    alignas(64) Real chord[3][kFaceBlock];
    alignas(64) Real scale[kFaceBlock];        // the chords are relative to exp(scale); 0 where kappa != 0
    alignas(64) Real slope[3][2][kFaceBlock];  // s(l) dl/du at tail and head; used by circle packings only
    int lanes = 0;                             // padded count
};

/// Of lengths in more digits than triangles are evaluated in.
struct WideChords : BlockChords<long double> {
    SideDifferences<long double> difference[kFaceBlock];
};

template <class Real>
using LoadedChords =
    std::conditional_t<std::is_floating_point_v<Real>, BlockChords<TriangleReal<Real>>, WideChords>;

template <class Real>
struct BlockResults {
    alignas(64) Real angle[3][kFaceBlock];
    alignas(64) double off[3][kFaceBlock];
    alignas(64) double diagonal[3][kFaceBlock];
    alignas(64) Real area[kFaceBlock];
    alignas(64) Real radicand[kFaceBlock];
};

template <int kappa, class Real>
RICCI_ALWAYS_INLINE TriangleTerms<Real> terms_of(const BlockChords<Real>& in, int i) {
    return triangle_terms<kappa>(in.chord[0][i], in.chord[1][i], in.chord[2][i]);
}

template <int kappa>
TriangleTerms<long double> terms_of(const WideChords& in, int i) {
    return triangle_terms<kappa>(in.chord[0][i], in.chord[1][i], in.chord[2][i], in.difference[i]);
}

/// Angles (and derivatives) of a block of chords. Plain loops over arrays: the compiler vectorises them.
template <int kappa, class Real, bool derivatives, bool scaling, class Chords>
RICCI_ALWAYS_INLINE void evaluate_block(const Chords& in, BlockResults<Real>& out) {
    const int lanes = in.lanes;
#pragma omp simd
    for (int i = 0; i < lanes; ++i) {
        const Real l0 = in.chord[0][i], l1 = in.chord[1][i], l2 = in.chord[2][i];
        const TriangleTerms<Real> t = terms_of<kappa>(in, i);
        out.radicand[i] = t.radicand;
        out.angle[0][i] = std::atan2(t.root, t.numerator[0]);
        out.angle[1][i] = std::atan2(t.root, t.numerator[1]);
        out.angle[2][i] = std::atan2(t.root, t.numerator[2]);
        out.area[i] = triangle_area<kappa>(t, l0, l1, l2);
        if constexpr (derivatives) {
            AngleDerivatives<Real> d;
            if constexpr (scaling) {
                d = scaling_derivatives<kappa>(t, l0, l1, l2);
            } else {
                d = general_derivatives<kappa>(t, l0, l1, l2, {in.slope[0][0][i], in.slope[0][1][i]},
                                               {in.slope[1][0][i], in.slope[1][1][i]},
                                               {in.slope[2][0][i], in.slope[2][1][i]});
            }
            // Written out: an inner loop would keep the compiler from vectorising the outer one.
            out.off[0][i] = static_cast<double>(d.off[0]);
            out.off[1][i] = static_cast<double>(d.off[1]);
            out.off[2][i] = static_cast<double>(d.off[2]);
            out.diagonal[0][i] = static_cast<double>(d.diagonal[0]);
            out.diagonal[1][i] = static_cast<double>(d.diagonal[1]);
            out.diagonal[2][i] = static_cast<double>(d.diagonal[2]);
        }
    }
}

/// Exponentiates the chords of a block of faces, in place.
template <class Real>
RICCI_ALWAYS_INLINE void exponentiate(BlockChords<Real>& block) {
    for (auto& chord : block.chord) {
#pragma omp simd
        for (int i = 0; i < block.lanes; ++i) chord[i] = std::exp(chord[i]);
    }
}

template <int kappa, class Real, bool derivatives>
RICCI_ALWAYS_INLINE void scaled_block(LoadedChords<Real>& in, BlockResults<TriangleReal<Real>>& out) {
    exponentiate(in);
    evaluate_block<kappa, TriangleReal<Real>, derivatives, true>(in, out);
}

// One clone per instruction set of each double kernel; the others stay scalar.
#define RICCI_SCALED(name, kappa)                                                                       \
    RICCI_VECTOR_CLONES void scaled_angles_##name(BlockChords<double>& in, BlockResults<double>& out) { \
        scaled_block<kappa, double, false>(in, out);                                                    \
    }                                                                                                   \
    RICCI_VECTOR_CLONES void scaled_all_##name(BlockChords<double>& in, BlockResults<double>& out) {    \
        scaled_block<kappa, double, true>(in, out);                                                     \
    }                                                                                                   \
    RICCI_VECTOR_CLONES void packed_angles_##name(BlockChords<double>& in, BlockResults<double>& out) { \
        evaluate_block<kappa, double, false, false>(in, out);                                           \
    }                                                                                                   \
    RICCI_VECTOR_CLONES void packed_all_##name(BlockChords<double>& in, BlockResults<double>& out) {    \
        evaluate_block<kappa, double, true, false>(in, out);                                            \
    }
RICCI_SCALED(euclidean, 0)
RICCI_SCALED(hyperbolic, -1)
RICCI_SCALED(spherical, 1)
#undef RICCI_SCALED

template <class Real>
using BlockKernel = void (*)(LoadedChords<Real>&, BlockResults<TriangleReal<Real>>&);

template <class Real>
BlockKernel<Real> scaled_kernel(Geometry geometry, bool derivatives) {
    if constexpr (std::is_same_v<Real, double>) {
        switch (geometry) {
            case Geometry::hyperbolic:
                return derivatives ? scaled_all_hyperbolic : scaled_angles_hyperbolic;
            case Geometry::spherical:
                return derivatives ? scaled_all_spherical : scaled_angles_spherical;
            case Geometry::euclidean:
                break;
        }
        return derivatives ? scaled_all_euclidean : scaled_angles_euclidean;
    } else {
        return with_geometry(geometry, [&](auto policy) -> BlockKernel<Real> {
            constexpr int kappa = decltype(policy)::kappa;
            return derivatives ? scaled_block<kappa, Real, true> : scaled_block<kappa, Real, false>;
        });
    }
}

BlockKernel<double> packed_kernel(Geometry geometry, bool derivatives) {
    switch (geometry) {
        case Geometry::hyperbolic:
            return derivatives ? packed_all_hyperbolic : packed_angles_hyperbolic;
        case Geometry::spherical:
            return derivatives ? packed_all_spherical : packed_angles_spherical;
        case Geometry::euclidean:
            break;
    }
    return derivatives ? packed_all_euclidean : packed_angles_euclidean;
}

template <class Real>
void pad(BlockChords<Real>& block, int count, Real value) {
    block.lanes = (count + kVectorPad - 1) / kVectorPad * kVectorPad;
    for (int i = count; i < block.lanes; ++i) {
        block.scale[i] = Real(0);
        for (int k = 0; k < 3; ++k) {
            block.chord[k][i] = value;
            block.slope[k][0][i] = block.slope[k][1][i] = Real(0.5);
        }
    }
}

/// Logarithms of the chords of faces [begin, end); Euclidean ones relative to the face's longest.
template <class Real>
void load_scaled(bool relative, const ScaledChords<Real>& in, std::int64_t begin, std::int64_t end,
                 LoadedChords<Real>& block) {
    using Triangle = TriangleReal<Real>;
    const int count = static_cast<int>(end - begin);
    for (int i = 0; i < count; ++i) {
        const auto h = static_cast<std::size_t>(3 * (begin + i));
        const Real u0 = in.u.template at<Real>(in.tail[h]), u1 = in.u.template at<Real>(in.tail[h + 1]),
                   u2 = in.u.template at<Real>(in.tail[h + 2]);
        const Real x0 = in.log_chord[h] + Real(0.5) * (u0 + u1);
        const Real x1 = in.log_chord[h + 1] + Real(0.5) * (u1 + u2);
        const Real x2 = in.log_chord[h + 2] + Real(0.5) * (u2 + u0);
        const Real top = relative ? std::max(x0, std::max(x1, x2)) : Real(0);
        block.scale[i] = static_cast<Triangle>(top);
        block.chord[0][i] = static_cast<Triangle>(x0 - top);
        block.chord[1][i] = static_cast<Triangle>(x1 - top);
        block.chord[2][i] = static_cast<Triangle>(x2 - top);
        if constexpr (std::is_same_v<Real, WideReal>)
            block.difference[i] = wide_sides({x0 - top, x1 - top, x2 - top}).difference;
    }
    pad<Triangle>(block, count, Triangle(0));
    if constexpr (std::is_same_v<Real, WideReal>)
        std::fill(block.difference + count, block.difference + block.lanes,
                  SideDifferences<long double>{{0, 0, 0}, {1, 1, 1}});
}

/// Chords and slopes of a circle packing; Euclidean ones relative to the face's largest radius.
template <int kappa>
void load_packed(const PackedCircles& in, std::int64_t begin, std::int64_t end, BlockChords<double>& block) {
    constexpr double q = kappa == 0 ? 1.0 : 4.0;
    const int count = static_cast<int>(end - begin);
    for (int i = 0; i < count; ++i) {
        const auto h = static_cast<std::size_t>(3 * (begin + i));
        double u[3], eps[3], square[3], one_plus[3];
        for (std::size_t k = 0; k < 3; ++k) {
            u[k] = in.u[at(in.tail[h + k])];
            eps[k] = in.eps[at(in.tail[h + k])];
        }
        const double top = kappa == 0 ? std::max(u[0], std::max(u[1], u[2])) : 0.0;
        block.scale[i] = top;
        for (std::size_t k = 0; k < 3; ++k) {
            square[k] = eps[k] * std::exp(2.0 * (u[k] - top));
            one_plus[k] = 1.0 + kappa * square[k];
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t j = (k + 1) % 3;
            const double pair = 2.0 * in.eta[h + k] * std::exp(u[k] + u[j] - 2.0 * top);
            const double chord2 = q * (pair + square[k] + square[j]) / (one_plus[k] * one_plus[j]);
            block.chord[k][i] = chord2 > 0.0 ? std::sqrt(chord2) : 0.0;
            const double difference = 0.5 * q * (square[k] - square[j]) / (one_plus[k] * one_plus[j]);
            const double at_tail = (1.0 - kappa * square[k]) / one_plus[k],
                         at_head = (1.0 - kappa * square[j]) / one_plus[j];
            block.slope[k][0][i] = difference + 0.5 * at_tail * chord2;
            block.slope[k][1][i] = -difference + 0.5 * at_head * chord2;
        }
    }
    pad(block, count, 1.0);
}

template <class Real>
std::int64_t store(int kappa, std::int64_t begin, std::int64_t end, const BlockChords<Real>& in,
                   const BlockResults<Real>& block, const FaceFields<Real>& out) {
    std::int64_t broken = 0;
    const int count = static_cast<int>(end - begin);
    for (int i = 0; i < count; ++i) {
        const auto f = static_cast<std::size_t>(begin + i);
        bool good = block.radicand[i] > Real(0);
        for (std::size_t k = 0; k < 3; ++k) {
            good = good && (kappa != 1 || in.chord[k][i] < Real(2));
            if (!out.angle.empty()) out.angle[3 * f + k] = block.angle[k][i];
            if (!out.off.empty()) out.off[3 * f + k] = block.off[k][i];
            if (!out.diagonal.empty()) out.diagonal[3 * f + k] = block.diagonal[k][i];
        }
        if (!out.area.empty()) {
            out.area[f] = kappa == 0 ? block.area[i] * std::exp(Real(2) * in.scale[i]) : block.area[i];
        }
        broken += good ? 0 : 1;
    }
    return broken;
}

/// Runs load, kernel and store over all blocks; broken faces are counted per block and summed in order.
template <class Real, class Load>
std::int64_t run_blocks(int kappa, std::size_t faces, const FaceFields<TriangleReal<Real>>& out,
                        bool parallel, BlockKernel<Real> kernel, Load&& load) {
    constexpr std::int64_t kTask = 16;  // blocks per task
    const auto count = static_cast<std::int64_t>(faces);
    std::vector<std::int64_t> broken(at(static_cast<Index>(count / (kTask * kFaceBlock) + 1)), 0);
    for_blocks(count, kTask * kFaceBlock, parallel, [&](std::int64_t begin, std::int64_t end) {
        LoadedChords<Real> in;
        BlockResults<TriangleReal<Real>> results;
        std::int64_t sum = 0;
        for (std::int64_t b = begin; b < end; b += kFaceBlock) {
            const std::int64_t e = std::min(end, b + kFaceBlock);
            load(b, e, in);
            kernel(in, results);
            sum += store<TriangleReal<Real>>(kappa, b, e, in, results, out);
        }
        broken[static_cast<std::size_t>(begin / (kTask * kFaceBlock))] = sum;
    });
    std::int64_t total = 0;
    for (const std::int64_t b : broken) total += b;
    return total;
}

}  // namespace

template <class Real>
std::int64_t evaluate_faces(Geometry geometry, const ScaledChords<Real>& chords,
                            const FaceFields<TriangleReal<Real>>& out, bool parallel) {
    const bool relative = geometry == Geometry::euclidean;
    return run_blocks<Real>(curvature_sign(geometry), chords.tail.size() / 3, out, parallel,
                            scaled_kernel<Real>(geometry, !out.off.empty()),
                            [&](std::int64_t begin, std::int64_t end, LoadedChords<Real>& block) {
                                load_scaled<Real>(relative, chords, begin, end, block);
                            });
}

template std::int64_t evaluate_faces<double>(Geometry, const ScaledChords<double>&, const FaceFields<double>&,
                                             bool);
template std::int64_t evaluate_faces<long double>(Geometry, const ScaledChords<long double>&,
                                                  const FaceFields<long double>&, bool);
template std::int64_t evaluate_faces<WideReal>(Geometry, const ScaledChords<WideReal>&,
                                               const FaceFields<long double>&, bool);

std::int64_t evaluate_faces(Geometry geometry, const PackedCircles& circles, const FaceFields<double>& out,
                            bool parallel) {
    const BlockKernel<double> kernel = packed_kernel(geometry, !out.off.empty());
    return with_geometry(geometry, [&](auto policy) {
        constexpr int kappa = decltype(policy)::kappa;
        return run_blocks<double>(kappa, circles.tail.size() / 3, out, parallel, kernel,
                                  [&](std::int64_t begin, std::int64_t end, BlockChords<double>& block) {
                                      load_packed<kappa>(circles, begin, end, block);
                                  });
    });
}

void packed_edge_lengths(Geometry geometry, const PackedCircles& in, std::span<double> length) {
    const double kappa = curvature_sign(geometry);
    const double q = geometry == Geometry::euclidean ? 1.0 : 4.0;
    for (std::size_t h = 0; h < in.tail.size(); ++h) {
        const auto i = at(in.tail[h]), j = at(in.tail[at(next_halfedge(static_cast<Index>(h)))]);
        const double ei = in.eps[i] * std::exp(2.0 * in.u[i]), ej = in.eps[j] * std::exp(2.0 * in.u[j]);
        const double numerator = 2.0 * in.eta[h] * std::exp(in.u[i] + in.u[j]) + ei + ej;
        const double chord = std::sqrt(q * numerator / ((1.0 + kappa * ei) * (1.0 + kappa * ej)));
        length[h] = geometry == Geometry::euclidean
                        ? chord
                        : (geometry == Geometry::hyperbolic ? 2.0 * std::asinh(chord / 2.0)
                                                            : 2.0 * std::asin(chord / 2.0));
    }
}

template <class Real>
void sum_corners(std::span<const Index> tail, std::span<const Real> angle, std::span<Real> total) {
    std::fill(total.begin(), total.end(), Real(0));
    for (std::size_t h = 0; h < tail.size(); ++h) total[at(tail[h])] += angle[h];
}

template void sum_corners<double>(std::span<const Index>, std::span<const double>, std::span<double>);
template void sum_corners<long double>(std::span<const Index>, std::span<const long double>,
                                       std::span<long double>);

}  // namespace ricci
