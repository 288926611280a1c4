#include "io/store/run_store.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <mutex>
#include <set>
#include <stdexcept>
#include <utility>

#include "io/store/assemble.h"
#include "io/store/durable.h"
#include "io/store/journal.h"
#include "io/store/run_state.h"
#include "io/store/schema.h"
#include "io/store/verify_file.h"

namespace ricci {
namespace {

namespace fs = std::filesystem;

// Removes everything in the folder, the journal first: segments without a journal prove nothing, whereas a
// journal without its segments would cry wolf.
void empty_folder(const std::string& folder) {
    std::error_code error;
    fs::remove(journal_path(folder), error);
    if (!error) sync_path(folder);
    fault_point("parts_unproved");
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        std::error_code failed;
        fs::remove_all(entry.path(), failed);
        if (failed) throw system_error(entry.path().string(), "cannot remove", failed.value());
    }
    if (error) throw system_error(folder, "cannot empty the folder", error.value());
}

// The number in "sweep-000012.h5", 0 in other names.
std::uint64_t segment_number(const std::string& name) {
    const std::size_t dash = name.find('-');
    return dash == std::string::npos ? 0 : std::strtoull(name.c_str() + dash + 1, nullptr, 10);
}

FailureRecord stored_failure(const FailureRecord& failure) {
    return {hdf5::stored_text(failure.item), hdf5::stored_text(failure.stage),
            hdf5::stored_text(failure.status), hdf5::stored_text(failure.message)};
}

}  // namespace

struct RunStore::Impl {
    Impl(std::string output_path, RunInfo run_info, bool resume);

    void start_afresh(bool resume);
    void resume_journal();
    void resume_segment(const JournalEntry& entry);
    bool resume_output();
    void require_same_run(const std::string& where, const std::string& fingerprint,
                          const std::vector<std::string>& status_names) const;
    void write_segment(const std::string& kind, const std::string& item, std::vector<Index> vertices,
                       const std::function<void(hid_t item_group)>& fill);
    void require_open() const;
    void append(const JournalEntry& entry);
    void remove_parts() noexcept;
    ItemState& writable_item(const std::string& name);
    [[nodiscard]] const ItemState* find_item(const std::string& name) const;

    const std::string output, folder;
    const RunInfo info;
    mutable std::mutex mutex;
    std::optional<FolderLock> lock;
    std::optional<Journal> journal;
    RunState state;
    std::vector<std::string> notes;
    std::uint64_t next_segment = 1;
    bool has_work = false;  // the journal proves something that the output does not hold
};

RunStore::Impl::Impl(std::string output_path, RunInfo run_info, bool resume)
    : output(std::move(output_path)), folder(output + ".parts"), info(std::move(run_info)) {
    lock.emplace(folder);
    try {
        if (resume && fs::exists(journal_path(folder)))
            resume_journal();
        else
            start_afresh(resume);
    } catch (...) {
        ::rmdir(folder.c_str());  // succeeds when nothing is in it, which is when nobody needs it
        throw;
    }
}

void RunStore::Impl::start_afresh(bool resume) {
    if (resume && !fs::is_empty(folder))
        notes.push_back(folder + ": no journal, so its contents are removed");
    empty_folder(folder);
    const bool finished = resume && resume_output();
    journal.emplace(Journal::create(folder, {hdf5::stored_text(info.fingerprint), info.status.names}));
    if (finished) journal->append({"base", fs::path(output).filename().string(), "", {}, 0, {}});
}

void RunStore::Impl::require_same_run(const std::string& where, const std::string& fingerprint,
                                      const std::vector<std::string>& status_names) const {
    if (fingerprint != hdf5::stored_text(info.fingerprint))
        throw std::invalid_argument(where +
                                    ": made with another configuration; it cannot be resumed with this one");
    if (status_names != info.status.names)
        throw std::invalid_argument(where + ": made with other status names; it cannot be resumed");
}

// Takes the complete output as one big segment; false when there is none worth it.
bool RunStore::Impl::resume_output() {
    if (!fs::exists(output)) return false;
    const std::vector<std::string> complaints = verify_result_file(output);
    if (!complaints.empty()) {
        notes.push_back(fmt::format("{}: not a sound result file, so nothing of it is used: {}", output,
                                    complaints.front()));
        return false;
    }
    const hdf5::Session session;
    {
        const hdf5::Handle file = hdf5::open_input(output);
        const RunInfo stored = schema::read_run_info(file);
        require_same_run(output, stored.fingerprint, stored.status.names);
    }
    merge_contents(state, read_contents(output, output, info.status));
    return true;
}

