// This program started anew as a child: a socket for messages, a pipe for its stderr, a process group of its
// own that dies with the parent.
#pragma once

#include <sys/types.h>

#include <string>
#include <string_view>
#include <vector>

#include "engine/app/isolation/message.h"
#include "engine/flow/status.h"
#include "io/store/durable.h"

namespace ricci::app {

/// Why a parent kills.
enum class KilledFor : std::uint8_t {
    nothing,    // it did not
    silence,    // no sign of life
    memory,     // more than its share
    astray,     // it sent what makes no sense
    not_ending  // when it was told to
};

/// How a child ended.
struct ChildEnd {
    int exit_status = -1;  // -1: ended by a signal
    int signal = 0;        // that ended it
    KilledFor killed_for = KilledFor::nothing;
    std::string reason;       // the same for people
    bool stopped = false;     // the whole run was told to stop
    bool in_company = false;  // other children ran beside it
    std::string errors;       // the end of what it wrote to stderr

    [[nodiscard]] bool out_of_memory() const;
    /// It ended because somebody, not the parent for a reason of its own, sent it SIGINT or SIGTERM.
    [[nodiscard]] bool told_to_end() const;
    /// timeout, out_of_memory or internal_error.
    [[nodiscard]] Status status() const;
    /// The same for people.
    [[nodiscard]] std::string fate() const;
};

/// Exit status of a child that could get no memory.
inline constexpr int kExitOutOfMemory = 97;

/// Exit status of a child that this program could not be started in.
inline constexpr int kExitNotStarted = 127;

/// "SIGSEGV", or "signal 99" for one without a name.
std::string signal_name(int number);

/// Path of this program's file.
std::string own_program();

/// fork(2) and execve(2) of /proc/self/exe, so that nothing of the parent's threads, locks and memory is in
/// it.
class ChildProcess {
  public:
    /// Its stdin is the socket; its stdout and stderr are the pipe. Throws FileError.
    explicit ChildProcess(const std::vector<std::string>& arguments);
    /// Kills the group and waits.
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// File descriptors to poll; -1 once they have ended.
    [[nodiscard]] int messages() const { return messages_.get(); }
    [[nodiscard]] int errors() const { return errors_.get(); }
    /// Bytes wait for room in the socket.
    [[nodiscard]] bool has_unsent() const { return !unsent_.empty() && messages_.get() >= 0; }

    /// Never blocks: what the socket has no room for waits for send_more().
    void send(std::uint32_t kind, std::string_view bytes);
    void send_more();
    /// Reads what is there without blocking; false when nothing was. next_message() then gives whole ones and
    /// throws ProtocolError on garbage.
    bool receive();
    std::optional<Frame> next_message() { return assembler_.next(); }

    /// Bytes of memory that are its own and in use.
    [[nodiscard]] std::int64_t memory() const;
    /// To every process of the group.
    void signal_group(int number) const;
    /// Reaps it if it has ended, and reads what it left in its pipes.
    bool has_ended();
    /// Once it has ended.
    [[nodiscard]] const ChildEnd& end() const { return end_; }

  private:
    bool receive_from(FileDescriptor& source, bool errors);

    pid_t pid_ = -1;
    FileDescriptor messages_, errors_;
    FrameAssembler assembler_;
    std::string unsent_;
    bool ended_ = false;
    ChildEnd end_;
};

}  // namespace ricci::app
