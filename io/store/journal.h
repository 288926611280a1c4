// The journal of a run in progress: one line of JSON per fact, appended and fsynced only after the fact is
// durable. Each line ends with the checksum of its own bytes, so that a torn or damaged line is never
// believed.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "io/store/durable.h"
#include "io/store/run_store.h"

namespace ricci {

/// First line of a journal: what the run is.
struct JournalHeader {
    std::string fingerprint;
    std::vector<std::string> status_names;
    /// RunInfo's of the first start; "": not recorded. SegmentFolder::resume() hands it on as if it were a
    /// line of kind "processor".
    std::string processor{};
};

/// Vertices first, first + 1, ... first + count - 1.
struct VertexRun {
    Index first = 0, count = 0;
};
/// Runs of ascending vertices.
std::vector<VertexRun> runs_of(const std::vector<Index>& vertices);

/// One fact. `kind` is "failure" (kept in the line itself), "retract" (drops the failure of the same item and
/// stage), "drop" (the segment `name` turned out damaged), "base" (the complete result file is itself a
/// segment), "processor" (a later start ran on another kind, `name`) or what a segment holds: "item",
/// "sweep", "flow" or the kind of a further result (name, item, checksum and, for "sweep", vertices).
struct JournalEntry {
    std::string kind, name, item;
    std::vector<VertexRun> vertices;  // ascending; stored as [first, count]
    std::uint64_t checksum = 0;       // XXH3-64 of the segment file
    FailureRecord failure;

    [[nodiscard]] bool segment() const { return kind != "failure" && kind != "retract" && result(); }
    /// Says something that the output may lack.
    [[nodiscard]] bool result() const { return kind != "drop" && kind != "base" && kind != "processor"; }
};

/// What a journal says.
struct JournalContents {
    JournalHeader header;
    std::vector<JournalEntry> entries;
    std::vector<std::string> notes;  // lines that were not believed
    std::uint64_t end = 0;           // bytes up to the end of the last whole line
};

/// File name of the journal in the parts folder.
std::string journal_path(const std::string& folder);

/// Reads a journal. A torn last line is ignored, a damaged line elsewhere skipped, both with a note. Throws
/// FileError when the first line cannot be believed (then nothing can), and for lines that this program does
/// not write, such as segments outside of the folder.
JournalContents read_journal(const std::string& folder);

/// An open journal, for appending.
class Journal {
  public:
    /// Creates the journal with its first line. Throws FileError.
    static Journal create(const std::string& folder, const JournalHeader& header);
    /// Continues one: cuts a torn end off first. Throws FileError.
    static Journal reopen(const std::string& folder, const JournalContents& contents);

    /// Appends a line and fsyncs. Throws FileError; the journal then ends where it ended before, or takes no
    /// more.
    void append(const JournalEntry& entry);

  private:
    Journal(std::string path, std::uint64_t end);
    std::string path_;
    FileDescriptor file_;
    std::uint64_t end_;
    bool broken_ = false;
};

}  // namespace ricci
