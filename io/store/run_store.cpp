#include "io/store/run_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "io/store/assemble.h"
#include "io/store/run_state.h"
#include "io/store/schema.h"
#include "io/store/schema_shard.h"
#include "io/store/segment_folder.h"
#include "io/store/verify_file.h"

namespace ricci {
namespace {

namespace fs = std::filesystem;

FailureRecord stored_failure(const FailureRecord& failure) {
    return {hdf5::stored_text(failure.item), hdf5::stored_text(failure.stage),
            hdf5::stored_text(failure.status), hdf5::stored_text(failure.message)};
}

constexpr std::string_view kBetweenProcessors = "; ";

std::string joined(const std::set<std::string>& processors) {
    return fmt::format("{}", fmt::join(processors, kBetweenProcessors));
}

void take_processors(const std::string& text, std::set<std::string>& processors) {
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find(kBetweenProcessors, begin), text.size());
        processors.insert(text.substr(begin, end - begin));
        begin = end + kBetweenProcessors.size();
    }
}

}  // namespace

std::string stored_form(const std::string& text) {
    return hdf5::stored_text(text);
}

struct RunStore::Impl {
    Impl(std::string output, RunInfo run_info, bool resume);

    void start_afresh(bool resume);
    void resume_journal();
    bool resume_output();
    void note_processor();
    void write_segment(const std::string& kind, const std::string& item, const std::vector<Index>& vertices,
                       const std::function<void(hid_t item_group)>& fill);
    ItemState& writable_item(const std::string& name);
    [[nodiscard]] const ItemState* find_item(const std::string& name) const;
    [[nodiscard]] JournalHeader header() const {
        return {hdf5::stored_text(info.fingerprint), info.status.names, hdf5::stored_text(info.processor)};
    }

    const RunInfo info;
    mutable std::mutex mutex;
    SegmentFolder parts;
    RunState state;
};

RunStore::Impl::Impl(std::string output, RunInfo run_info, bool resume)
    : info(std::move(run_info)), parts(std::move(output)) {
    if (resume && parts.has_journal())
        resume_journal();
    else
        start_afresh(resume);
    note_processor();
}

void RunStore::Impl::note_processor() {
    const std::string own = hdf5::stored_text(info.processor);
    if (own.empty() || state.processors.contains(own)) return;
    if (!state.processors.empty()) {
        parts.add_note(
            fmt::format("{}: begun on another kind of processor ({}; here: {}): results agree to the "
                        "tolerance, but not to the last bit",
                        parts.output(), joined(state.processors), own));
        parts.append({"processor", own, "", {}, 0, {}});
    }
    state.processors.insert(own);
}

void RunStore::Impl::start_afresh(bool resume) {
    if (resume && !fs::is_empty(parts.folder()))
        parts.add_note(parts.folder() + ": no journal, so its contents are removed");
    const bool finished = resume && resume_output();
    parts.start(header());
    if (finished) parts.append({"base", fs::path(parts.output()).filename().string(), "", {}, 0, {}});
}

// Takes the complete output as one big segment; false when there is none worth it.
bool RunStore::Impl::resume_output() {
    const std::string& output = parts.output();
    if (!fs::exists(output)) return false;
    const std::vector<std::string> complaints = verify_result_file(output);
    if (!complaints.empty()) {
        parts.add_note(fmt::format("{}: not a sound result file, so nothing of it is used: {}", output,
                                   complaints.front()));
        return false;
    }
    const hdf5::Session session;
    {
        const hdf5::Handle file = hdf5::open_input(output);
        const RunInfo stored = schema::read_run_info(file);
        SegmentFolder::require_same_run(output, {stored.fingerprint, stored.status.names}, header());
        if (const auto shard = schema::read_shard(file)) take_processors(shard->processors, state.processors);
    }
    parts.rely_on_output();
    merge_contents(state, read_contents(output, output, info.status));
    require_rows_of_vertices(state, output);
    return true;
}

