#include "io/mesh/formats/file_bytes.h"

#include <zlib.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>

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

struct EndInflate {
    void operator()(z_stream* stream) const { inflateEnd(stream); }
};

constexpr std::size_t kMaxUnpacked = std::size_t{1} << 34;

/// Unpacks one member of a gzip file to the end of `out`; returns the number of bytes it took from `packed`.
std::size_t unpack_member(std::string_view packed, const std::string& path, std::string& out) {
    constexpr std::size_t kChunk = std::size_t{1} << 20;
    z_stream stream{};
    if (inflateInit2(&stream, 15 + 16) != Z_OK) throw FileError(path + ": zlib cannot start");
    const std::unique_ptr<z_stream, EndInflate> end(&stream);
    std::size_t consumed = 0;
    int state = Z_OK;
    while (state != Z_STREAM_END) {
        if (stream.avail_in == 0 && consumed < packed.size()) {
            const std::size_t take = std::min(packed.size() - consumed, kChunk);
            stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + consumed));
            stream.avail_in = static_cast<uInt>(take);
            consumed += take;
        }
        const std::size_t filled = out.size();
        if (filled > kMaxUnpacked) throw FileError(path + ": unpacks to more than 16 GiB");
        out.resize(filled + kChunk);
        stream.next_out = reinterpret_cast<Bytef*>(out.data() + filled);
        stream.avail_out = static_cast<uInt>(kChunk);
        state = inflate(&stream, Z_NO_FLUSH);
        out.resize(filled + kChunk - stream.avail_out);
        if (state == Z_BUF_ERROR) throw FileError(path + ": the gzip data are cut off");
        if (state != Z_OK && state != Z_STREAM_END) {
            throw FileError(path + ": the gzip data are damaged (" +
                            (stream.msg ? stream.msg : "no reason given") + ")");
        }
    }
    return consumed - stream.avail_in;
}

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
    std::size_t chunk = error ? kChunk : static_cast<std::size_t>(size) + 1;
    std::size_t filled = 0;
    while (true) {
        bytes.resize(filled + chunk);
        const std::size_t got = std::fread(bytes.data() + filled, 1, chunk, file.get());
        filled += got;
        if (got < chunk) break;
        chunk = kChunk;
    }
    if (std::ferror(file.get()) != 0) throw FileError(path + ": cannot be read: " + last_error());
    bytes.resize(filled);
    return bytes;
}

std::string unpack_gzip(std::string_view packed, const std::string& path) {
    if (packed.substr(0, 2) != "\x1f\x8b") throw FileError(path + ": is named .gz but holds no gzip data");
    std::string out;
    while (!packed.empty()) {
        packed.remove_prefix(unpack_member(packed, path, out));
        // Tapes pad with zeros; anything else must be a further member.
        if (packed.find_first_not_of('\0') == std::string_view::npos) break;
        if (packed.substr(0, 2) != "\x1f\x8b") throw FileError(path + ": other data follow the gzip data");
    }
    return out;
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
