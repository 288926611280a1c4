// Smooth maps of space that make new shapes out of old ones.
#pragma once

#include <cstdint>

#include "kernels/surface_mesh.h"

namespace ricci::bench {

struct DeformedMesh {
    SurfaceMesh mesh;
    double strength = 0.0;         // the one that was used
    double largest_stretch = 0.0;  // of an edge, over the mean
    double smallest_stretch = 0.0;
};

/// The surface under a random smooth map of space: rotation; stretch along the axes; taper, twist and bend
/// along the first axis; a displacement by four waves about as long as the surface. Everything is
/// proportional to `strength` (1: stretches up to e^0.8, bends up to 1.4, twists up to 1.6 radians over the
/// length). Where an angle falls below a third of the smallest before, or an edge changes more than sixfold
/// against the mean, the same map is tried at four fifths of the strength, and so on. Throws
/// std::runtime_error below a twentieth of it.
DeformedMesh deform_space(const SurfaceMesh& mesh, double strength, std::uint64_t seed);

}  // namespace ricci::bench
