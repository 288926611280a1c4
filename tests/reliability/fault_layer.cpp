// Loaded before the C library (LD_PRELOAD): makes one call on a file fail, or kills the process there.
//   RICCI_FAULT_ROOT   only files under this folder count
//   RICCI_FAULT_CALL   KIND:N:ACTION  the N-th (1, 2, ...) call of that kind; N+: that one and all later ones
//     KIND    write, sync, rename, open (for writing), truncate, unlink, folder (mkdir), read
//     ACTION  an error number, or `kill`, or `short` (write, read: half of the bytes; the rest as usual)
//   RICCI_FAULT_LOG    a file: one line `KIND PATH` for each call that counts
// Counts go on over all threads. Calls that a library makes inside the C library itself are not seen.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

namespace {

enum class Outcome { usual, fails, halves };

struct Plan {
    std::string root, kind, log;
    long first = 0;
    bool later_ones = false, kill = false, halves = false;
    int error = 0;
};

const Plan& plan() {
    static const Plan read = [] {
        Plan p;
        const auto text = [](const char* name) {
            const char* value = std::getenv(name);
            return std::string(value == nullptr ? "" : value);
        };
        p.root = text("RICCI_FAULT_ROOT");
        p.log = text("RICCI_FAULT_LOG");
        const std::string call = text("RICCI_FAULT_CALL");
        const std::size_t one = call.find(':'), two = call.rfind(':');
        if (one == std::string::npos || one == two) return p;
        p.kind = call.substr(0, one);
        const std::string number = call.substr(one + 1, two - one - 1), action = call.substr(two + 1);
        p.first = std::strtol(number.c_str(), nullptr, 10);
        p.later_ones = number.ends_with('+');
        p.kill = action == "kill";
        p.halves = action == "short";
        p.error = static_cast<int>(std::strtol(action.c_str(), nullptr, 10));
        return p;
    }();
    return read;
}

template <class Function>
Function next(const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

bool counts(std::string_view path) {
    const std::string& root = plan().root;
    return !root.empty() && path.starts_with(root);
}

/// What is to become of a call on `path`; sets errno where it fails.
Outcome decide(const char* kind, const std::string& path) {
    if (!counts(path)) return Outcome::usual;
    const Plan& p = plan();
    if (!p.log.empty()) {
        const std::string line = std::string(kind) + " " + path + "\n";
        const long fd = syscall(SYS_openat, AT_FDCWD, p.log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
        syscall(SYS_write, fd, line.data(), line.size());
        syscall(SYS_close, fd);
    }
    if (p.kind != kind) return Outcome::usual;
    static std::atomic<long> passes = 0;
    const long pass = ++passes;
    if (p.later_ones ? pass < p.first : pass != p.first) return Outcome::usual;
    if (p.kill) syscall(SYS_kill, getpid(), SIGKILL);
    if (p.halves) return Outcome::halves;
    errno = p.error;
    return Outcome::fails;
}

std::string path_of(int fd) {
    std::array<char, PATH_MAX> path{};
    const std::string link = "/proc/self/fd/" + std::to_string(fd);
    const ssize_t size = readlink(link.c_str(), path.data(), path.size());
    return {path.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

std::string absolute(const char* path) {
    if (path[0] == '/') return path;
    std::array<char, PATH_MAX> folder{};
    return getcwd(folder.data(), folder.size()) == nullptr ? path : std::string(folder.data()) + "/" + path;
}

std::size_t half(std::size_t count) {
    return count / 2 > 0 ? count / 2 : count;
}

int open_with(const char* name, const char* path, int flags, mode_t mode) {
    if ((flags & (O_WRONLY | O_RDWR)) != 0 && decide("open", absolute(path)) == Outcome::fails) return -1;
    return next<int (*)(const char*, int, ...)>(name)(path, flags, mode);
}

mode_t mode_of(int flags, va_list list) {
    return (flags & O_CREAT) != 0 ? static_cast<mode_t>(va_arg(list, unsigned)) : 0;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
    va_list list;
    va_start(list, flags);
    const mode_t mode = mode_of(flags, list);
    va_end(list);
    return open_with("open", path, flags, mode);
}

int open64(const char* path, int flags, ...) {
    va_list list;
    va_start(list, flags);
    const mode_t mode = mode_of(flags, list);
    va_end(list);
    return open_with("open64", path, flags, mode);
}

#define RICCI_TRANSFER(name, kind, Buffer)                                 \
    ssize_t name(int fd, Buffer buffer, size_t count) {                    \
        const Outcome outcome = decide(kind, path_of(fd));                 \
        if (outcome == Outcome::fails) return -1;                          \
        return next<ssize_t (*)(int, Buffer, size_t)>(#name)(              \
            fd, buffer, outcome == Outcome::halves ? half(count) : count); \
    }
#define RICCI_TRANSFER_AT(name, kind, Buffer)                                      \
    ssize_t name(int fd, Buffer buffer, size_t count, off_t offset) {              \
        const Outcome outcome = decide(kind, path_of(fd));                         \
        if (outcome == Outcome::fails) return -1;                                  \
        return next<ssize_t (*)(int, Buffer, size_t, off_t)>(#name)(               \
            fd, buffer, outcome == Outcome::halves ? half(count) : count, offset); \
    }
RICCI_TRANSFER(write, "write", const void*)
RICCI_TRANSFER(read, "read", void*)
RICCI_TRANSFER_AT(pwrite, "write", const void*)
RICCI_TRANSFER_AT(pwrite64, "write", const void*)
RICCI_TRANSFER_AT(pread, "read", void*)
RICCI_TRANSFER_AT(pread64, "read", void*)

int fsync(int fd) {
    if (decide("sync", path_of(fd)) == Outcome::fails) return -1;
    return next<int (*)(int)>("fsync")(fd);
}

int fdatasync(int fd) {
    if (decide("sync", path_of(fd)) == Outcome::fails) return -1;
    return next<int (*)(int)>("fdatasync")(fd);
}

int rename(const char* from, const char* to) {
    if (decide("rename", absolute(to)) == Outcome::fails) return -1;
    return next<int (*)(const char*, const char*)>("rename")(from, to);
}

int ftruncate(int fd, off_t size) {
    if (decide("truncate", path_of(fd)) == Outcome::fails) return -1;
    return next<int (*)(int, off_t)>("ftruncate")(fd, size);
}

int ftruncate64(int fd, off64_t size) {
    if (decide("truncate", path_of(fd)) == Outcome::fails) return -1;
    return next<int (*)(int, off64_t)>("ftruncate64")(fd, size);
}

int unlink(const char* path) {
    if (decide("unlink", absolute(path)) == Outcome::fails) return -1;
    return next<int (*)(const char*)>("unlink")(path);
}

int mkdir(const char* path, mode_t mode) {
    if (decide("folder", absolute(path)) == Outcome::fails) return -1;
    return next<int (*)(const char*, mode_t)>("mkdir")(path, mode);
}

}  // extern "C"
