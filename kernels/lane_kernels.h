// The passes of lanes.h with code for one instruction set. The processor must have it.
#pragma once

#include <span>
#include <vector>

#include "kernels/instruction_set.h"
#include "kernels/lanes.h"

namespace ricci::detail {

void lane_exponentials(InstructionSet set, const LaneArray<double>& u, LaneArray<double>& shrink);
LaneMask add_angle_changes(InstructionSet set, const LaneFaces& faces, const LaneArray<double>& shrink,
                           std::span<const LaneMask> owned, LaneArray<double>& change);
void find_lane_flips(InstructionSet set, const LaneEdges& edges, const LaneArray<double>& shrink,
                     std::span<const LaneMask> owned, std::vector<LaneFlip>& flips);

}  // namespace ricci::detail
