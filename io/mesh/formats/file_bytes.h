// Whole files in memory.
#pragma once

#include <string>
#include <string_view>

namespace ricci {

/// Larger files are refused, and so are pipes and devices that give more: a mesh of 32-bit indices is
/// smaller.
inline constexpr std::size_t kMaxFileBytes = std::size_t{1} << 36;
inline constexpr std::size_t kMaxUnpackedBytes = std::size_t{1} << 34;

/// The bytes of a file. Throws FileError (missing, a folder, no permission, read error, too large), naming
/// the reason.
std::string read_file_bytes(const std::string& path);

/// What so many bytes of gzip data may unpack to (see set_max_unpacked in io/mesh/mesh_file.h).
std::size_t unpack_limit(std::size_t packed);

/// Unpacks gzip data (all members). Throws FileError naming `path` when it is damaged, cut off, or unpacks to
/// more than unpack_limit() of its size.
std::string unpack_gzip(std::string_view packed, const std::string& path);

/// Writes a file. Throws FileError naming the reason; what was written of it so far is removed.
void write_file_bytes(const std::string& path, std::string_view bytes);

}  // namespace ricci
