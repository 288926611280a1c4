// The schemes of discrete conformal change: all differ only in the data eps (per vertex) and eta (per edge).
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "kernels/geometry.h"
#include "kernels/surface_mesh.h"

namespace ricci {

enum class Scheme : std::uint8_t { vertex_scaling, inversive_distance, thurston, tangential, virtual_radius };

std::string_view name_of(Scheme scheme);

/// A circle-packing metric on a fixed triangulation.
struct CirclePacking {
    std::vector<double> eps;                                 // V
    std::vector<double> eta;                                 // 3F, equal on twins
    std::vector<double> u;                                   // V, initial
    double max_length_error = 0.0, mean_length_error = 0.0;  // |l - l_input| / l_input over edges
    std::int64_t clipped_edges = 0;  // Thurston: edges whose cos(phi) was brought into [0, 1]
};

/// Initial circle packing of a surface (thesis section 4.3.1, steps 1 to 3): radii are the averages of the
/// corner radii (l_ki + l_ij - l_jk)/2; eta is 1 (tangential), the cosine of the intersection angle brought
/// into [0, 1] (Thurston, phi in [0, pi/2]), or exact (inversive distance, virtual radius). `length` (3F):
/// edge lengths in the background geometry. How far the packing's lengths are from these is part of the
/// result.
CirclePacking initial_circle_packing(const Connectivity& connectivity, std::span<const double> length,
                                     Geometry geometry, Scheme scheme);

}  // namespace ricci
