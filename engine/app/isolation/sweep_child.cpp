// A child that sweeps one file: the same SweepRun as in a process of its own, with its records at the other
// end of the socket.
#include <unistd.h>

#include <algorithm>
#include <mutex>

#include "engine/app/isolation/child_main.h"
#include "engine/app/isolation/sweep_messages.h"
#include "engine/app/sweep_run.h"

namespace ricci::app {
namespace {

class PipeRecords final : public SweepRecords {
  public:
    PipeRecords(ParentChannel& parent, const ChildShare& share, const KeepPolicy& keep)
        : parent_(&parent), share_(share), keep_(keep) {}

    std::optional<FailureRecord> begin(const SweepStage& stage) override {
        MessageWriter message;
        const std::string answer = ask(SweepMessage::begin, put_stage(message, stage));
        MessageReader reader(answer);
        if (!reader.get<bool>()) return std::nullopt;
        return reader.get_failure();
    }
    void passed(const SweepStage& stage) override {
        MessageWriter message;
        send(SweepMessage::passed, put_stage(message, stage));
    }
    Admission admit(const ItemRecord& item, const SweepStage& stage) override {
        MessageWriter message;
        const std::string answer = ask(SweepMessage::admit, put_stage(message, stage).put(item));
        MessageReader reader(answer);
        Admission admission;
        admission.name = reader.get_text();
        admission.finished = reader.get_vector<Index>();
        return admission;
    }
    void chosen(const std::string& item, const ChosenVertices& vertices) override {
        send(SweepMessage::chosen, MessageWriter()
                                       .put(item)
                                       .put(vertices.all)
                                       .put(vertices.all_xxh3)
                                       .put(static_cast<std::uint64_t>(vertices.own))
                                       .put(static_cast<std::uint64_t>(vertices.left)));
    }
    void started(const std::string& item, Index vertex) override {
        send(SweepMessage::started, MessageWriter().put(item).put(vertex));
    }
    void finished(const SweepBlock& block) override {
        send(SweepMessage::finished, MessageWriter().put(without_needless(block)));
    }
    void item_finished(const std::string& item, double seconds) override {
        send(SweepMessage::item_finished, MessageWriter().put(item).put(seconds));
    }
    void failed(const FailureRecord& failure) override {
        // With a part of the memory only, that is no answer yet.
        if (failure.status == name_of(Status::out_of_memory) && share_.memory > 0 && !share_.whole)
            end_out_of_memory();
        send(SweepMessage::failed, MessageWriter().put(failure));
    }

  private:
    /// Conformal factors that would not be kept beside those sent before stay here.
    SweepBlock without_needless(const SweepBlock& block) {
        if (keep_.count < 0) return block;
        const std::lock_guard lock(mutex_);
        if (sent_of_ != block.item) sent_.clear();
        sent_of_ = block.item;
        std::vector<KeptFactor> candidates = sent_;
        for (const KeptFactor& kept : block.kept)
            candidates.push_back({kept.vertex, kept.area_distortion, {}});
        drop_needless(candidates, keep_);
        SweepBlock reduced{block.item, block.rows, {}};
        for (const KeptFactor& kept : block.kept)
            if (std::any_of(candidates.begin(), candidates.end(),
                            [&](const KeptFactor& c) { return c.vertex == kept.vertex; }))
                reduced.kept.push_back(kept);
        sent_ = std::move(candidates);
        return reduced;
    }

    void send(SweepMessage kind, const MessageWriter& message) {
        parent_->send(static_cast<std::uint32_t>(kind), message.bytes());
    }
    std::string ask(SweepMessage kind, const MessageWriter& message) {
        return parent_->ask(static_cast<std::uint32_t>(kind), message.bytes());
    }

    ParentChannel* parent_;
    ChildShare share_;
    KeepPolicy keep_;
    std::mutex mutex_;
    std::string sent_of_;
    std::vector<KeptFactor> sent_;  // of the item, without the factors themselves
};

}  // namespace

void sweep_in_child(ParentChannel& parent, const ChildShare& share, MessageReader& job) {
    const SweepSource source{job.get_text(), job.get_text()};
    const SweepConfig config = sweep_config_from_toml(job.get_text(), "configuration");
    const auto parts = job.get_vector<WorkPart>();
    job.end();
    PipeRecords records(parent, share, parse_keep(config.keep));
    ProgressLine progress(true);
    const SweepPlan plan(parts, parse_resolutions(config.resolutions).size());
    SweepRun run(config, {source}, plan, records, progress);
    std::vector<SweepTask> tasks = run.open(0);
    parent.send(static_cast<std::uint32_t>(SweepMessage::opened), {});
    SchedulerOptions options;
    options.max_memory = share.memory;
    options.timeout_seconds = config.timeout;
    options.block_seconds = 0.0;  // whatever is finished is safe at once
    // Not while a thread only waits for others, whose hang would go unnoticed.
    options.alive = [&] { parent.pulse(); };
    options.stop = [] { return caught_signal() != 0; };
    int allowed = share.threads;
    options.grant = [&] {
        const int granted = parent.threads();
        if (granted > allowed) allow_threads(granted - allowed);
        allowed = std::max(allowed, granted);
        return granted;
    };
    // One item after another, so that it is known which one a crash is of.
    for (SweepTask& task : tasks) {
        const SweepTask now = std::move(task);
        if (records.begin(run.stage_of(now.item))) continue;
        options.threads = parent.threads();
        run_sweeps(
            1, [&](std::size_t) { return std::vector<SweepTask>{now}; }, run, options);
        if (caught_signal() != 0) ::_exit(128 + caught_signal());
    }
}

}  // namespace ricci::app
