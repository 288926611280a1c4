#include "io/store/segment_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <utility>

#include "io/store/foreign_file.h"
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

std::set<std::string> dropped_segments(const std::vector<JournalEntry>& entries) {
    std::set<std::string> dropped;
    for (const JournalEntry& entry : entries)
        if (entry.kind == "drop") dropped.insert(entry.name);
    return dropped;
}

void remove_strangers(const std::string& folder, const std::vector<JournalEntry>& entries) {
    std::set<std::string> used{journal_path(folder)};
    for (const JournalEntry& entry : entries) used.insert(folder + "/" + entry.name);
    for (const auto& entry : fs::directory_iterator(folder))
        if (!used.contains(folder + "/" + entry.path().filename().string())) fs::remove(entry.path());
}

}  // namespace

SegmentFolder::SegmentFolder(std::string output) : output_(std::move(output)), folder_(output_ + ".parts") {
    lock_.emplace(folder_);
}

SegmentFolder::~SegmentFolder() {
    // Succeeds when nothing is in it, which is when nobody needs it.
    if (!journal_ && !removed_) ::rmdir(folder_.c_str());
}

bool SegmentFolder::has_journal() const {
    return fs::exists(journal_path(folder_));
}

void SegmentFolder::require_same_run(const std::string& where, const JournalHeader& found,
                                     const JournalHeader& expected) {
    if (found.fingerprint != expected.fingerprint)
        throw std::invalid_argument(where +
                                    ": made with another configuration; it cannot be resumed with this one");
    if (found.status_names != expected.status_names)
        throw std::invalid_argument(where + ": made with other status names; it cannot be resumed");
}

void SegmentFolder::start(const JournalHeader& header) {
    empty_folder(folder_);
    journal_.emplace(Journal::create(folder_, header));
}

std::string SegmentFolder::damage_of(const std::string& path, std::uint64_t checksum) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (status.type() == fs::file_type::not_found) return "does not exist";
    if (error) throw system_error(path, "cannot be looked at", error.value());
    return checksum_of_file(path) == checksum ? "" : "does not match its checksum";
}

void SegmentFolder::resume(
    const JournalHeader& header,
    const std::function<void(const std::string& path, const JournalEntry& entry)>& accept,
    const std::function<void(const JournalEntry& entry)>& other,
    const std::function<std::string(const JournalEntry& entry)>& describe) {
    const JournalContents contents = read_journal(folder_);
    require_same_run(folder_, contents.header, header);
    notes_.insert(notes_.end(), contents.notes.begin(), contents.notes.end());
    journal_.emplace(Journal::reopen(folder_, contents));
    if (!contents.header.processor.empty()) other({"processor", contents.header.processor, "", {}, 0, {}});
    const std::set<std::string> dropped = dropped_segments(contents.entries);
    for (const JournalEntry& entry : contents.entries) {
        next_segment_ = std::max(next_segment_, segment_number(entry.name) + 1);
        has_work_ = has_work_ || entry.result();
        if (!entry.segment()) {
            if (entry.kind != "drop") other(entry);
            continue;
        }
        if (dropped.contains(entry.name)) continue;
        const std::string path = folder_ + "/" + entry.name;
        // Dropped on proof alone: that a disk, a process or memory fails now is no reason to lose what is
        // finished.
        const std::string damage = damage_of(path, entry.checksum);
        if (damage.empty()) {
            const hdf5::Session session;
            hdf5::require_known_form(path);
            accept(path, entry);
            relied_on_.emplace_back(path, entry.checksum);
            continue;
        }
        add_note(fmt::format("{}: segment {}; {} counts as unfinished", path, damage, describe(entry)));
        journal_->append({"drop", entry.name, "", {}, 0, {}});
    }
    remove_strangers(folder_, contents.entries);
}

// Every step is durable before the next one says so.
void SegmentFolder::write_segment(
    JournalEntry entry, const std::function<void(hid_t root)>& fill,
    const std::function<void(const std::string& temporary, const std::string& path)>& read_back) {
    if (!journal_) throw std::logic_error("the run is assembled: it takes no more results");
    entry.name = fmt::format("{}-{:06}.h5", entry.kind, next_segment_++);
    const std::string path = folder_ + "/" + entry.name;
    const std::string temporary = path + ".tmp";
    const hdf5::Session session;
    const hdf5::PlainDatasets plain;  // packing costs more than it saves for the life of a segment
    try {
        hdf5::write_file(temporary, [&](hdf5::OutputFile& file) {
            fill(file.root());
            fault_point("segment_filled");
        });
        fault_point("segment_written");
        {
            const hdf5::Handle file = hdf5::open_input(temporary);
            const std::vector<std::string> complaints = hdf5::checksum_complaints(file, "/");
            if (!complaints.empty()) throw FileError(temporary + ": read back wrong: " + complaints.front());
        }
        read_back(temporary, path);
        entry.checksum = checksum_of_file(temporary);
        rename_durably(temporary, path);
        fault_point("segment_renamed");
        append(entry);
        relied_on_.emplace_back(path, entry.checksum);
    } catch (const FileError&) {
        ::unlink(temporary.c_str());
        ::unlink(path.c_str());
        throw;
    }
    fault_point("segment_journalled");
}

void SegmentFolder::append(const JournalEntry& entry) {
    if (!journal_) throw std::logic_error("the run is assembled: it takes no more results");
    journal_->append(entry);
    has_work_ = has_work_ || entry.result();
}

void SegmentFolder::rely_on_output() {
    relied_on_.emplace_back(output_, checksum_of_file(output_));
}

void SegmentFolder::require_unchanged() const {
    for (const auto& [path, checksum] : relied_on_)
        if (const std::string damage = damage_of(path, checksum); !damage.empty())
            throw FileError(fmt::format(
                "{}: {}, though it did; nothing is assembled from it: --resume computes anew what it held",
                path, damage));
}

void SegmentFolder::replace_output(const std::function<void(const std::string& temporary)>& write) const {
    const std::string temporary = folder_ + "/assembled.h5.tmp";
    require_unchanged();
    try {
        {
            const hdf5::Session session;
            write(temporary);
        }
        fault_point("assembled");
        const std::vector<std::string> complaints = verify_result_file(temporary);
        if (!complaints.empty()) throw FileError(temporary + ": read back wrong: " + complaints.front());
        rename_durably(temporary, output_);
    } catch (...) {  // `write` may throw anything
        ::unlink(temporary.c_str());
        throw;
    }
    fault_point("assembled_renamed");
}

void SegmentFolder::remove() noexcept {
    journal_.reset();
    removed_ = true;
    try {
        empty_folder(folder_);
        fs::remove(folder_);
    } catch (const std::exception& error) {
        notes_.emplace_back(error.what());
    }
}

}  // namespace ricci
