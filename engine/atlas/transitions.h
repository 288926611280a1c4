// The maps between the charts of an atlas.
#pragma once

#include <vector>

#include "engine/atlas/atlas.h"

namespace ricci {

/// One per pair of charts and connected component of their overlap, from the frames of the charts.
std::vector<Transition> make_transitions(const CommonRefinement& refinement, const Atlas& atlas);

/// From the frame of piece p to the chart; p must belong to it.
const Isometry<double>& frame_in(const Chart& chart, Index p);

/// The map between two charts as the frames of their common piece p give it.
Isometry<double> change_at(int kappa, const Chart& to, const Chart& from, Index p);

}  // namespace ricci
