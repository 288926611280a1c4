// How the sides of a domain, and loops, are told apart.
#pragma once

#include <string>
#include <vector>

#include "engine/topology/cut_graph.h"
#include "io/picture/svg.h"

namespace ricci::app {

/// Paint of the k-th pair of sides or loop: seven colours that any of the usual colour deficiencies leaves
/// apart (Okabe and Ito's, but brown for yellow), solid at first, then dashed, then dotted.
Paint pair_paint(std::size_t k, double width);
/// Pair number of every side: partners share one, sides on the boundary have none (-1).
std::vector<int> pair_numbers(const CutGraph& cut);
/// pair_paint, or a dark grey on the boundary.
Paint side_paint(int pair, double width);

/// The name as it is set: "s1^-1" with a raised -1 (UTF-8).
std::string set_name(const std::string& name);

}  // namespace ricci::app
