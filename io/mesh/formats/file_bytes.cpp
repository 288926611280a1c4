#include "io/mesh/formats/file_bytes.h"

#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>
#include <vector>

#include "io/mesh/mesh_file.h"

namespace ricci {
namespace {

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

std::string last_error() {
    return std::generic_category().message(errno);
}

[[noreturn]] void throw_too_large(const std::string& path) {
    throw FileError(path + ": is larger than 64 GiB, beyond any mesh of 32-bit indices");
}

struct EndInflate {
    void operator()(z_stream* stream) const { inflateEnd(stream); }
};

constexpr std::size_t kFreeUnpacked = std::size_t{1} << 26, kMaxRatio = 200;
std::atomic<std::uint64_t> max_unpacked = 0;

/// Unpacks gzip members one after the other; one state for all of them, which may be millions of empty ones.
/// Twice: the first time the bytes are only counted, so that a bomb fills no memory and the rest takes no
/// more than it needs.
class Unpacker {
  public:
    Unpacker(std::string_view packed, const std::string& path)
        : packed_(packed), path_(path), limit_(unpack_limit(packed.size())) {
        if (inflateInit2(&stream_, 15 + 16) != Z_OK) throw FileError(path + ": zlib cannot start");
        end_.reset(&stream_);
    }

    std::string run() {
        members();
        out_.resize(count_);
        count_ = 0;
        members();
        return std::move(out_);
    }

  private:
    void members() {
        rest_ = packed_;
        while (!rest_.empty()) {
            member();
            // Tapes pad with zeros; anything else must be a further member.
            if (rest_.find_first_not_of('\0') == std::string_view::npos) return;
            if (rest_.substr(0, 2) != "\x1f\x8b")
                throw FileError(path_ + ": other data follow the gzip data");
        }
    }

    /// Takes one member from the front of what is left.
    void member() {
        inflateReset(&stream_);
        stream_.avail_in = 0;
        int state = Z_OK;
        while (state != Z_STREAM_END) {
            if (stream_.avail_in == 0) {
                const std::size_t take = std::min(rest_.size(), kPiece);
                stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(rest_.data()));
                stream_.avail_in = static_cast<uInt>(take);
                rest_.remove_prefix(take);
            }
            stream_.next_out = reinterpret_cast<Bytef*>(buffer_.data());
            stream_.avail_out = static_cast<uInt>(buffer_.size());
            state = inflate(&stream_, Z_NO_FLUSH);
            append(buffer_.size() - stream_.avail_out);
            if (state == Z_BUF_ERROR) throw FileError(path_ + ": the gzip data are cut off");
            if (state != Z_OK && state != Z_STREAM_END) {
                throw FileError(path_ + ": the gzip data are damaged (" +
                                (stream_.msg ? stream_.msg : "no reason given") + ")");
            }
        }
        rest_ = {rest_.data() - stream_.avail_in, rest_.size() + stream_.avail_in};
    }

    /// Of the buffer.
    void append(std::size_t count) {
        if (count > limit_ - count_) {
            throw FileError(
                path_ + ": unpacks to more than " + std::to_string(limit_) +
                " bytes, the limit for a file of this size; --max-unpacked raises it (at most 16G)");
        }
        std::copy_n(buffer_.data(), out_.empty() ? 0 : count, out_.data() + (out_.empty() ? 0 : count_));
        count_ += count;
    }

    static constexpr std::size_t kPiece = std::size_t{1} << 20;
    std::string_view packed_, rest_;
    const std::string& path_;
    std::size_t limit_, count_ = 0;  // bytes unpacked so far
    z_stream stream_{};
    std::unique_ptr<z_stream, EndInflate> end_;
    std::vector<char> buffer_ = std::vector<char>(std::size_t{1} << 16);
    std::string out_;
};

}  // namespace

std::string read_file_bytes(const std::string& path) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) throw FileError(path + ": is a folder, not a file");
    errno = 0;
    const File file(std::fopen(path.c_str(), "rb"));
    if (!file) throw FileError(path + ": cannot be opened: " + last_error());
    std::string bytes;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    constexpr std::size_t kChunk = std::size_t{1} << 16;
    // One byte beyond the known size, so that a regular file ends in the first round; pipes grow as they
    // come.
    std::size_t chunk =
        error ? kChunk : static_cast<std::size_t>(std::min<std::uintmax_t>(size, kMaxFileBytes)) + 1;
    std::size_t filled = 0;
    if (!error && size > kMaxFileBytes) throw_too_large(path);
    while (true) {
        if (filled > kMaxFileBytes) throw_too_large(path);
        bytes.resize(filled + chunk);
        const std::size_t got = std::fread(bytes.data() + filled, 1, chunk, file.get());
        filled += got;
        if (got < chunk) break;
        chunk = std::max(kChunk, filled / 2);
    }
    if (std::ferror(file.get()) != 0) throw FileError(path + ": cannot be read: " + last_error());
    bytes.resize(filled);
    return bytes;
}

std::size_t unpack_limit(std::size_t packed) {
    const std::uint64_t chosen = max_unpacked.load();
    if (chosen > 0) return std::min<std::size_t>(chosen, kMaxUnpackedBytes);
    return std::clamp(kMaxRatio * packed, kFreeUnpacked, kMaxUnpackedBytes);
}

std::uint64_t max_unpacked_set() {
    return max_unpacked;
}

void set_max_unpacked(std::uint64_t bytes) {
    max_unpacked = bytes;
}

std::string unpack_gzip(std::string_view packed, const std::string& path) {
    if (packed.substr(0, 2) != "\x1f\x8b") throw FileError(path + ": is named .gz but holds no gzip data");
    return Unpacker(packed, path).run();
}

void write_file_bytes(const std::string& path, std::string_view bytes) {
    errno = 0;
    File file(std::fopen(path.c_str(), "wb"));
    if (!file) throw FileError(path + ": cannot be written: " + last_error());
    const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
    const bool closed = std::fclose(file.release()) == 0;
    if (written && closed) return;
    const std::string reason = last_error();
    std::error_code ignored;  // the write error is the one to tell
    if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
    throw FileError(path + ": cannot be written: " + reason);
}

}  // namespace ricci
