// A sweep from its inputs to its results, for the command line and for the Python module.
#pragma once

#include <functional>
#include <vector>

#include "engine/app/console.h"
#include "engine/app/sweep_config.h"
#include "engine/app/sweep_items.h"
#include "engine/app/sweep_plan.h"
#include "engine/app/sweep_records.h"

namespace ricci::app {

/// What a run, in this process or in others, leaves behind.
struct Swept {
    std::vector<SweepItem> items;
    bool any_failure = false;
};

/// Sweeps in this process, until `stop` says so.
Swept run_here(const SweepConfig& config, const std::vector<SweepSource>& sources, const SweepPlan& plan,
               SweepRecords& records, ProgressLine& progress, const std::function<bool()>& stop);

/// What became of a sweep with a result file.
struct SweepJob {
    std::vector<ItemSummary> summaries;
    bool any_failure = false;
    bool stopped = false;  // what is finished is durable in OUTPUT.parts; nothing is assembled, no summaries
};

/// Sweeps into config.output, in this process or (config.isolate) in children, and assembles the file. Throws
/// UsageError; FileError where the output is lost.
SweepJob sweep_to_file(const SweepConfig& config, const std::vector<SweepSource>& sources,
                       const SweepPlan& plan, ProgressLine& progress, const std::function<bool()>& stop);

/// Sweeps without a file: the same items, rows, kept conformal factors and failures as a file would hold, in
/// the same order. config.output, resume, shard and isolate play no part. Stopped: the rows that are
/// finished.
StoredRun sweep_in_memory(const SweepConfig& config, const std::vector<SweepSource>& sources,
                          ProgressLine& progress, const std::function<bool()>& stop);

}  // namespace ricci::app
