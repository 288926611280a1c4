// Small sweeps in child processes, for tests of what happens to them.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <future>
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

/// A run under way whose processes carry a mark.
class MarkedRun {
  public:
    MarkedRun(const TemporaryFolder& folder, Words words)
        : mark_(folder / "mark"), environment_("RICCI_TEST_MARK", mark_) {
        result_ = std::async(std::launch::async,
                             [&folder, words = std::move(words)] { return run_ricci(folder, words); });
    }

    /// Waits until it has so many processes; false when it has ended before.
    bool has_processes(std::size_t count) {
        while (processes_with(mark_).size() < count)
            if (result_.wait_for(std::chrono::milliseconds(2)) == std::future_status::ready) return false;
        return true;
    }
    /// To all its processes, the parent first or last.
    void signal_all(int number, bool parent_first) const {
        std::vector<pid_t> processes = processes_with(mark_);
        std::sort(processes.begin(), processes.end());
        if (!parent_first) std::reverse(processes.begin(), processes.end());
        for (const pid_t process : processes) ::kill(process, number);
    }
    /// To its first process alone.
    void signal_parent(int number) const {
        const std::vector<pid_t> processes = processes_with(mark_);
        if (!processes.empty()) ::kill(*std::min_element(processes.begin(), processes.end()), number);
    }
    /// To the process that began last.
    void signal_youngest(int number) const {
        const std::vector<pid_t> processes = processes_with(mark_);
        if (!processes.empty()) ::kill(*std::max_element(processes.begin(), processes.end()), number);
    }
    ProgramResult result() { return result_.get(); }
    [[nodiscard]] bool all_gone() const { return testing::all_gone(mark_); }

  private:
    std::string mark_;
    Environment environment_;
    std::future<ProgramResult> result_;
};

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
