#include "io/store/durable.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

namespace ricci {

FileError system_error(const std::string& path, const std::string& what, int error_number) {
    return FileError(fmt::format("{}: {}: {}", path, what, std::generic_category().message(error_number)));
}

FileDescriptor::FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

FileDescriptor& FileDescriptor::operator=(FileDescriptor&& other) noexcept {
    if (this != &other) {
        reset();
        fd_ = std::exchange(other.fd_, -1);
    }
    return *this;
}

void FileDescriptor::reset() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
}

FileDescriptor open_file(const std::string& path, int flags) {
    int opened = -1;
    do opened = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
    while (opened < 0 && errno == EINTR);  // network file systems
    FileDescriptor file(opened);
    if (file.get() < 0) throw system_error(path, "cannot open", errno);
    return file;
}

void write_all(int fd, std::string_view bytes, const std::string& path) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(fd, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw system_error(path, "cannot write", errno);
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
}

void sync_file(int fd, const std::string& path) {
    while (::fsync(fd) != 0)
        if (errno != EINTR) throw system_error(path, "cannot fsync", errno);
}

void sync_path(const std::string& path) {
    const FileDescriptor file = open_file(path, O_RDONLY);
    sync_file(file.get(), path);
}

void rename_durably(const std::string& from, const std::string& to) {
    if (std::rename(from.c_str(), to.c_str()) != 0) throw system_error(to, "cannot rename into place", errno);
    sync_path(folder_of(to));
}

void write_text_durably(const std::string& path, std::string_view text) {
    const std::string temporary = path + ".tmp";
    try {
        const FileDescriptor file = open_file(temporary, O_WRONLY | O_CREAT | O_TRUNC);
        write_all(file.get(), text, temporary);
        sync_file(file.get(), temporary);
        rename_durably(temporary, path);
    } catch (const FileError&) {
        ::unlink(temporary.c_str());
        throw;
    }
}

namespace {

// Feeds the file's bytes to `take` in pieces.
template <class Take>
void read_pieces(const std::string& path, Take take) {
    const FileDescriptor file = open_file(path, O_RDONLY);
    std::vector<char> buffer(std::size_t{1} << 18U);
    for (;;) {
        const ssize_t got = ::read(file.get(), buffer.data(), buffer.size());
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw system_error(path, "cannot read", errno);
        if (got == 0) return;
        take(std::string_view(buffer.data(), static_cast<std::size_t>(got)));
    }
}

}  // namespace

std::string read_text(const std::string& path) {
    std::string text;
    read_pieces(path, [&](std::string_view piece) { text += piece; });
    return text;
}

std::uint64_t checksum_of(std::span<const std::byte> bytes) {
    return XXH3_64bits(bytes.data(), bytes.size());
}

std::uint64_t checksum_of(std::string_view text) {
    return XXH3_64bits(text.data(), text.size());
}

std::uint64_t checksum_of_file(const std::string& path) {
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
    XXH3_64bits_reset(state.get());
    read_pieces(path,
                [&](std::string_view piece) { XXH3_64bits_update(state.get(), piece.data(), piece.size()); });
    return XXH3_64bits_digest(state.get());
}

std::string hex16(std::uint64_t value) {
    return fmt::format("{:016x}", value);
}

std::string folder_of(const std::string& path) {
    const std::string folder = std::filesystem::path(path).parent_path().string();
    return folder.empty() ? "." : folder;
}

FolderLock::FolderLock(const std::string& folder) {
    for (;;) {
        if (::mkdir(folder.c_str(), 0777) != 0 && errno != EEXIST)
            throw system_error(folder, "cannot create the folder", errno);
        folder_ = open_file(folder, O_RDONLY | O_DIRECTORY);
        if (::flock(folder_.get(), LOCK_EX | LOCK_NB) != 0) {
            if (errno == EWOULDBLOCK) throw FileError(folder + ": another run is writing this output");
            throw system_error(folder, "cannot lock", errno);
        }
        // The holder before us may have removed the folder between our open and our lock: then we locked a
        // ghost.
        struct stat locked {};
        struct stat named {};
        if (::fstat(folder_.get(), &locked) == 0 && ::stat(folder.c_str(), &named) == 0 &&
            locked.st_ino == named.st_ino && locked.st_dev == named.st_dev)
            return;
    }
}

}  // namespace ricci
