// Runs the built `ricci` as its users do.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace ricci::testing {

/// A folder of its own, removed at the end.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "ricci-test-XXXXXX").string();
        path_ = mkdtemp(pattern.data());
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    [[nodiscard]] std::string operator/(const std::string& name) const { return path_ + "/" + name; }

  private:
    std::string path_;
};

inline std::string read_text(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

inline void write_text(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

struct ProgramResult {
    int status = -1;  // exit status; 128 + signal when killed
    std::string out, err;
};

/// Runs a program; with `kill_after` (milliseconds) sends `signal` then.
inline ProgramResult run_program(const TemporaryFolder& folder, std::vector<std::string> words,
                                 int kill_after = -1, int signal = SIGKILL) {
    const std::string out = folder / "stdout.txt", err = folder / "stderr.txt";
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        const int o = open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        const int e = open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        dup2(o, STDOUT_FILENO);
        dup2(e, STDERR_FILENO);
        execv(argv[0], argv.data());
        _exit(127);
    }
    if (kill_after >= 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(kill_after));
        kill(child, signal);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ProgramResult result;
    result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.out = read_text(out);
    result.err = read_text(err);
    return result;
}

/// Runs ricci with `arguments`.
inline ProgramResult run_ricci(const TemporaryFolder& folder, const std::vector<std::string>& arguments,
                               int kill_after = -1, int signal = SIGKILL) {
    std::vector<std::string> words{RICCI_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return run_program(folder, std::move(words), kill_after, signal);
}

/// Writes a generated surface of about so many faces into the folder; the path, empty where that failed.
inline std::string make(const TemporaryFolder& folder, const std::string& name, int faces) {
    const std::string file = folder / (name + ".off");
    const ProgramResult made =
        run_ricci(folder, {"generate", name, "--faces", std::to_string(faces), "-o", file, "-q"});
    return made.status == 0 ? file : std::string();
}

/// The JSON objects of an output, one per line.
inline std::vector<nlohmann::json> objects(const std::string& text) {
    std::vector<nlohmann::json> result;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) result.push_back(nlohmann::json::parse(line));
    return result;
}

}  // namespace ricci::testing
