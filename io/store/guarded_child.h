// Work on files nobody vouches for, in a child process that may crash, loop or devour memory without harm.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "io/mesh/mesh_file.h"

namespace ricci {

/// The child was killed from outside or got no processor: nothing is known of the file.
class GuardUndecided : public FileError {
  public:
    using FileError::FileError;
};

/// What the child may use before it is killed.
struct ChildLimits {
    std::uint64_t seconds = 10;      // of its own processor time; twice that by the clock, plus a minute
    std::uint64_t memory_bytes = 0;  // beyond what the parent has mapped
};

/// Limits for a file of so many bytes: a megabyte per second is slower than any disk worth the name, and
/// contents are read in pieces or a few times the file's size.
ChildLimits foreign_file_limits(std::uint64_t file_bytes);

/// Runs `work` in a forked child and returns what it returns; a child that crashes, is killed by a limit, or
/// throws becomes one complaint; GuardUndecided where that says nothing. The caller holds an hdf5::Session,
/// so that no other thread is inside HDF5 at the fork; `work` must not open another. Throws FileError when no
/// child can be had.
std::vector<std::string> run_guarded(const ChildLimits& limits,
                                     const std::function<std::vector<std::string>()>& work);

}  // namespace ricci