void RunStore::Impl::resume_journal() {
    parts.resume(
        header(),
        [&](const std::string& path, const JournalEntry&) {
            merge_contents(state, read_contents(path, path, info.status));
        },
        [&](const JournalEntry& entry) {
            const std::pair key(entry.failure.item, entry.failure.stage);
            if (entry.kind == "base")
                resume_output();
            else if (entry.kind == "processor")
                state.processors.insert(entry.name);
            else if (entry.kind == "failure")
                state.failures.insert_or_assign(key, entry.failure);
            else
                state.failures.erase(key);
        },
        [](const JournalEntry& entry) {
            const std::string what = fmt::format("{} of {}", entry.kind, entry.item);
            if (entry.kind != "sweep") return what;
            std::int64_t count = 0;
            for (const VertexRun& run : entry.vertices) count += run.count;
            if (count == 0) return what + " (no vertices)";
            return fmt::format("{} ({} vertices from {} to {})", what, count, entry.vertices.front().first,
                               entry.vertices.back().first + (entry.vertices.back().count - 1));
        });
    require_rows_of_vertices(state, parts.folder());
}

void RunStore::Impl::write_segment(const std::string& kind, const std::string& item,
                                   const std::vector<Index>& vertices,
                                   const std::function<void(hid_t item_group)>& fill) {
    std::optional<RunState> part;
    parts.write_segment(
        {kind, "", item, runs_of(vertices), 0, {}},
        [&](hid_t root) {
            const hdf5::Handle items = hdf5::create_group(root, "items");
            const hdf5::Handle group = hdf5::create_group(items, item);
            fill(group);
        },
        [&](const std::string& temporary, const std::string& path) {
            part = read_contents(temporary, path, info.status);
        });
    merge_contents(state, std::move(*part));
}

const ItemState* RunStore::Impl::find_item(const std::string& name) const {
    const auto found = state.items.find(hdf5::stored_text(name));
    return found == state.items.end() ? nullptr : &found->second;
}

// The stored item that results may be added to.
ItemState& RunStore::Impl::writable_item(const std::string& name) {
    if (!parts.open()) throw std::logic_error("the run is assembled: it takes no more results");
    const auto found = state.items.find(name);
    if (found == state.items.end() || found->second.file.empty())
        throw std::invalid_argument("item " + name + " is not stored yet");
    return found->second;
}

RunStore::RunStore(std::string output, RunInfo info, bool resume) {
    if (info.status.names.empty() || info.status.names.size() > 256)
        throw std::invalid_argument("a run has between 1 and 256 status names");
    impl_ = std::make_unique<Impl>(std::move(output), std::move(info), resume);
}

RunStore::~RunStore() {
    if (impl_->parts.open() && !impl_->parts.has_work()) impl_->parts.remove();
}

bool RunStore::has_item(const std::string& item) const {
    const std::lock_guard guard(impl_->mutex);
    const ItemState* found = impl_->find_item(item);
    return found != nullptr && !found->file.empty();
}

ItemRecord RunStore::read_item(const std::string& item) const {
    const std::lock_guard guard(impl_->mutex);
    const ItemState* found = impl_->find_item(item);
    if (found == nullptr || found->file.empty())
        throw std::invalid_argument("item " + item + " is not stored");
    const hdf5::Session session;
    const hdf5::Handle file = hdf5::open_input(found->file);
    const std::string name = hdf5::stored_text(item);
    return schema::read_item(hdf5::open_group(file, item_path(name)), name);
}

std::optional<ItemSource> RunStore::source_of(const std::string& item) const {
    const std::lock_guard guard(impl_->mutex);
    const ItemState* found = impl_->find_item(item);
    if (found == nullptr || found->file.empty()) return std::nullopt;
    return found->source;
}

std::vector<std::string> RunStore::items() const {
    const std::lock_guard guard(impl_->mutex);
    std::vector<std::string> names;
    for (const auto& [name, item] : impl_->state.items)
        if (!item.file.empty()) names.push_back(name);
    return names;
}

