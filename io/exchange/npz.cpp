#include "io/exchange/npz.h"

#include <fmt/format.h>
#include <zlib.h>

#include <limits>
#include <stdexcept>
#include <string_view>

#include "io/exchange/staged_file.h"
#include "io/store/stored_text.h"

namespace ricci {
namespace {

// numpy's format 1.0: magic, version, length of the header, a Python literal, padding to 64 bytes.
std::string npy_header(const char* type, const NpzFile::Shape& shape) {
    std::string sizes;
    for (const std::size_t n : shape) sizes += fmt::format("{}, ", n);
    std::string header =
        fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, sizes);
    constexpr std::size_t kPrefix = 10, kAlignment = 64;
    while ((kPrefix + header.size() + 1) % kAlignment != 0) header += ' ';
    header += '\n';
    std::string bytes("\x93NUMPY\x01\x00", 8);
    bytes += static_cast<char>(header.size() & 0xFFU);
    bytes += static_cast<char>(header.size() >> 8U);
    return bytes + header;
}

struct Entry {
    std::string name;
    std::uint32_t crc = 0, size = 0, offset = 0;
};

std::uint32_t fitting(std::uint64_t number, const std::string& path) {
    if (number > std::numeric_limits<std::uint32_t>::max())
        throw FileError(path + ": more than 4 GiB of arrays do not fit into an .npz file");
    return static_cast<std::uint32_t>(number);
}

std::uint32_t checksum(std::uint32_t crc, std::string_view bytes) {
    if (bytes.empty()) return crc;  // zlib takes a null pointer as the wish to start anew
    return static_cast<std::uint32_t>(
        crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

// What the local header and the directory have in common (PKWARE's APPNOTE, 4.3.7 and 4.3.12): version 2.0,
// names in UTF-8, stored, 1 January 1980.
void write_common(StagedFile& file, const Entry& entry) {
    for (const int field : {20, 1 << 11, 0, 0, (1 << 5) | 1})
        file.write_value(static_cast<std::uint16_t>(field));
    for (const std::uint32_t field : {entry.crc, entry.size, entry.size}) file.write_value(field);
    file.write_value(static_cast<std::uint16_t>(entry.name.size()));
    file.write_value(std::uint16_t{0});  // no extra field
}

}  // namespace

struct NpzFile::Impl {
    std::string path;
    StagedFile file;
    std::vector<Entry> entries;

    explicit Impl(const std::string& file_path) : path(file_path), file(file_path) {}

    template <class T>
    void add(const std::string& name, const char* type, std::span<const T> values, const Shape& shape) {
        std::size_t count = 1;
        for (const std::size_t n : shape) count *= n;
        if (count != values.size()) throw std::invalid_argument(name + " has not the shape it should have");
        const std::string header = npy_header(type, shape);
        const std::string_view bytes(reinterpret_cast<const char*>(values.data()), values.size_bytes());
        Entry entry{hdf5::stored_text(name) + ".npy", checksum(checksum(0, header), bytes),
                    fitting(header.size() + bytes.size(), path), fitting(file.position(), path)};
        file.write_value(std::uint32_t{0x04034b50});
        write_common(file, entry);
        file.write(entry.name);
        file.write(header);
        file.write(bytes);
        entries.push_back(std::move(entry));
    }
};

NpzFile::NpzFile(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
NpzFile::~NpzFile() = default;

void NpzFile::add(const std::string& name, std::span<const double> values, const Shape& shape) {
    impl_->add(name, "<f8", values, shape);
}
void NpzFile::add(const std::string& name, std::span<const std::int32_t> values, const Shape& shape) {
    impl_->add(name, "<i4", values, shape);
}
void NpzFile::add(const std::string& name, std::span<const std::uint8_t> values, const Shape& shape) {
    impl_->add(name, "|u1", values, shape);
}

void NpzFile::close() {
    StagedFile& file = impl_->file;
    const std::uint32_t start = fitting(file.position(), impl_->path);
    if (impl_->entries.size() > std::numeric_limits<std::uint16_t>::max())
        throw FileError(impl_->path + ": too many arrays for an .npz file");
    for (const Entry& entry : impl_->entries) {
        file.write_value(std::uint32_t{0x02014b50});
        file.write_value(std::uint16_t{20});
        write_common(file, entry);
        for (int k = 0; k < 3; ++k) file.write_value(std::uint16_t{0});  // comment, disk, attributes
        file.write_value(std::uint32_t{0});
        file.write_value(entry.offset);
        file.write(entry.name);
    }
    const std::uint32_t size = fitting(file.position() - start, impl_->path);
    const auto count = static_cast<std::uint16_t>(impl_->entries.size());
    file.write_value(std::uint32_t{0x06054b50});
    for (const std::uint16_t field : {std::uint16_t{0}, std::uint16_t{0}, count, count})
        file.write_value(field);
    file.write_value(size);
    file.write_value(start);
    file.write_value(std::uint16_t{0});  // no comment
    file.close();
}

}  // namespace ricci
