#include "engine/app/isolation/isolated_sweep.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "engine/app/isolation/child_main.h"
#include "engine/app/isolation/failure_bundle.h"

namespace ricci::app {
namespace {

using Clock = std::chrono::steady_clock;

/// Rows wait so long for others before they become a segment.
constexpr double kBlockSeconds = 5.0;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Stem without ".c0": "a.c1.off" and component 1 of "a.off" may both give an item "a.c1@100".
std::string family_of(std::string stem) {
    for (;;) {
        const std::size_t dot = stem.rfind(".c");
        const bool component = dot != std::string::npos && dot + 2 < stem.size() &&
                               stem.find_first_not_of("0123456789", dot + 2) == std::string::npos;
        if (!component) return stem;
        stem.resize(dot);
    }
}

/// "3, 17 and 5 more".
std::string listed(const std::set<Index>& vertices) {
    constexpr std::size_t kNamed = 8;
    std::string text;
    std::size_t count = 0;
    for (const Index vertex : vertices) {
        if (count == kNamed) return fmt::format("{} and {} more", text, vertices.size() - kNamed);
        text += fmt::format("{}{}", count++ == 0 ? "" : ", ", vertex);
    }
    return text;
}

}  // namespace

IsolatedSweep::IsolatedSweep(const SweepConfig& config, const std::vector<SweepSource>& sources,
                             const SweepPlan& plan, StoreRecords& records, ProgressLine& progress)
    : config_(config),
      keep_(parse_keep(config.keep)),
      records_(&records),
      progress_(&progress),
      resolutions_(parse_resolutions(config.resolutions)) {
    sweep_options(config);  // what is wrong with them is said here, once
    parse_vertices(config.vertices);
    parse_repair(config.repair);
    progress_now_.sources = plan.files().size();
    for (const std::size_t number : plan.files()) {
        sources_.emplace_back();
        Source& source = sources_.back();
        source.source = sources[number];
        source.input = static_cast<std::int32_t>(number);
        source.parts = plan.parts_of(number);
        source.family = family_of(stem_of(source.source.file));
    }
}

/// Names are given in the order of the input.
bool IsolatedSweep::may_start(std::size_t task) {
    return std::none_of(
        sources_.begin(), sources_.begin() + static_cast<std::ptrdiff_t>(task),
        [&](const Source& earlier) { return !earlier.named && earlier.family == sources_[task].family; });
}

std::optional<std::string> IsolatedSweep::job(std::size_t task, const ChildShare& share) {
    Source& source = sources_[task];
    source.opened = source.done = false;
    source.asked.clear();
    source.stage = {source.source.name, kLoadStage};
    source.under_way.clear();
    source.exception.reset();
    MessageWriter job;
    put_header(job, {"sweep", share});
    return job.put(source.source.file)
        .put(source.source.name)
        .put(to_toml(config_, false))
        .put(source.parts)
        .bytes();
}

void IsolatedSweep::message(std::size_t task, const Frame& frame, const Reply& reply) {
    Source& source = sources_[task];
    MessageReader reader(frame.bytes);
    if (frame.kind == kDoneMessage) {
        source.done = true;
        return;
    }
    if (frame.kind == kExceptionMessage) {
        source.exception = FailureRecord{"", "", reader.get_text(), reader.get_text()};
        return;
    }
    switch (static_cast<SweepMessage>(frame.kind)) {
        case SweepMessage::begin:
            return begin(source, get_stage(reader), reply);
        case SweepMessage::passed:
            return records_->passed(get_stage(reader));
        case SweepMessage::admit: {
            const SweepStage stage = get_stage(reader);
            return admit(source, stage, reader.get_item(), reply);
        }
        case SweepMessage::chosen:
            return chosen(source, reader);
        case SweepMessage::opened:
            source.opened = true;
            return set_named(source);
        case SweepMessage::started:
            reader.get_text();
            source.under_way.insert(reader.get<Index>());
            return;
        case SweepMessage::finished:
            return take_block(source, reader.get_block());
        case SweepMessage::item_finished: {
            Entry& entry = entry_of(source, reader.get_text());
            entry.over = true;
            entry.item.seconds += reader.get<double>();
            flush(source);
            return records_->item_finished(entry.item.name, entry.item.seconds);
        }
        case SweepMessage::failed:
            return failed(source, reader.get_failure());
    }
    throw ProtocolError(fmt::format("it sent a message of unknown kind {}", frame.kind));
}

/// The k-th request for a component and resolution is for the k-th place that this resolution has among the
/// parts.
IsolatedSweep::Place IsolatedSweep::next_place(Source& source, const SweepStage& stage) {
    int skip = source.asked[{stage.component, stage.resolution}]++;
    for (const WorkPart& part : source.parts)
        if (resolutions_[part.unit] == stage.resolution && skip-- == 0) return {stage.component, part.unit};
    throw ProtocolError("it works at a resolution that nobody asked for");
}

/// The item at source.place, under way as `base`.
SweepItem& IsolatedSweep::item_here(Source& source, const std::string& base) {
    SweepItem& item = source.items[source.place].item;
    item.place.base = base;
    item.place.input = source.input;
    item.place.component = source.place.first;
    item.place.resolution = static_cast<std::int32_t>(source.place.second);
    return item;
}

IsolatedSweep::Entry& IsolatedSweep::entry_of(Source& source, const std::string& name) {
    for (auto& [place, entry] : source.items)
        if (entry.item.name == name) return entry;
    throw ProtocolError(fmt::format("it speaks of an item {} that is not its own", name));
}

void IsolatedSweep::begin(Source& source, const SweepStage& stage, const Reply& reply) {
    if (stage.stage == kResampleStage) {
        source.place = next_place(source, stage);
        item_here(source, stage.item).name = stage.item;
    } else if (stage.stage == kSweepStage) {
        entry_of(source, stage.item);
    } else if (stage.item != source.source.name) {
        throw ProtocolError("it works on another file than its own");
    }
    flush(source);
    source.stage = stage;
    source.under_way.clear();
    const auto known = records_->begin(stage);
    if (known) take_over(source, *known);
    MessageWriter answer;
    answer.put(known.has_value());
    reply(known ? answer.put(*known).bytes() : answer.bytes());
}

void IsolatedSweep::admit(Source& source, const SweepStage& stage, const ItemRecord& item,
                          const Reply& reply) {
    if (stage.resolution == 0) source.place = next_place(source, stage);
    SweepItem& known = item_here(source, item.name);
    // A child that goes on after the death of another meets the same items again.
    const Admission admission =
        known.stored ? records_->admission_of(known.name) : records_->admit(item, stage);
    known.name = admission.name;
    known.stored = true;
    reply(MessageWriter().put(admission.name).put(admission.finished).bytes());
}

void IsolatedSweep::chosen(Source& source, MessageReader& reader) {
    Entry& entry = entry_of(source, reader.get_text());
    ChosenVertices vertices;
    vertices.all = reader.get<std::int32_t>();
    vertices.all_xxh3 = reader.get<std::uint64_t>();
    vertices.own = reader.get<std::uint64_t>();
    vertices.left = reader.get<std::uint64_t>();
    vertices.put_into(entry.item);
    const std::size_t before = entry.known;
    entry.known = entry.done + vertices.left;
    progress_now_.solves_known += static_cast<std::int64_t>(entry.known) - static_cast<std::int64_t>(before);
    report();
}

/// The item a failure is of says so from now on.
void IsolatedSweep::take_over(Source& source, const FailureRecord& failure) {
    any_failure_ = true;
    if (vertex_of_stage(failure.stage)) return;
    SweepItem* item = nullptr;
    if (failure.stage == kLoadStage) {
        item = &source.load.emplace();
        item->name = item->place.base = source.source.name;
        item->place.input = source.input;
    } else {
        Entry& entry = entry_of(source, failure.item);
        entry.over = true;
        item = &entry.item;
    }
    const auto name = std::find(kStatusNames.begin(), kStatusNames.end(), failure.status);
    item->status = name == kStatusNames.end() ? Status::internal_error
                                              : static_cast<Status>(name - kStatusNames.begin());
    item->message = failure.message;
}

void IsolatedSweep::failed(Source& source, const FailureRecord& failure) {
    take_over(source, failure);
    records_->failed(failure);
}

void IsolatedSweep::take_block(Source& source, SweepBlock block) {
    Entry& entry = entry_of(source, block.item);
    if (source.block.item != block.item) flush(source);
    if (source.block.rows.empty()) {
        source.block.item = block.item;
        source.block_begun = Clock::now();
    }
    for (const SweepRow& row : block.rows) source.under_way.erase(row.vertex);
    entry.done += block.rows.size();
    progress_now_.solves_done += static_cast<std::int64_t>(block.rows.size());
    source.block.rows.insert(source.block.rows.end(), block.rows.begin(), block.rows.end());
    std::move(block.kept.begin(), block.kept.end(), std::back_inserter(source.block.kept));
    drop_needless(source.block.kept, keep_);
    report();
}

void IsolatedSweep::flush(Source& source) {
    SweepBlock block = std::exchange(source.block, {});
    if (block.rows.empty()) return;
    try {
        records_->finished(block);
    } catch (const std::invalid_argument& e) {
        // Its rows contradict themselves or the mesh: a child gone astray.
        failed(source, {block.item, kSweepStage, std::string(name_of(Status::internal_error)),
                        fmt::format("rows of its process were refused: {}", e.what())});
    }
}

void IsolatedSweep::tick() {
    for (Source& source : sources_)
        if (!source.block.rows.empty() && seconds_since(source.block_begun) > kBlockSeconds) flush(source);
}

IsolatedWork::Verdict IsolatedSweep::ended(std::size_t task, const ChildEnd& end, const ChildShare& share) {
    Source& source = sources_[task];
    flush(source);
    if (end.stopped) return Verdict::finished;
    if (source.done) {
        set_named(source);
        return Verdict::finished;
    }
    if (deserves_all(end, share)) {
        spdlog::warn("{}: {}; to be tried again alone", source.source.name, end.fate());
        return Verdict::alone;
    }
    if (between_items(source) && source.unexplained++ == 0) return Verdict::again;
    // Whatever has been blamed before is skipped now, so it cannot be that.
    if (records_->has_failed(source.stage.item, source.stage.stage))
        source.stage = {source.source.name, kLoadStage};
    const bool load = source.stage.stage == kLoadStage;
    record_death(source, end);
    const bool more = !source.opened || std::any_of(source.items.begin(), source.items.end(),
                                                    [](const auto& item) { return !item.second.over; });
    if (!load && more) return Verdict::again;
    set_named(source);
    return Verdict::finished;
}

/// An item is over, and the next stage has not begun: nothing was under way that could be blamed.
bool IsolatedSweep::between_items(const Source& source) {
    return source.stage.stage == kSweepStage && source.under_way.empty() && !source.exception &&
           std::any_of(source.items.begin(), source.items.end(), [&](const auto& entry) {
               return entry.second.item.name == source.stage.item && entry.second.over;
           });
}

/// The configuration of the run reduced to what was under way.
FailureBundle IsolatedSweep::bundle_of(const Source& source) const {
    FailureBundle bundle;
    bundle.mesh_file = source.source.file;
    bundle.arguments = {"sweep", "--config", "config.toml"};
    SweepConfig config = config_;
    config.meshes = {bundled_mesh(bundle.mesh_file)};
    config.output = "reproduced.h5";
    config.isolate = false;
    const SweepStage& stage = source.stage;
    if (stage.stage != kLoadStage) {
        config.component = stage.component;
        config.resolutions = {stage.resolution > 0 ? std::to_string(stage.resolution) : "input"};
    }
    const VertexChoice choice = parse_vertices(config.vertices);
    std::vector<Index> vertices(source.under_way.begin(), source.under_way.end());
    config.shard.clear();  // the plan for one file alone would be another
    if (vertices.empty() && choice.kind == VertexChoice::Kind::list) vertices = choice.list;
    if (!vertices.empty()) {
        config.vertices = "vertices.txt";
        bundle.files[config.vertices] = fmt::format("{}\n", fmt::join(vertices, "\n"));
    }
    bundle.files["config.toml"] = to_toml(config, false);
    return bundle;
}

void IsolatedSweep::record_death(Source& source, const ChildEnd& end) {
    const SweepStage& stage = source.stage;
    FailureBundle bundle = bundle_of(source);
    bundle.end = end;
    bundle.failure = {stage.item, stage.stage, std::string(name_of(end.status())), end.fate()};
    if (source.exception) {
        bundle.failure.status = source.exception->status;
        bundle.failure.message = source.exception->message;
    }
    if (!source.under_way.empty())
        bundle.failure.message += fmt::format(", while solving vertices {}", listed(source.under_way));
    bundle.failure.message += fmt::format("; reproducer in {}", bundle_folder(config_.output, stage.item));
    failed(source, bundle.failure);
    if (const std::string trouble = write_bundle(config_.output, bundle); !trouble.empty())
        spdlog::warn("{}", trouble);
}

void IsolatedSweep::report() {
    progress_now_.seconds = seconds_since(start_);
    progress_->show(progress_now_);
}

void IsolatedSweep::set_named(Source& source) {
    progress_now_.sources_opened += source.named ? 0 : 1;
    source.named = true;
    report();
}

std::vector<SweepItem> IsolatedSweep::items() const {
    std::vector<SweepItem> items;
    for (const Source& source : sources_) {
        if (source.load) items.push_back(*source.load);
        for (const auto& [place, entry] : source.items) items.push_back(entry.item);
    }
    return items;
}

}  // namespace ricci::app
