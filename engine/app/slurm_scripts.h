// The scripts of a sweep on a Slurm cluster: an array job of one task per shard, and the job that joins them.
#pragma once

#include <string>
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
};

/// One task of the array: runs its shard, goes on where an earlier start of it was stopped, and starts again
/// where the time limit is near.
std::string array_script(const SlurmJob& job);

/// Joins the shards.
std::string merge_script(const SlurmJob& job);

/// Submits both; a plain script, so that it can be run again. Prints "array job ID" and "merge job ID".
std::string submit_script(const SlurmJob& job);

/// A word for the shell.
std::string shell_quoted(const std::string& text);

}  // namespace ricci::app
