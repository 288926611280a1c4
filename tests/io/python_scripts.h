// Other readers of what the store writes: scripts of Debian's Python.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/io/store_samples.h"

namespace ricci::store_samples {

inline constexpr const char* kPython = "/usr/bin/python3";

/// Runs a script with arguments; its output, with the exit status in front when that is not 0.
inline std::string run_python(const TemporaryFolder& folder, const std::string& script,
                              const std::string& arguments) {
    const std::string path = folder.file("script.py");
    std::ofstream(path) << script;
    const std::string command = fmt::format("{} {} {} 2>&1", kPython, path, arguments);
    std::FILE* pipe = ::popen(command.c_str(), "r");
    std::string output;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) output += static_cast<char>(c);
    const int status = ::pclose(pipe);
    return status == 0 ? output : fmt::format("status {}: {}", status, output);
}

inline bool has_module(const std::string& module) {
    const std::string command = fmt::format("{} -c 'import {}' 2>/dev/null", kPython, module);
    return std::system(command.c_str()) == 0;  // NOLINT(concurrency-mt-unsafe): one thread
}

}  // namespace ricci::store_samples
