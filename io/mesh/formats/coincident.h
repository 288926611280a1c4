// Points at equal positions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/surface_mesh.h"

namespace ricci {

/// For every point the lowest-numbered one with equal coordinates (-0 = 0, otherwise bit for bit), itself
/// included. Only points with considered[i] != 0 take part (all when empty); the others represent themselves.
/// // V
std::vector<Index> first_at_position(std::span<const Point> points,
                                     std::span<const std::uint8_t> considered = {});

}  // namespace ricci