std::vector<SweepRow> RunStore::finished_rows(const std::string& item) const {
    const std::lock_guard guard(impl_->mutex);
    std::vector<SweepRow> rows;
    const ItemState* found = impl_->find_item(item);
    if (found == nullptr) return rows;
    ItemState recalled;
    if (!found->rows_at_hand) {
        recalled = *found;
        const hdf5::Session session;
        recall_rows(recalled, hdf5::stored_text(item), impl_->info.status);
        found = &recalled;
    }
    for (const auto& [vertex, row] : found->rows) rows.push_back(row);
    return rows;
}

std::vector<Index> RunStore::finished_vertices(const std::string& item) const {
    std::vector<Index> vertices;
    for (const SweepRow& row : finished_rows(item)) vertices.push_back(row.vertex);
    return vertices;
}

bool RunStore::has_flow(const std::string& item) const {
    const std::lock_guard guard(impl_->mutex);
    const ItemState* found = impl_->find_item(item);
    return found != nullptr && !found->flow_file.empty();
}

bool RunStore::has_result(const std::string& item, const std::string& kind) const {
    const std::lock_guard guard(impl_->mutex);
    const ItemState* found = impl_->find_item(item);
    return found != nullptr && found->result_files.contains(kind);
}

bool RunStore::has_failure(const FailureRecord& failure) const {
    const FailureRecord stored = stored_failure(failure);
    const std::lock_guard guard(impl_->mutex);
    return impl_->state.failures.contains(std::pair(stored.item, stored.stage));
}

std::optional<FailureRecord> RunStore::failure_of(const std::string& item, const std::string& stage) const {
    const std::lock_guard guard(impl_->mutex);
    const auto found = impl_->state.failures.find({hdf5::stored_text(item), hdf5::stored_text(stage)});
    if (found == impl_->state.failures.end()) return std::nullopt;
    return found->second;
}

std::vector<FailureRecord> RunStore::failures() const {
    const std::lock_guard guard(impl_->mutex);
    std::vector<FailureRecord> failures;
    for (const auto& [key, failure] : impl_->state.failures) failures.push_back(failure);
    return failures;
}

std::vector<std::string> RunStore::notes() const {
    const std::lock_guard guard(impl_->mutex);
    return impl_->parts.notes();
}

void RunStore::release(const std::string& item) {
    const std::lock_guard guard(impl_->mutex);
    const auto found = impl_->state.items.find(hdf5::stored_text(item));
    if (found != impl_->state.items.end()) release_rows(found->second);
}

void RunStore::write_item(const ItemRecord& item) {
    schema::require_valid(item);
    const std::string name = hdf5::stored_text(item.name);
    const std::lock_guard guard(impl_->mutex);
    const ItemState* known = impl_->find_item(item.name);
    if (known != nullptr && !known->file.empty())
        throw std::invalid_argument("item " + name + " is stored already");
    impl_->write_segment("item", name, {}, [&](hid_t group) { schema::write_item(group, item); });
    require_rows_of_vertices(impl_->state, impl_->parts.folder());  // of rows that came before their mesh
}

