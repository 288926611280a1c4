// Sample surfaces with known topology and, where stated, known conformal invariants.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "kernels/surface_mesh.h"

namespace ricci {

struct GenerateOptions {
    /// About so many faces. Every surface is made from a pattern that repeats; the pattern size nearest in
    /// ratio is taken: within 2 % for tori and annuli; 20 % for spheres, disks and closed rows of rings; 40 %
    /// for halves of such rows; a factor of two for klein-quartic and bolza. The smallest patterns have 20
    /// faces (sphere), 36 g + 28 times 4 (rows; their halves half as many), 56 (klein-quartic), 16 (bolza):
    /// fewer are not made.
    Index faces = 5000;
    double major_radius = 2.5;                           // torus, annulus-planar: see generators()
    double minor_radius = 1.0;                           // torus, annulus-planar: see generators()
    std::array<double, 3> semi_axes = {1.5, 1.0, 0.75};  // ellipsoid
    Index genus = 2;                                     // genus-g, genus-g-one-boundary
    double height = 1.0;                                 // annulus
    std::uint64_t seed = 0;                              // jitter
    /// In [0, 0.45]: displaces every interior vertex in its tangent plane by up to this fraction of the
    /// smallest altitude among its faces, so that no face can turn over. Not for the intrinsic surfaces.
    double jitter = 0.0;
};

/// The names that generate() knows, each with one line of description.
struct GeneratorInfo {
    std::string name, description;
};
std::vector<GeneratorInfo> generators();

/// Makes the named surface; the same options give the same bits. Embedded surfaces are oriented outwards
/// (flat ones upwards); klein-quartic and bolza are intrinsic. Throws std::invalid_argument for an unknown
/// name (listing the known ones) or an impossible option.
SurfaceMesh generate(const std::string& name, const GenerateOptions& options);

}  // namespace ricci
