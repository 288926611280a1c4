// Closed edge paths that users give by their vertices.
#pragma once

#include <span>

#include "engine/topology/edge_path.h"

namespace ricci {

/// The path through `vertices`, in order, and from the last back to the first. Throws std::invalid_argument
/// naming the vertices: none given, one out of range, two that follow one another and are not joined by an
/// edge, or are by several (a loop edge counts twice, for its directions), so that the vertices do not tell
/// the path.
EdgePath closed_path(const Connectivity& connectivity, std::span<const Index> vertices);

}  // namespace ricci
