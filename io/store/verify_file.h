// The structural check of one result file.
#pragma once

#include <string>
#include <vector>

namespace ricci {

/// Complaints about the result file alone, found in a child process; empty when sound. Throws FileError when
/// no child can be had.
std::vector<std::string> verify_result_file(const std::string& path);

}  // namespace ricci