void RunStore::write_sweep_block(const SweepBlock& block) {
    const std::string name = hdf5::stored_text(block.item);
    const std::lock_guard guard(impl_->mutex);
    ItemState& item = impl_->writable_item(name);
    schema::require_valid(block, item.vertex_count, impl_->info.status);
    {
        const hdf5::Session session;
        recall_rows(item, name, impl_->info.status);
    }
    std::vector<SweepRow> rows = block.rows;
    std::sort(rows.begin(), rows.end(),
              [](const SweepRow& a, const SweepRow& b) { return a.vertex < b.vertex; });
    std::vector<Index> vertices;
    for (const SweepRow& row : rows) {
        const auto known = item.rows.find(row.vertex);
        if ((known != item.rows.end() && !replaceable(known->second)) ||
            (!vertices.empty() && vertices.back() == row.vertex))
            throw std::invalid_argument(
                fmt::format("item {}: vertex {} is stored already", name, row.vertex));
        vertices.push_back(row.vertex);
    }
    if (rows.empty()) return;
    impl_->write_segment("sweep", name, vertices, [&](hid_t group) {
        const hdf5::Handle sweep = hdf5::create_group(group, "sweep");
        schema::write_rows(sweep, rows, impl_->info.status);
        if (block.kept.empty()) return;
        const hdf5::Handle kept = hdf5::create_group(sweep, "kept");
        std::vector<Index> kept_vertices;
        for (const KeptFactor& factor : block.kept) kept_vertices.push_back(factor.vertex);
        hdf5::write_array(kept, "vertex", kept_vertices);
        hdf5::RowWriter writer(kept, "conformal_factor", block.kept.size(), item.vertex_count);
        for (const KeptFactor& factor : block.kept) writer.append(factor.conformal_factor);
        writer.finish();
    });
}

void RunStore::write_flow(const FlowRecord& flow) {
    const std::string name = hdf5::stored_text(flow.item);
    const std::lock_guard guard(impl_->mutex);
    const ItemState& item = impl_->writable_item(name);
    schema::require_valid(flow, item.vertex_count, impl_->info.status);
    if (!item.flow_file.empty()) throw std::invalid_argument("the flow of " + name + " is stored already");
    impl_->write_segment("flow", name, {}, [&](hid_t group) {
        schema::write_flow(hdf5::create_group(group, "flow"), flow, impl_->info.status);
    });
}

void RunStore::write_result(const ResultGroup& result) {
    const std::string name = hdf5::stored_text(result.item);
    const std::lock_guard guard(impl_->mutex);
    const ItemState& item = impl_->writable_item(name);
    schema::require_valid(result, impl_->info.status);
    if (item.result_files.contains(result.kind))
        throw std::invalid_argument(fmt::format("the {} of {} is stored already", result.kind, name));
    impl_->write_segment(result.kind, name, {}, [&](hid_t group) {
        schema::write_result(hdf5::create_group(group, result.kind), result, impl_->info.status);
    });
}

void RunStore::write_failure(const FailureRecord& failure) {
    const FailureRecord stored = stored_failure(failure);
    const std::lock_guard guard(impl_->mutex);
    impl_->parts.append({"failure", "", "", {}, 0, stored});
    impl_->state.failures.insert_or_assign(std::pair(stored.item, stored.stage), stored);
}

void RunStore::retract_failure(const FailureRecord& failure) {
    const FailureRecord stored = stored_failure(failure);
    const std::lock_guard guard(impl_->mutex);
    const std::pair key(stored.item, stored.stage);
    if (!impl_->state.failures.contains(key)) return;
    impl_->parts.append({"retract", "", "", {}, 0, stored});
    impl_->state.failures.erase(key);
}

void RunStore::assemble(const std::vector<std::string>& items, const KeepPolicy& keep,
                        const ShardTable* shard) {
    const std::lock_guard guard(impl_->mutex);
    if (!impl_->parts.open()) throw std::logic_error("the run is assembled already");
    std::vector<std::string> names;
    names.reserve(items.size());
    for (const std::string& item : items) names.push_back(hdf5::stored_text(item));
    std::optional<ShardTable> table;
    if (shard != nullptr) {
        table = *shard;
        if (!impl_->state.processors.empty()) table->processors = joined(impl_->state.processors);
    }
    impl_->parts.replace_output([&](const std::string& temporary) {
        write_result_file(temporary, impl_->info, impl_->state, names, keep, table ? &*table : nullptr);
    });
    for (auto& [name, item] : impl_->state.items) {
        if (!item.file.empty()) item.file = impl_->parts.output();  // for read_item
        item.factors.clear();
        if (!item.sweep_files.empty()) item.sweep_files = {impl_->parts.output()};
    }
    impl_->parts.remove();
}

}  // namespace ricci
