// What a shard's result file says of itself.
#pragma once

#include <vector>

#include "engine/app/sweep_config.h"
#include "engine/app/sweep_items.h"
#include "engine/app/sweep_plan.h"
#include "io/store/shard_table.h"

namespace ricci::app {

/// `items`: all that the shard had to do with, in the order of the input.
ShardTable make_shard_table(const SweepConfig& config, const SweepPlan& plan,
                            const std::vector<SweepItem>& items);

}  // namespace ricci::app
