// Colours for the copies of a domain such that neighbours differ.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/layout/surface_layout.h"

namespace ricci::app {

/// Copies that share a side with each, among those listed: g and g times the element of a pairing. // one
/// ascending list each
std::vector<std::vector<std::size_t>> neighbours_of_copies(const SurfaceLayout& layout,
                                                           std::span<const Isometry<double>> copies);

/// A number from 0 to `colours` - 1 for every copy, in order of the list the one that fewest of its coloured
/// neighbours have; of several the one used least so far. With more colours than neighbours no two
/// neighbours have the same.
std::vector<std::size_t> copy_colours(const std::vector<std::vector<std::size_t>>& neighbours,
                                      std::size_t colours);

}  // namespace ricci::app
