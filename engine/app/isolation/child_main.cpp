#include "engine/app/isolation/child_main.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <fstream>
#include <new>
#include <sstream>

#include "engine/app/app.h"
#include "engine/app/console.h"
#include "engine/flow/status.h"
#include "io/mesh/mesh_file.h"

namespace ricci::app {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitMemory = false;  // the sanitizers reserve terabytes of address space
#else
constexpr bool kLimitMemory = true;
#endif

/// How far the limit on what is mapped lies above the limit on what is in use, for the process and for each
/// thread: stack, arena, OpenBLAS's buffer (128 MiB in 0.3), and what grows while the parent looks elsewhere.
constexpr std::int64_t kSlack = std::int64_t{1} << 30, kSlackPerThread = 160 << 20;

/// Private writable memory of this process so far.
std::int64_t data_bytes() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        std::int64_t kilobytes = 0;
        if (line.starts_with("VmData:") && std::istringstream(line.substr(7)) >> kilobytes)
            return kilobytes * 1024;
    }
    return 0;
}

void set_limit(std::int64_t bytes) {
    rlimit limits{};
    ::getrlimit(RLIMIT_DATA, &limits);
    limits.rlim_cur = std::min(limits.rlim_max, static_cast<rlim_t>(bytes));
    ::setrlimit(RLIMIT_DATA, &limits);
}

/// The parent looks at what is in use (ChildProcess::memory) and kills. This limit stands far behind that,
/// for an allocation that is absurd as a whole: RLIMIT_DATA counts private writable memory, mapped or from
/// brk, used or not, but not what allocators merely reserve, as RLIMIT_AS would. Not close behind, because
/// OpenBLAS asks for its buffer again and again, for ever, when it cannot have it.
void limit_memory(const ChildShare& share) {
    // Where memory ends, so does the child, rather than go on by another way that gives other bits.
    std::set_new_handler([] { end_out_of_memory(); });
    // If the kernel has to kill, then one of these processes and not the one that keeps the books.
    std::ofstream("/proc/self/oom_score_adj") << 500;
    if (kLimitMemory && share.memory > 0)
        set_limit(data_bytes() + share.memory + kSlack + kSlackPerThread * share.threads);
}

[[noreturn]] void end_child(ParentChannel& parent, Status status, const std::string& message) {
    parent.send(kExceptionMessage, MessageWriter().put(name_of(status)).put(message).bytes());
    ::_exit(kSomeFailed);
}

int be_child() {
    catch_signals();
    ParentChannel parent;
    const std::string bytes = parent.job();
    try {
        MessageReader job(bytes);
        JobHeader header;
        header.kind = job.get_text();
        header.share.threads = job.get<int>();
        header.share.memory = job.get<std::int64_t>();
        header.share.whole = job.get<bool>();
        set_max_unpacked(job.get<std::uint64_t>());
        parent.set_threads(header.share.threads);
        limit_memory(header.share);
        (header.kind == "sweep" ? sweep_in_child : describe_in_child)(parent, header.share, job);
    } catch (const std::bad_alloc&) {
        end_out_of_memory();
    } catch (const std::exception& e) {
        end_child(parent, Status::internal_error, e.what());
    }
    parent.send(kDoneMessage, {});
    // Nothing is left that a destructor would have to put in order, and much that one could stumble over.
    ::_exit(kDone);
}

}  // namespace

MessageWriter& put_header(MessageWriter& job, const JobHeader& header) {
    return job.put(header.kind)
        .put(header.share.threads)
        .put(header.share.memory)
        .put(header.share.whole)
        .put(max_unpacked_set());
}

void allow_threads(int more) {
    rlimit limits{};
    ::getrlimit(RLIMIT_DATA, &limits);
    if (limits.rlim_cur != RLIM_INFINITY)
        set_limit(static_cast<std::int64_t>(limits.rlim_cur) + kSlackPerThread * more);
}

void end_out_of_memory() {
    ::_exit(kExitOutOfMemory);
}

void add_isolated_child(CLI::App& app, Action& action) {
    auto* command = app.add_subcommand("isolated-child", "Serves a parent that isolates its items");
    command->group("");  // not for users
    command->callback([&action] { action = [] { return be_child(); }; });
}

}  // namespace ricci::app
