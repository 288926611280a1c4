// The matrix that linear benchmarks work on.
#pragma once

#include <numeric>
#include <vector>

#include "bench/surfaces.h"
#include "engine/flow/hessian.h"
#include "kernels/face_kernels.h"
#include "kernels/intrinsic_triangulation.h"

namespace ricci::bench {

/// The cotangent Laplacian of a generated eight with unknown 0 held: positive definite.
struct GroundedLaplacian {
    SymmetricPattern pattern;
    std::vector<double> values;
};

inline GroundedLaplacian grounded_laplacian(Index faces) {
    const auto t = intrinsic_triangulation<double>(generated("eight", faces));
    const Index vertices = t.connectivity.vertex_count;
    std::vector<double> angle(t.log_chord.size()), off(angle.size()), diagonal(angle.size());
    const std::vector<double> u(at(vertices), 0.0);
    const ScaledChords<double> chords{t.connectivity.tail, t.log_chord, u};
    evaluate_faces<double>(Geometry::euclidean, chords, {angle, off, diagonal, {}}, false);
    std::vector<Index> unknown(at(vertices));
    std::iota(unknown.begin(), unknown.end(), Index{0});
    HessianAssembler assembler;
    assembler.build(t.connectivity, unknown, vertices);
    GroundedLaplacian matrix;
    assembler.assemble(t.connectivity, off, diagonal, 0, matrix.values);
    matrix.pattern = assembler.pattern();
    return matrix;
}

}  // namespace ricci::bench
