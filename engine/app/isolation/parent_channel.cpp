#include "engine/app/isolation/parent_channel.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "engine/app/isolation/child_pool.h"

namespace ricci::app {
namespace {

constexpr auto kPulse = std::chrono::milliseconds(500);

[[noreturn]] void orphaned() {
    ::_exit(1);
}

}  // namespace

ParentChannel::ParentChannel() : socket_(::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3)) {
    if (socket_.get() < 0) orphaned();
    const FileDescriptor nothing = open_file("/dev/null", O_RDONLY);
    ::dup2(nothing.get(), STDIN_FILENO);
}

void ParentChannel::receive(bool wait) {
    std::array<char, 65536> buffer{};
    for (;;) {
        const ssize_t got = ::recv(socket_.get(), buffer.data(), buffer.size(), wait ? 0 : MSG_DONTWAIT);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
        if (got <= 0) orphaned();
        assembler_.add(std::string_view(buffer.data(), static_cast<std::size_t>(got)));
        break;
    }
    while (auto frame = assembler_.next()) take(*frame);
}

void ParentChannel::take(const Frame& frame) {
    if (frame.kind == static_cast<std::uint32_t>(PoolMessage::threads))
        threads_ = MessageReader(frame.bytes).get<int>();
    else
        arrived_.push_back(frame);
}

std::string ParentChannel::wait_for(std::uint32_t kind) {
    for (;;) {
        const auto found = std::find_if(arrived_.begin(), arrived_.end(),
                                        [&](const Frame& frame) { return frame.kind == kind; });
        if (found != arrived_.end()) {
            std::string bytes = std::move(found->bytes);
            arrived_.erase(found);
            return bytes;
        }
        receive(true);
    }
}

std::string ParentChannel::job() {
    const std::lock_guard lock(mutex_);
    return wait_for(static_cast<std::uint32_t>(PoolMessage::job));
}

void ParentChannel::send(std::uint32_t kind, std::string_view bytes) {
    const std::string frame = framed(kind, bytes);
    const std::lock_guard lock(mutex_);
    for (std::string_view left = frame; !left.empty();) {
        const ssize_t sent = ::send(socket_.get(), left.data(), left.size(), MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent < 0) orphaned();
        left.remove_prefix(static_cast<std::size_t>(sent));
    }
}

std::string ParentChannel::ask(std::uint32_t kind, std::string_view bytes) {
    send(kind, bytes);
    const std::lock_guard lock(mutex_);
    return wait_for(static_cast<std::uint32_t>(PoolMessage::reply));
}

void ParentChannel::pulse() {
    {
        const std::unique_lock lock(mutex_, std::try_to_lock);
        const auto now = std::chrono::steady_clock::now();
        if (!lock.owns_lock() || now - last_pulse_ < kPulse) return;
        last_pulse_ = now;
        receive(false);
    }
    send(static_cast<std::uint32_t>(PoolMessage::alive), {});
}

int ParentChannel::threads() const {
    const std::lock_guard lock(mutex_);
    return threads_;
}

void ParentChannel::set_threads(int threads) {
    const std::lock_guard lock(mutex_);
    threads_ = threads;
}

}  // namespace ricci::app
