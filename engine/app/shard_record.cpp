#include "engine/app/shard_record.h"

namespace ricci::app {

ShardTable make_shard_table(const SweepConfig& config, const SweepPlan& plan,
                            const std::vector<SweepItem>& items) {
    ShardTable table;
    table.index = static_cast<std::int32_t>(plan.shard().index);
    table.count = static_cast<std::int32_t>(plan.shard().count);
    table.inputs = static_cast<std::int32_t>(plan.inputs());
    table.resolutions = static_cast<std::int32_t>(plan.resolutions());
    table.plan = plan.digest();
    SweepConfig whole = config;
    whole.shard.clear();
    whole.output.clear();
    table.config = to_toml(whole, false);
    table.fingerprint = to_toml(whole, true);
    table.keep = parse_keep(config.keep);
    for (const SweepItem& item : items) {
        table.items.push_back(item.place);
        table.items.back().name = item.name;
        table.items.back().stored = item.stored ? 1 : 0;
        if (item.status == Status::converged)
            table.items.back().own = static_cast<std::int32_t>(item.vertices);
    }
    return table;
}

}  // namespace ricci::app
