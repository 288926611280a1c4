// Small sweeps in child processes, for tests of what happens to them.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "io/store/run_store.h"
#include "tests/support/digests.h"
#include "tests/support/program.h"

namespace ricci::testing {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// A variable of the environment for as long as the object lives.
class Environment {
  public:
    Environment(const char* name, const std::string& value) : name_(name) {
        ::setenv(name, value.c_str(), 1);
    }
    ~Environment() { ::unsetenv(name_); }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;

  private:
    const char* name_;
};

inline Environment fault(const std::string& text) {
    return {"RICCI_FAULT", text};
}

/// Processes that carry a mark in their environment, this one left out.
inline std::vector<pid_t> processes_with(const std::string& mark) {
    std::vector<pid_t> found;
    for (const auto& entry : fs::directory_iterator("/proc")) {
        const std::string name = entry.path().filename();
        const pid_t pid = std::atoi(name.c_str());
        if (pid <= 0 || pid == ::getpid()) continue;
        if (read_text(entry.path() / "environ").find(mark) != std::string::npos) found.push_back(pid);
    }
    return found;
}

/// Dying takes a moment; living does not end.
inline bool all_gone(const std::string& mark) {
    for (int k = 0; k < 600; ++k) {
        if (processes_with(mark).empty()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
}

/// Some surfaces of genus 2 under names of their own, and how they are swept.
class Isolation : public ::testing::Test {
  protected:
    void SetUp() override {
        const std::string eight = make(folder, "eight", 400);
        ASSERT_FALSE(eight.empty());
        for (const char* name : {"a", "b", "c", "d", "e", "f", "g", "h"})
            fs::copy_file(eight, folder / (std::string(name) + ".off"));
        const ProgramResult info = run_ricci(folder, {"info", eight, "--json"});
        suffix = "@" + std::to_string(objects(info.out).at(0)["faces"].get<int>());
    }

    Words sweep(const std::string& names, const std::string& output, const Words& more = {},
                const char* threads = "2") const {
        Words words{"sweep"};
        for (const char name : names) words.push_back(folder / (std::string(1, name) + ".off"));
        words.insert(words.end(), {"--threads", threads, "-o", folder / output});
        if (std::find(more.begin(), more.end(), "--vertices") == more.end())
            words.insert(words.end(), {"--vertices", "sample:24"});
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }

    ProgramResult run(const Words& words) const { return run_ricci(folder, words); }

    /// The failures of a file by item.
    std::map<std::string, FailureRecord> failures(const std::string& output) const {
        std::map<std::string, FailureRecord> found;
        for (const FailureRecord& f : read_run(folder / output).failures) found[f.item] = f;
        return found;
    }

    /// Datasets of the items with these stems.
    std::map<std::string, std::uint64_t> digests_of(const std::string& output,
                                                    const std::string& names) const {
        std::map<std::string, std::uint64_t> some;
        for (const auto& [path, digest] : digests(folder / output))
            for (const char name : names)
                if (path.starts_with(std::string("/items/") + name + "@")) some[path] = digest;
        return some;
    }

    /// Runs a bundle's own command, in at most so many milliseconds.
    ProgramResult reproduce(const std::string& output, const std::string& item, int kill_after = -1) const {
        const std::string script = folder / (output + ".failures/" + item + "/reproduce.sh");
        const ProgramResult r = run_program(folder, {"/bin/sh", script}, kill_after);
        return r;
    }

    TemporaryFolder folder;
    std::string suffix;
};

}  // namespace ricci::testing
