// The folder of a run in progress: a lock, the journal, and the immutable segments it proves. What the
// segments hold is its owner's business (io/store/run_store.h, io/store/index_store.h).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/store/durable.h"
#include "io/store/hdf5_file.h"
#include "io/store/journal.h"

namespace ricci {

/// OUTPUT.parts, held under a lock. Not thread-safe: the owner has a mutex. Callers of write_segment() and
/// replace_output() need no hdf5::Session; those of the functions handed in run within one.
class SegmentFolder {
  public:
    /// Creates the folder where it is missing. Throws FileError when another run holds it.
    explicit SegmentFolder(std::string output);
    ~SegmentFolder();
    SegmentFolder(const SegmentFolder&) = delete;
    SegmentFolder& operator=(const SegmentFolder&) = delete;

    [[nodiscard]] const std::string& output() const { return output_; }
    [[nodiscard]] const std::string& folder() const { return folder_; }
    [[nodiscard]] bool has_journal() const;
    /// A journal is open: results can be taken in.
    [[nodiscard]] bool open() const { return journal_.has_value(); }
    /// The journal proves something that the output does not hold.
    [[nodiscard]] bool has_work() const { return has_work_; }

    /// Throws std::invalid_argument unless fingerprint and status names of `found`, read at `where`, are
    /// those of `expected`.
    static void require_same_run(const std::string& where, const JournalHeader& found,
                                 const JournalHeader& expected);

    /// Empties the folder and starts a journal. Throws FileError.
    void start(const JournalHeader& header);
    /// Opens the journal and removes files that it does not name. `accept(path, entry)` takes in a segment
    /// whose bytes match their checksum; those that are missing or have other bytes are dropped with a note
    /// that describes them by `describe(entry)`. `other(entry)` gets, in order, lines that are no segments.
    /// Throws FileError when nothing can be resumed or something cannot be read, std::invalid_argument for
    /// another run's.
    void resume(const JournalHeader& header,
                const std::function<void(const std::string& path, const JournalEntry& entry)>& accept,
                const std::function<void(const JournalEntry& entry)>& other,
                const std::function<std::string(const JournalEntry& entry)>& describe);

    /// Writes a segment: a temporary file that `fill` fills, fsynced, read back and compared with its
    /// checksums, shown to `read_back(temporary, final path)`, renamed, journalled, fsynced at each step.
    /// Throws FileError, and std::logic_error when no journal is open.
    void write_segment(
        JournalEntry entry, const std::function<void(hid_t root)>& fill,
        const std::function<void(const std::string& temporary, const std::string& path)>& read_back);
    /// Appends a line. Throws FileError, std::logic_error as above.
    void append(const JournalEntry& entry);

    /// What has been accepted, written or taken over since the start is still what it was. Throws FileError
    /// naming what is not; resuming does it again.
    void require_unchanged() const;
    /// The output as it is now is part of what require_unchanged() looks at.
    void rely_on_output();

    /// Makes `write(temporary)` write the result file within the folder, verifies it, renames it to the
    /// output. Throws FileError.
    void replace_output(const std::function<void(const std::string& temporary)>& write) const;

    /// Closes the journal and removes the folder; what cannot be removed becomes a note.
    void remove() noexcept;

    [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
    void add_note(std::string note) { notes_.push_back(std::move(note)); }

  private:
    [[nodiscard]] static std::string damage_of(const std::string& path, std::uint64_t checksum);

    std::string output_, folder_;
    std::optional<FolderLock> lock_;
    std::optional<Journal> journal_;
    std::vector<std::string> notes_;
    std::vector<std::pair<std::string, std::uint64_t>> relied_on_;  // files by path, and their checksums
    std::uint64_t next_segment_ = 1;
    bool has_work_ = false, removed_ = false;
};

}  // namespace ricci
