// Structures of sample surfaces, and what tests ask of them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "engine/structure/surface_structure.h"
#include "engine/surfaces/generate.h"
#include "io/mesh/mesh_file.h"
#include "tests/support/small_surfaces.h"
#include "tests/support/test_data.h"

namespace ricci::testing {

inline SurfaceMesh generated(const std::string& name, Index faces, double jitter = 0.3, Index genus = 2) {
    GenerateOptions options;
    options.faces = faces;
    options.jitter = jitter;
    options.genus = genus;
    return generate(name, options);
}

inline SurfaceStructure structure_of(const SurfaceMesh& mesh, StructureOptions options = {}) {
    options.flow.parallel = false;
    SurfaceStructure s = make_surface_structure(mesh, options);
    EXPECT_EQ(s.flow.outcome.status, Status::converged) << s.flow.message;
    return s;
}

/// Trace in SL(2,R), its sign left open.
inline double trace(const Isometry<double>& x) {
    return std::abs(2 * x.a.re);
}

inline Isometry<double> product_of(const SurfaceGroup& group, const Word& word) {
    Isometry<double> result;
    for (const Index letter : word) {
        const Isometry<double>& x = group.letters[at(generator_of(letter))];
        result = compose(group.kappa, result, letter > 0 ? x : inverse(x));
    }
    return result;
}

/// Distance of two positions in the hyperbolic plane.
inline double hyperbolic_distance(const std::array<double, 3>& p, const std::array<double, 3>& q) {
    // By the disk: 2 atanh |z - w| / |1 - conj(z) w|, without the cancellation of the hyperboloid.
    const auto z = conformal_point(-1, p), w = conformal_point(-1, q);
    const double top = std::hypot(z[0] - w[0], z[1] - w[1]);
    const double re = 1 - z[0] * w[0] - z[1] * w[1], im = z[1] * w[0] - z[0] * w[1];
    return 2 * std::atanh(std::min(1.0, top / std::hypot(re, im)));
}

}  // namespace ricci::testing
