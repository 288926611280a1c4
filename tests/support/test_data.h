// Where the tests find sample meshes that are not part of the repository.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace ricci::testing {

/// The folder named by RICCI_DATA, else <source>/../shared/data; empty when that does not exist.
inline std::filesystem::path data_folder() {
    // Tests read the environment from one thread, before anything could change it.
    const char* named = std::getenv("RICCI_DATA");  // NOLINT(concurrency-mt-unsafe)
    const std::filesystem::path folder =
        named != nullptr ? std::filesystem::path(named)
                         : std::filesystem::path(RICCI_SOURCE_DIR) / ".." / "shared" / "data";
    std::error_code error;
    return std::filesystem::is_directory(folder, error) ? folder : std::filesystem::path();
}

/// Path of a sample file, relative to data_folder(); empty when it does not exist.
inline std::string data_file(const std::string& relative) {
    const std::filesystem::path folder = data_folder();
    std::error_code error;
    if (folder.empty() || !std::filesystem::exists(folder / relative, error)) return {};
    return (folder / relative).lexically_normal().string();
}

}  // namespace ricci::testing

/// Skips the running test when the sample file is not on this machine; otherwise `variable` is its path.
#define RICCI_DATA_FILE_OR_SKIP(variable, relative)                                      \
    const std::string variable = ricci::testing::data_file(relative);                    \
    if (variable.empty())                                                                \
    GTEST_SKIP() << "sample file " << (relative) << " not found; set RICCI_DATA to the " \
                 << "folder that holds meshes/ and bad/"
