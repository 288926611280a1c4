// What all commands share: common options, log and progress on stderr, data on stdout, signals.
#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/sweep/scheduler.h"

namespace ricci::app {

/// Options that every subcommand has.
struct CommonOptions {
    bool json = false, quiet = false, verbose = false;
    int threads = 0;           // 0: all this process may use
    std::string max_unpacked;  // of .gz; empty: the default

    [[nodiscard]] int resolved_threads() const;
};

/// A mistake in arguments or configuration: exit status 2.
class UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Sets the log (stderr, coloured on a terminal unless NO_COLOR) to the level asked for.
void set_up_log(const CommonOptions& options);

/// One JSON object per line on stdout; numbers that are not finite become null.
void print_json(const nlohmann::json& object);
nlohmann::json finite_or_null(double value);

/// Makes SIGINT and SIGTERM set a flag (a second one, more than a second later, ends the process at once).
void catch_signals();
/// The signal caught, or 0.
int caught_signal();
/// Whether one was: what ends the program's long jobs.
bool stopped_by_signal();

/// One line of progress with rate and ETA: rewritten in place on a terminal, logged now and then elsewhere.
/// Whoever has no terminal overrides show().
class ProgressLine {
  public:
    explicit ProgressLine(bool quiet);
    virtual ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;
    /// Called from worker threads, one call at a time.
    virtual void show(const SchedulerProgress& progress);
    void clear();

  private:
    bool terminal_, quiet_, drawn_ = false;
    std::chrono::steady_clock::time_point last_;
};

/// Files, folders (searched for mesh files, sorted) and globs, in the order given. Throws UsageError for a
/// glob without a match; a file that does not exist stays in the list and fails when it is read.
std::vector<std::string> expand_inputs(const std::vector<std::string>& arguments);

/// "-4pi", "pi/2", "0.5*pi", "-6.28". Throws UsageError.
double parse_curvature(const std::string& text);
/// "500M", "8G", "1000000". Throws UsageError.
std::int64_t parse_bytes(const std::string& text);

}  // namespace ricci::app
