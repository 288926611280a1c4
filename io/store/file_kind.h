// What a file of ours holds.
#pragma once

#include <string>

namespace ricci {

/// "index", "distances", "paths" (root attribute `kind`), or "" for results of items. The file is opened with
/// the care that files of others need (io/store/foreign_file.h). Throws FileError.
std::string kind_of_file(const std::string& path);

}  // namespace ricci
