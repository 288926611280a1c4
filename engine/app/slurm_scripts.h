// The scripts of a sweep on a Slurm cluster: an array job of one task per shard, and the job that joins them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ricci::app {

/// What the scripts are made for.
struct SlurmJob {
    std::string program, folder, output;  // absolute paths: ricci, the job's folder, the whole run's result
    std::string directory;                // where the job was submitted: relative paths start there
    std::string name;                     // of the jobs
    int shards = 1, cpus = 1;
    int at_once = 0;                   // tasks at a time; 0: any number
    int grace = 120;                   // seconds before the time limit
    std::string time, memory;          // as sbatch takes them; empty: the cluster's defaults
    std::vector<std::string> options;  // further options of sbatch, like "--partition=long"
    std::vector<std::pair<std::string, std::string>>
        environment;  // of the tasks, beyond what sbatch hands on
};

/// Seconds of a time limit as sbatch takes it: minutes, minutes:seconds, hours:minutes:seconds, days-hours,
/// days-hours:minutes, days-hours:minutes:seconds; rounded up to minutes, as Slurm does. Nothing for none: 0,
/// infinite, unlimited. Throws UsageError.
std::optional<std::int64_t> seconds_of_time_limit(const std::string& text);

/// One task of the array: runs its shard, goes on where an earlier start of it was stopped, and starts again
/// where the time limit is near.
std::string array_script(const SlurmJob& job);

/// Joins the shards.
std::string merge_script(const SlurmJob& job);

/// Submits both; a plain script, so that it can be run again, with --retry-failed too. Prints "array job ID"
/// and "merge job ID".
std::string submit_script(const SlurmJob& job);

/// A word for the shell.
std::string shell_quoted(const std::string& text);

}  // namespace ricci::app
