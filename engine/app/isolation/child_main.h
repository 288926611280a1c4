// What a child process does: the hidden subcommand isolated-child.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "engine/app/commands.h"
#include "engine/app/isolation/child_pool.h"
#include "engine/app/isolation/parent_channel.h"

namespace ricci::app {

/// How a job starts, whatever its kind.
struct JobHeader {
    std::string kind;  // sweep or describe
    ChildShare share;
};
MessageWriter& put_header(MessageWriter& job, const JobHeader& header);

/// Does a job's work; exceptions end the child, and the parent hears of them.
void sweep_in_child(ParentChannel& parent, const ChildShare& share, MessageReader& job);
void describe_in_child(ParentChannel& parent, const ChildShare& share, MessageReader& job);

/// From the child: two texts. An exception ended it: name of the status, message.
inline constexpr std::uint32_t kExceptionMessage = 90;
/// From the child: nothing is left to do.
inline constexpr std::uint32_t kDoneMessage = 91;

void add_isolated_child(CLI::App& app, Action& action);

/// So many threads more may run than the child began with: their stacks do not count as its memory.
void allow_threads(int more);

/// Ends this process as one that could get no memory (kExitOutOfMemory).
[[noreturn]] void end_out_of_memory();

}  // namespace ricci::app
