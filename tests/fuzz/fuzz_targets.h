// One target per family of readers: bytes in, and everything that must hold of a reader checked.
//
// A target returns when the bytes were taken in or refused as they should be (FileError, a report,
// UsageError). Anything else leaves it as an exception, or as what a sanitizer says.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace ricci::fuzz {

using Bytes = std::span<const std::uint8_t>;

struct Target {
    std::string_view name;  // its corpus lies in tests/fuzz/corpus/<name>
    void (*run)(Bytes bytes);
};
/// All of them.
std::span<const Target> targets();

/// Something that must not happen, happened.
class Finding : public std::logic_error {
  public:
    using std::logic_error::logic_error;
};
inline void require(bool holds, const std::string& what) {
    if (!holds) throw Finding(what);
}

/// What a mesh reader may take for a file of so many bytes (unpacked): docs/reliability/hostile_input.md.
inline constexpr std::size_t kMemoryMultiple = 96, kMemoryFloor = std::size_t{1} << 20;
inline std::size_t memory_allowed(std::size_t file_bytes) {
    return kMemoryFloor + kMemoryMultiple * file_bytes;
}

inline std::string text_of(Bytes bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// By family.
void read_obj(Bytes bytes);
void read_off(Bytes bytes);
void read_ply(Bytes bytes);
void read_stl(Bytes bytes);
void read_len(Bytes bytes);
void read_gzip(Bytes bytes);
void read_configuration(Bytes bytes);
void read_lists(Bytes bytes);
void read_journal_file(Bytes bytes);
void read_hdf5_bytes(Bytes bytes);
void read_hdf5_contents(Bytes bytes);

/// The result files that read_hdf5_contents() changes, made when first asked for, by the commands that make
/// them: a sweep, a layout, an index of shapes.
const std::vector<std::string>& sample_result_files();

}  // namespace ricci::fuzz
