// Whole files in memory.
#pragma once

#include <string>
#include <string_view>

namespace ricci {

/// The bytes of a file. Throws FileError (missing, a folder, no permission, read error), naming the reason.
std::string read_file_bytes(const std::string& path);

/// Unpacks gzip data (all members). Throws FileError naming `path` when it is damaged, cut off, or unpacks to
/// more than 16 GiB.
std::string unpack_gzip(std::string_view packed, const std::string& path);

/// Writes a file. Throws FileError naming the reason; what was written of it so far is removed.
void write_file_bytes(const std::string& path, std::string_view bytes);

}  // namespace ricci