void RunStore::Impl::resume_segment(const JournalEntry& entry) {
    const std::string path = folder + "/" + entry.name;
    std::string damage = "is missing";
    if (fs::exists(path)) {
        try {
            damage = "does not match its checksum";
            if (checksum_of_file(path) == entry.checksum) {
                const hdf5::Session session;
                merge_contents(state, read_contents(path, path, info.status));
                return;
            }
        } catch (const FileError& error) {
            damage = fmt::format("cannot be read ({})", error.what());
        }
    }
    notes.push_back(
        fmt::format("{}: segment {}; {} of {}{} counts as unfinished", path, damage, entry.kind, entry.item,
                    entry.kind == "sweep" ? fmt::format(" ({} vertices from {} to {})", entry.vertices.size(),
                                                        entry.vertices.empty() ? -1 : entry.vertices.front(),
                                                        entry.vertices.empty() ? -1 : entry.vertices.back())
                                          : ""));
    journal->append({"drop", entry.name, "", {}, 0, {}});
}

void RunStore::Impl::resume_journal() {
    const JournalContents contents = read_journal(folder);
    require_same_run(folder, contents.header.fingerprint, contents.header.status_names);
    notes = contents.notes;
    journal.emplace(Journal::reopen(folder, contents));
    std::set<std::string> dropped;
    for (const JournalEntry& entry : contents.entries)
        if (entry.kind == "drop") dropped.insert(entry.name);
    for (const JournalEntry& entry : contents.entries) {
        next_segment = std::max(next_segment, segment_number(entry.name) + 1);
        has_work = has_work || (entry.kind != "base" && entry.kind != "drop");
        const std::pair key(entry.failure.item, entry.failure.stage);
        if (entry.kind == "base") {
            resume_output();
        } else if (entry.kind == "failure") {
            state.failures.insert_or_assign(key, entry.failure);
        } else if (entry.kind == "retract") {
            state.failures.erase(key);
        } else if (entry.segment() && !dropped.contains(entry.name)) {
            resume_segment(entry);
        }
    }
    std::set<std::string> used{journal_path(folder)};
    for (const JournalEntry& entry : contents.entries) used.insert(folder + "/" + entry.name);
    for (const auto& entry : fs::directory_iterator(folder))
        if (!used.contains(folder + "/" + entry.path().filename().string())) fs::remove(entry.path());
}

// The protocol of a segment: every step is durable before the next one says so.
void RunStore::Impl::write_segment(const std::string& kind, const std::string& item,
                                   std::vector<Index> vertices,
                                   const std::function<void(hid_t item_group)>& fill) {
    require_open();
    const std::string name = fmt::format("{}-{:06}.h5", kind, next_segment++);
    const std::string path = folder + "/" + name;
    const std::string temporary = path + ".tmp";
    const hdf5::Session session;
    try {
        hdf5::write_file(temporary, [&](hdf5::OutputFile& file) {
            const hdf5::Handle items = hdf5::create_group(file.root(), "items");
            const hdf5::Handle group = hdf5::create_group(items, item);
            fill(group);
            fault_point("segment_filled");
        });
        fault_point("segment_written");
        {
            const hdf5::Handle file = hdf5::open_input(temporary);
            const std::vector<std::string> complaints = hdf5::checksum_complaints(file, "/");
            if (!complaints.empty()) throw FileError(temporary + ": read back wrong: " + complaints.front());
        }
        RunState part = read_contents(temporary, path, info.status);
        const std::uint64_t checksum = checksum_of_file(temporary);
        rename_durably(temporary, path);
        fault_point("segment_renamed");
        append({kind, name, item, std::move(vertices), checksum, {}});
        merge_contents(state, std::move(part));
    } catch (const FileError&) {
        ::unlink(temporary.c_str());
        ::unlink(path.c_str());
        throw;
    }
    fault_point("segment_journalled");
}

void RunStore::Impl::require_open() const {
    if (!journal) throw std::logic_error("the run is assembled: it takes no more results");
}

void RunStore::Impl::append(const JournalEntry& entry) {
    require_open();
    journal->append(entry);
    has_work = true;
}

