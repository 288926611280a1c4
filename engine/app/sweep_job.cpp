#include "engine/app/sweep_job.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "engine/app/isolation/failure_bundle.h"
#include "engine/app/isolation/isolated_sweep.h"
#include "engine/app/memory_records.h"
#include "engine/app/processor_kind.h"
#include "engine/app/records.h"
#include "engine/app/shard_record.h"
#include "engine/app/sweep_run.h"

namespace ricci::app {
namespace {

std::int64_t memory_bound(const SweepConfig& config) {
    return config.max_memory.empty() ? 0 : parse_bytes(config.max_memory);
}

Swept run_in_children(const SweepConfig& config, const std::vector<SweepSource>& sources,
                      const SweepPlan& plan, StoreRecords& records, ProgressLine& progress,
                      const std::function<bool()>& stop) {
    IsolatedSweep run(config, sources, plan, records, progress);
    run_isolated(plan.files().size(), run, {config.threads, memory_bound(config), config.hang_timeout, stop});
    return {run.items(), run.any_failure()};
}

/// Names for the final file. A shard cannot do without items that it cannot read any more.
std::vector<std::string> names_to_assemble(const SweepConfig& config, const std::vector<SweepSource>& sources,
                                           const SweepPlan& plan, const Swept& swept, const RunStore& store) {
    std::vector<std::string> files;
    for (const SweepSource& source : sources) files.push_back(source.file);
    std::vector<std::string> names = stored_names(swept.items, files, store);
    const std::size_t unread = names.size() - stored_names(swept.items).size();
    if (unread > 0 && plan.sharded())
        throw FileError(
            fmt::format("{}: {} items that an earlier start of this shard stored cannot be read any more; "
                        "nothing is assembled",
                        config.output, unread));
    if (unread > 0)
        spdlog::warn("{} items are stored as an earlier start left them: their files cannot be read any more",
                     unread);
    return names;
}

}  // namespace

Swept run_here(const SweepConfig& config, const std::vector<SweepSource>& sources, const SweepPlan& plan,
               SweepRecords& records, ProgressLine& progress, const std::function<bool()>& stop) {
    SchedulerOptions options;
    options.threads = config.threads;
    options.max_memory = memory_bound(config);
    options.timeout_seconds = config.timeout;
    options.stop = stop;
    SweepRun run(config, sources, plan, records, progress);
    run_sweeps(
        plan.files().size(), [&](std::size_t i) { return run.open(i); }, run, options);
    return {run.items(), run.any_failure()};
}

SweepJob sweep_to_file(const SweepConfig& config, const std::vector<SweepSource>& sources,
                       const SweepPlan& plan, ProgressLine& progress, const std::function<bool()>& stop) {
    memory_bound(config);  // complains before anything is written
    // A shard cannot be resumed after its inputs have changed so that it would do something else.
    const std::string fingerprint =
        to_toml(config, true) + (plan.sharded() ? "# plan " + plan.digest() + "\n" : "");
    RunInfo info = make_run_info(to_toml(config, false), fingerprint, config.threads);
    info.processor = processor_kind();
    RunStore store(config.output, info, config.resume || config.retry_failed);
    for (const std::string& note : store.notes()) spdlog::warn("{}", note);
    StoreRecords records(&store, config.retry_failed, progress);
    const Swept swept = config.isolate ? run_in_children(config, sources, plan, records, progress, stop)
                                       : run_here(config, sources, plan, records, progress, stop);
    progress.clear();
    SweepJob job;
    job.any_failure = swept.any_failure;
    job.stopped = stop();
    if (job.stopped) return job;
    records.forget_mended();
    job.summaries = summaries_of(swept.items, &store);
    const std::vector<std::string> names = names_to_assemble(config, sources, plan, swept, store);
    std::optional<ShardTable> shard;
    if (plan.sharded()) shard = make_shard_table(config, plan, swept.items);
    store.assemble(names, parse_keep(config.keep), shard ? &*shard : nullptr);
    std::vector<std::string> failed_items;
    for (const FailureRecord& failure : store.failures()) failed_items.push_back(failure.item);
    remove_other_bundles(config.output, failed_items);
    return job;
}

StoredRun sweep_in_memory(const SweepConfig& config, const std::vector<SweepSource>& sources,
                          ProgressLine& progress, const std::function<bool()>& stop) {
    const SweepPlan plan(sources.size(), parse_resolutions(config.resolutions).size());
    const KeepPolicy keep = parse_keep(config.keep);
    MemoryRecords records(keep, progress);
    const Swept swept = run_here(config, sources, plan, records, progress, stop);
    progress.clear();
    StoredRun run = records.take(stored_names(swept.items));
    run.info = make_run_info(to_toml(config, false), to_toml(config, true), config.threads);
    run.complete = !stop();
    return run;
}

}  // namespace ricci::app
