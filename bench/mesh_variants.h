// Variants of one surface that a shape descriptor should hardly tell apart.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "kernels/surface_mesh.h"

namespace ricci::bench {

/// Middle of the axis-parallel box around the used vertices, and the length of its diagonal.
struct Box {
    Point middle{};
    double diagonal = 0.0;
};
Box bounding_box(const SurfaceMesh& mesh);

/// Smallest angle of all faces, in degrees.
double smallest_angle(const SurfaceMesh& mesh);

/// x -> centre + r^2 (x - centre) / |x - centre|^2, then a random rotation and a scaling: a Moebius map. The
/// centre lies 1.25 diagonals of the bounding box away from its middle in a random direction, so that scales
/// differ by a factor of (1.75/0.75)^2 at most. Triangles keep their order.
SurfaceMesh moebius_image(const SurfaceMesh& mesh, std::uint64_t seed);

/// Every used vertex displaced by a normal deviate of standard deviation `share` times the bounding box's
/// diagonal: along the vertex's normal, or in each coordinate by that over sqrt 3.
SurfaceMesh with_noise(const SurfaceMesh& mesh, double share, bool along_normals, std::uint64_t seed);

/// The same surface in other triangles: a random third of the edges is cut at a random point between a
/// quarter and three quarters, faces are filled accordingly, and then edges between coplanar faces (to 1e-6)
/// flip at random where no angle falls below both 15 degrees and the smallest before.
SurfaceMesh retriangulated(const SurfaceMesh& mesh, std::uint64_t seed);

/// Vertices permuted, unused ones dropped, faces permuted and begun at random corners.
SurfaceMesh relabelled(const SurfaceMesh& mesh, std::uint64_t seed);

/// Halves and quarters need room: a surface of fewer than 2000 faces is subdivided (the same surface) until
/// it has so many, and then decimated to `share` of its faces.
SurfaceMesh decimated(const SurfaceMesh& mesh, double share);

/// A variant by name. `make` throws std::invalid_argument or std::runtime_error where it cannot be made.
struct VariantMaker {
    std::string name;
    std::function<SurfaceMesh(const SurfaceMesh&, std::uint64_t seed)> make;
};

/// The ten that every surface should have, in order; and those that stand in, in order, where one cannot be
/// made.
std::vector<VariantMaker> variant_makers(Index most_faces);
std::vector<VariantMaker> substitute_makers();

}  // namespace ricci::bench
