// Files that survive a crash: writes that are checked to the end, fsync of files and folders, checksums, a
// lock on a folder. Between their steps lie fault points (io/store/fault_point.h).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/mesh/mesh_file.h"
#include "io/store/fault_point.h"

namespace ricci {

/// FileError "<path>: <what>: <text of error number>".
FileError system_error(const std::string& path, const std::string& what, int error_number);

/// An owned POSIX file descriptor; -1: none. Closing errors are ignored: fsync before, where they matter.
class FileDescriptor {
  public:
    FileDescriptor() = default;
    explicit FileDescriptor(int fd) : fd_(fd) {}
    FileDescriptor(FileDescriptor&& other) noexcept;
    FileDescriptor& operator=(FileDescriptor&& other) noexcept;
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;
    ~FileDescriptor() { reset(); }

    [[nodiscard]] int get() const { return fd_; }
    void reset();

  private:
    int fd_ = -1;
};

/// open(2) with O_CLOEXEC, mode 0666. Throws FileError.
FileDescriptor open_file(const std::string& path, int flags);

/// Writes all bytes, however many calls that takes. Throws FileError.
void write_all(int fd, std::string_view bytes, const std::string& path);

/// fsync of an open file. Throws FileError.
void sync_file(int fd, const std::string& path);

/// fsync of a file, or of a folder (makes renames within it durable). Throws FileError.
void sync_path(const std::string& path);

/// rename(2), then fsync of the target's folder. Throws FileError.
void rename_durably(const std::string& from, const std::string& to);

/// Writes a text file whole: temporary name beside it, fsync, rename, fsync of the folder. Throws FileError.
void write_text_durably(const std::string& path, std::string_view text);

/// The file's bytes. Throws FileError.
std::string read_text(const std::string& path);

/// XXH3-64 of bytes, and of a file's bytes. The latter throws FileError.
std::uint64_t checksum_of(std::span<const std::byte> bytes);
std::uint64_t checksum_of(std::string_view text);
std::uint64_t checksum_of_file(const std::string& path);

/// 16 lower-case hexadecimal digits.
std::string hex16(std::uint64_t value);

/// Folder that holds `path` ("." when it names none).
std::string folder_of(const std::string& path);

/// An exclusive flock(2) on a folder, which is created when it is missing; released with the object, or by
/// death. Throws FileError when another process holds it.
class FolderLock {
  public:
    explicit FolderLock(const std::string& folder);

  private:
    FileDescriptor folder_;
};

}  // namespace ricci
