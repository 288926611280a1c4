#include "io/store/guarded_child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <exception>
#include <fstream>

#include "io/store/durable.h"

namespace ricci {
namespace {

#if defined(__has_feature)  // clang says it otherwise than GCC
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define RICCI_SANITIZED 1
#endif
#endif
#if defined(RICCI_SANITIZED) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitMemory = false;  // the sanitizers reserve terabytes of address space
#else
constexpr bool kLimitMemory = true;
#endif

std::uint64_t mapped_bytes() {
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void limit(__rlimit_resource_t resource, std::uint64_t value) {
    rlimit limits{};
    if (::getrlimit(resource, &limits) != 0) return;
    limits.rlim_cur = std::min<rlim_t>(limits.rlim_max, value);
    ::setrlimit(resource, &limits);
}

// Never returns. Complaints go to the pipe, each ended by a zero byte.
[[noreturn]] void be_the_child(int pipe, const ChildLimits& limits, std::uint64_t mapped,
                               const std::function<std::vector<std::string>()>& work) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (const int number : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGXCPU}) std::signal(number, SIG_DFL);
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, limits.seconds);
    if (kLimitMemory && limits.memory_bytes > 0) limit(RLIMIT_AS, mapped + limits.memory_bytes);
    // A dying C library writes to stderr; the parent says it better.
    const int nowhere = ::open("/dev/null", O_WRONLY);
    if (nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
    int status = 0;
    try {
        std::string text;
        for (const std::string& complaint : work()) text += complaint + '\0';
        write_all(pipe, text, "pipe");
    } catch (const std::bad_alloc&) {
        status = 2;
    } catch (...) {
        status = 1;
    }
    ::_exit(status);
}

// Reads until the child closes the pipe or the clock runs out; false then.
bool drain(int pipe, std::uint64_t seconds, std::string& text) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::seconds(2 * seconds + 60);
    std::array<char, 4096> buffer{};
    for (;;) {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
        if (left <= 0) return false;
        pollfd poller{pipe, POLLIN, 0};
        const int ready = ::poll(&poller, 1, static_cast<int>(std::min<std::int64_t>(left, 60000)));
        if (ready <= 0) continue;
        const ssize_t got = ::read(pipe, buffer.data(), buffer.size());
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return true;
        text.append(buffer.data(), static_cast<std::size_t>(got));
    }
}

std::string end_of(int status) {
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) return "reading it takes too long";
    if (WIFSIGNALED(status)) return fmt::format("reading it crashes (signal {})", WTERMSIG(status));
    if (WEXITSTATUS(status) == 2) return "reading it takes too much memory";
    return WEXITSTATUS(status) == 0 ? "" : "reading it fails";
}

}  // namespace

ChildLimits foreign_file_limits(std::uint64_t file_bytes) {
    return {10 + file_bytes / 1000000, (std::uint64_t{2} << 30U) + 16 * file_bytes};
}

std::vector<std::string> run_guarded(const ChildLimits& limits,
                                     const std::function<std::vector<std::string>()>& work) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw system_error("pipe", "cannot create", errno);
    const FileDescriptor read_end(ends[0]);
    FileDescriptor write_end(ends[1]);
    const std::uint64_t mapped = mapped_bytes();
    const pid_t child = ::fork();
    if (child < 0) throw system_error("child process", "cannot fork", errno);
    if (child == 0) be_the_child(write_end.get(), limits, mapped, work);
    write_end.reset();
    std::string text;
    const bool in_time = drain(read_end.get(), limits.seconds, text);
    if (!in_time) ::kill(child, SIGKILL);  // which says nothing of the file: the machine may be busy
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (!in_time) throw GuardUndecided("reading it takes too long by the clock");
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
        throw GuardUndecided("the process that reads it was killed, most likely for want of memory");
    std::vector<std::string> complaints;
    for (std::size_t start = 0; start < text.size();) {
        const std::size_t end = std::min(text.find('\0', start), text.size());
        complaints.push_back(text.substr(start, end - start));
        start = end + 1;
    }
    if (const std::string last = end_of(status); !last.empty()) complaints.push_back(last);
    return complaints;
}

}  // namespace ricci
