#include "engine/app/isolation/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace ricci::app {
namespace {

constexpr std::size_t kErrorsKept = 16384;

/// Between fork and exec: async-signal-safe calls only.
[[noreturn]] void become_child(pid_t parent, int messages, int errors, char* const* arguments) {
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(kExitNotStarted);  // it died before prctl
    ::dup2(messages, STDIN_FILENO);
    ::dup2(errors, STDOUT_FILENO);
    ::dup2(errors, STDERR_FILENO);
    ::execv("/proc/self/exe", arguments);
    ::_exit(kExitNotStarted);
}

void make_nonblocking(int fd) {
    ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK);
}

}  // namespace

std::string signal_name(int number) {
    const char* name = ::sigabbrev_np(number);
    return name != nullptr ? fmt::format("SIG{}", name) : fmt::format("signal {}", number);
}

bool ChildEnd::out_of_memory() const {
    return exit_status == kExitOutOfMemory || killed_for == KilledFor::memory ||
           (signal == SIGKILL && killed_for == KilledFor::nothing);
}

bool ChildEnd::told_to_end() const {
    const auto by = [&](int number) { return signal == number || exit_status == 128 + number; };
    return killed_for == KilledFor::nothing && (by(SIGINT) || by(SIGTERM));
}

Status ChildEnd::status() const {
    if (killed_for == KilledFor::silence) return Status::timeout;
    return out_of_memory() ? Status::out_of_memory : Status::internal_error;
}

std::string ChildEnd::fate() const {
    if (killed_for != KilledFor::nothing) return fmt::format("its process was killed: {}", reason);
    if (exit_status == kExitOutOfMemory) return "memory ran out";
    if (signal == SIGKILL) return "its process was ended by SIGKILL, most likely for want of memory";
    if (signal != 0) return fmt::format("its process was ended by {}", signal_name(signal));
    return fmt::format("its process ended with exit status {}", exit_status);
}

std::string own_program() {
    std::error_code error;
    const std::filesystem::path path = std::filesystem::read_symlink("/proc/self/exe", error);
    return error ? "ricci" : path.string();
}

ChildProcess::ChildProcess(const std::vector<std::string>& arguments) {
    std::vector<std::string> words{own_program()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    pointers.reserve(words.size() + 1);
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    std::array<int, 2> sockets{}, pipes{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0)
        throw system_error("child process", "cannot create a socket", errno);
    messages_ = FileDescriptor(sockets[0]);
    const FileDescriptor its_messages(sockets[1]);
    if (::pipe2(pipes.data(), O_CLOEXEC) != 0)
        throw system_error("child process", "cannot create a pipe", errno);
    errors_ = FileDescriptor(pipes[0]);
    const FileDescriptor its_errors(pipes[1]);
    make_nonblocking(messages_.get());
    make_nonblocking(errors_.get());
    const pid_t self = ::getpid();
    pid_ = ::fork();
    if (pid_ < 0) throw system_error("child process", "cannot fork", errno);
    if (pid_ == 0) become_child(self, its_messages.get(), its_errors.get(), pointers.data());
    ::setpgid(pid_, pid_);  // here too, so that it is done whoever comes first
}

ChildProcess::~ChildProcess() {
    if (ended_ || pid_ < 0) return;
    signal_group(SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
}

void ChildProcess::send(std::uint32_t kind, std::string_view bytes) {
    unsent_ += framed(kind, bytes);
    send_more();
}

void ChildProcess::send_more() {
    while (has_unsent()) {
        const ssize_t sent = ::send(messages_.get(), unsent_.data(), unsent_.size(), MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
        if (sent < 0) {  // it is dying: has_ended() will say so
            unsent_.clear();
            return;
        }
        unsent_.erase(0, static_cast<std::size_t>(sent));
    }
}

bool ChildProcess::receive_from(FileDescriptor& source, bool errors) {
    // Piece by piece, so that a child that writes fast fills no memory and keeps nobody from the others.
    std::array<char, 65536> buffer{};
    while (source.get() >= 0) {
        const ssize_t got = ::read(source.get(), buffer.data(), buffer.size());
        if (got < 0 && errno == EINTR) continue;
        if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return false;
        if (got <= 0) {
            source.reset();
            return false;
        }
        const std::string_view piece(buffer.data(), static_cast<std::size_t>(got));
        if (!errors) {
            assembler_.add(piece);
            return true;
        }
        end_.errors += piece;
        if (end_.errors.size() > 2 * kErrorsKept) end_.errors.erase(0, end_.errors.size() - kErrorsKept);
        return true;
    }
    return false;
}

bool ChildProcess::receive() {
    receive_from(errors_, true);
    return receive_from(messages_, false);
}

std::int64_t ChildProcess::memory() const {
    // Pages: size, resident, and of the latter those that lie in files.
    std::int64_t size = 0, resident = 0, in_files = 0;
    std::ifstream(fmt::format("/proc/{}/statm", pid_)) >> size >> resident >> in_files;
    return (resident - in_files) * ::sysconf(_SC_PAGESIZE);
}

void ChildProcess::signal_group(int number) const {
    if (!ended_) ::kill(-pid_, number);
}

bool ChildProcess::has_ended() {
    if (ended_) return true;
    int status = 0;
    const pid_t reaped = ::waitpid(pid_, &status, WNOHANG);
    if (reaped == 0 || (reaped < 0 && errno == EINTR)) return false;
    // Whatever it started goes with it.
    ::kill(-pid_, SIGKILL);
    ended_ = true;
    if (WIFSIGNALED(status)) end_.signal = WTERMSIG(status);
    if (WIFEXITED(status)) end_.exit_status = WEXITSTATUS(status);
    while (receive_from(errors_, true)) {
    }
    if (end_.errors.size() > kErrorsKept) end_.errors.erase(0, end_.errors.size() - kErrorsKept);
    return true;
}

}  // namespace ricci::app
