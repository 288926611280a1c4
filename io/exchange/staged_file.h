// Files that appear whole or not at all, written piece by piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "io/store/durable.h"

namespace ricci {

/// Written under a temporary name beside `path` through a buffer, renamed into place by close(); removed
/// where that never comes.
class StagedFile {
  public:
    /// Throws FileError.
    explicit StagedFile(std::string path);
    ~StagedFile();
    StagedFile(const StagedFile&) = delete;
    StagedFile& operator=(const StagedFile&) = delete;

    /// Throw FileError.
    void write(std::string_view bytes);
    template <class T>
    void write_values(std::span<const T> values) {
        write({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
    }
    template <class T>
    void write_value(T value) {
        write_values(std::span<const T>(&value, 1));
    }
    [[nodiscard]] std::uint64_t position() const { return position_; }
    /// fsync, then rename(2) and fsync of the folder.
    void close();

  private:
    void flush();

    std::string path_, temporary_, buffer_;
    FileDescriptor file_;
    std::uint64_t position_ = 0;
};

}  // namespace ricci
