// Joining the result files of the shards of one run into the file that a run on one machine would have made.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/store/run_store.h"

namespace ricci {

/// Files that are not the whole of one run. what() is the first complaint.
class ShardError : public std::runtime_error {
  public:
    explicit ShardError(std::vector<std::string> complaints)
        : std::runtime_error(complaints.at(0)), complaints_(std::move(complaints)) {}
    /// All that is wrong, each naming shard, file or item.
    [[nodiscard]] const std::vector<std::string>& complaints() const { return complaints_; }

  private:
    std::vector<std::string> complaints_;
};

/// What was joined.
struct MergedRun {
    std::size_t shards = 0, items = 0;
    std::size_t rows = 0, failed_rows = 0;  // all of them, and those that did not converge
    std::size_t failures = 0;               // rows of /failures
    std::vector<std::string> warnings{};    // for the log; the file is a whole run all the same
};

/// Checks that `shards` are complete, sound, and all those of one run, and writes that run to `output`, each
/// dataset the same bits as without shards (*/seconds aside) where all ran on one kind of processor; one item
/// at a time is in memory. `merger` gives
/// command and host; the rest comes from the shards. An existing `output` is replaced only by a whole and
/// verified file. Throws ShardError when the files do not make up a run, FileError when one cannot be read or
/// `output` cannot be written.
MergedRun merge_shards(const std::vector<std::string>& shards, const std::string& output,
                       const RunInfo& merger);

}  // namespace ricci