void RunStore::Impl::remove_parts() noexcept {
    journal.reset();
    try {
        empty_folder(folder);
        fs::remove(folder);
    } catch (const std::exception& error) {
        notes.emplace_back(error.what());
    }
}

const ItemState* RunStore::Impl::find_item(const std::string& name) const {
    const auto found = state.items.find(hdf5::stored_text(name));
    return found == state.items.end() ? nullptr : &found->second;
}

// The stored item that results may be added to.
ItemState& RunStore::Impl::writable_item(const std::string& name) {
    require_open();
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
    if (impl_->journal && !impl_->has_work) impl_->remove_parts();
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

std::vector<SweepRow> RunStore::finished_rows(const std::string& item) const {
    const std::lock_guard guard(impl_->mutex);
    std::vector<SweepRow> rows;
    if (const ItemState* found = impl_->find_item(item))
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

std::vector<FailureRecord> RunStore::failures() const {
    const std::lock_guard guard(impl_->mutex);
    std::vector<FailureRecord> failures;
    for (const auto& [key, failure] : impl_->state.failures) failures.push_back(failure);
    return failures;
}

std::vector<std::string> RunStore::notes() const {
    const std::lock_guard guard(impl_->mutex);
    return impl_->notes;
}

void RunStore::write_item(const ItemRecord& item) {
    schema::require_valid(item);
    const std::string name = hdf5::stored_text(item.name);
    const std::lock_guard guard(impl_->mutex);
    const ItemState* known = impl_->find_item(item.name);
    if (known != nullptr && !known->file.empty())
        throw std::invalid_argument("item " + name + " is stored already");
    impl_->write_segment("item", name, {}, [&](hid_t group) { schema::write_item(group, item); });
}

void RunStore::write_sweep_block(const SweepBlock& block) {
    const std::string name = hdf5::stored_text(block.item);
    const std::lock_guard guard(impl_->mutex);
    const ItemState& item = impl_->writable_item(name);
    schema::require_valid(block, item.vertex_count, impl_->info.status);
    std::vector<SweepRow> rows = block.rows;
    std::sort(rows.begin(), rows.end(),
              [](const SweepRow& a, const SweepRow& b) { return a.vertex < b.vertex; });
    std::vector<Index> vertices;
    for (const SweepRow& row : rows) {
        if (item.rows.contains(row.vertex) || (!vertices.empty() && vertices.back() == row.vertex))
            throw std::invalid_argument(
                fmt::format("item {}: vertex {} is stored already", name, row.vertex));
        vertices.push_back(row.vertex);
    }
    if (rows.empty()) return;
    impl_->write_segment("sweep", name, std::move(vertices), [&](hid_t group) {
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
    impl_->append({"failure", "", "", {}, 0, stored});
    impl_->state.failures.insert_or_assign(std::pair(stored.item, stored.stage), stored);
}

void RunStore::retract_failure(const FailureRecord& failure) {
    const FailureRecord stored = stored_failure(failure);
    const std::lock_guard guard(impl_->mutex);
    const std::pair key(stored.item, stored.stage);
    if (!impl_->state.failures.contains(key)) return;
    impl_->append({"retract", "", "", {}, 0, stored});
    impl_->state.failures.erase(key);
}

void RunStore::assemble(const std::vector<std::string>& items, const KeepPolicy& keep) {
    const std::lock_guard guard(impl_->mutex);
    impl_->require_open();
    std::vector<std::string> names;
    names.reserve(items.size());
    for (const std::string& item : items) names.push_back(hdf5::stored_text(item));
    const std::string temporary = impl_->folder + "/assembled.h5.tmp";
    try {
        {
            const hdf5::Session session;
            write_result_file(temporary, impl_->info, impl_->state, names, keep);
        }
        fault_point("assembled");
        const std::vector<std::string> complaints = verify_result_file(temporary);
        if (!complaints.empty()) throw FileError(temporary + ": read back wrong: " + complaints.front());
        rename_durably(temporary, impl_->output);
    } catch (const FileError&) {
        ::unlink(temporary.c_str());
        throw;
    }
    fault_point("assembled_renamed");
    for (auto& [name, item] : impl_->state.items) {
        if (!item.file.empty()) item.file = impl_->output;  // for read_item
        item.factors.clear();
    }
    impl_->remove_parts();
}

}  // namespace ricci
