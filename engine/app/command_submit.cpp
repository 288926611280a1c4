#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/slurm_scripts.h"
#include "engine/app/sweep_arguments.h"
#include "engine/app/sweep_plan.h"
#include "io/store/durable.h"

namespace ricci::app {
namespace {

namespace fs = std::filesystem;

struct SubmitArguments {
    SweepArguments sweep;
    SlurmJob job;
    bool slurm = false, dry_run = false;
};

std::string job_name(const std::string& output) {
    std::string name = "ricci-" + fs::path(output).stem().string();
    for (char& c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_' && c != '.') c = '_';
    return name;
}

/// The sweep as all shards run it: its inputs as they are now, whatever becomes of folders and of the
/// configuration file.
SweepConfig frozen(SweepConfig config) {
    config.meshes = expand_inputs(config.meshes);
    if (config.meshes.empty())
        throw UsageError("no meshes: name them, or give a configuration with [input] meshes");
    require_shardable(config);
    config.threads = 0;
    config.shard.clear();
    return config;
}

/// A task must have time to work before it makes way.
void require_time(const SlurmJob& job) {
    if (job.time.empty()) return;
    const auto limit = seconds_of_time_limit(job.time);
    if (limit && *limit <= job.grace)
        throw UsageError(
            fmt::format("--time {} is {} s: not larger than --grace ({} s before its end a task "
                        "makes way for its next start)",
                        job.time, *limit, job.grace));
}

/// What makes mixed processors give the same bits, where it is set here.
std::vector<std::pair<std::string, std::string>> chosen_processor() {
    std::vector<std::pair<std::string, std::string>> environment;
    for (const char* name : {"RICCI_INSTRUCTION_SET", "OPENBLAS_CORETYPE"})
        if (const char* value = std::getenv(name))  // NOLINT(concurrency-mt-unsafe): nobody sets it
            environment.emplace_back(name, value);
    return environment;
}

/// Says what the shards would have to do.
void report_plan(const SweepConfig& config, int shards, int threads) {
    SweepConfig first = config;
    first.shard = fmt::format("0/{}", shards);
    const SweepPlan plan(first, config.meshes, threads);
    spdlog::info("{} files: {}", config.meshes.size(), plan.division());
    if (plan.idle() > 0)
        spdlog::warn("{} of {} shards would have nothing to do; fewer would serve as well", plan.idle(),
                     shards);
}

/// Writes the job's folder. What an earlier submission of the same job finished stays.
void write_folder(const SlurmJob& job, const SweepConfig& config) {
    const std::string path = job.folder + "/sweep.toml";
    const std::string text =
        fmt::format("# {} shards. Written by 'ricci submit'.\n{}", job.shards, to_toml(config, false));
    if (fs::exists(path) && read_text(path) != text)
        throw UsageError(
            fmt::format("{} holds a job of another configuration or number of shards; remove it, or "
                        "name another output",
                        job.folder));
    std::error_code error;
    fs::create_directories(job.folder + "/logs", error);
    if (error) throw system_error(job.folder, "cannot make the folder", error.value());
    write_text_durably(path, text);
    write_text_durably(job.folder + "/array.sh", array_script(job));
    write_text_durably(job.folder + "/merge.sh", merge_script(job));
    write_text_durably(job.folder + "/submit.sh", submit_script(job));
}

/// Runs the script and returns what it printed. Throws FileError when it fails.
std::string run_script(const std::string& script, bool retry_failed) {
    struct ClosePipe {
        void operator()(std::FILE* pipe) const { ::pclose(pipe); }
    };
    const std::string command = "bash " + shell_quoted(script) + (retry_failed ? " --retry-failed" : "");
    std::unique_ptr<std::FILE, ClosePipe> pipe(::popen(command.c_str(), "r"));
    if (!pipe) throw system_error(script, "cannot be run", errno);
    std::string text;
    char buffer[256];
    while (std::fgets(buffer, sizeof buffer, pipe.get()) != nullptr) text += buffer;
    const int status = ::pclose(pipe.release());
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw FileError(fmt::format("{}: sbatch did not accept the job (see above)", script));
    return text;
}

/// The number behind "array job " or "merge job ".
std::string job_number(const std::string& printed, const std::string& words) {
    const std::size_t at = printed.find(words);
    if (at == std::string::npos) return {};
    const std::size_t begin = at + words.size();
    return printed.substr(begin, printed.find('\n', begin) - begin);
}

int submit(SubmitArguments arguments, const SweepConfig& given, const CommonOptions& common) {
    if (!arguments.slurm) throw UsageError("name the batch system: --slurm (the only one so far)");
    const SweepConfig config = frozen(given);
    SlurmJob& job = arguments.job;
    require_time(job);
    job.environment = chosen_processor();
    job.program = fs::read_symlink("/proc/self/exe").string();
    job.output = fs::absolute(config.output).string();
    job.folder = job.output + ".shards";
    job.directory = fs::current_path().string();
    job.name = job_name(config.output);
    report_plan(config, job.shards, common.resolved_threads());
    write_folder(job, config);
    const std::string script = job.folder + "/submit.sh";
    const std::string printed = arguments.dry_run ? std::string() : run_script(script, given.retry_failed);
    const std::string array = job_number(printed, "array job "), merge = job_number(printed, "merge job ");
    if (common.json) {
        print_json({{"folder", job.folder},
                    {"output", job.output},
                    {"shards", job.shards},
                    {"array_job", array},
                    {"merge_job", merge}});
    } else if (arguments.dry_run) {
        fmt::print("wrote {}: submit with  bash {}\n", job.folder, shell_quoted(script));
    } else {
        fmt::print("array job {} ({} tasks), then merge job {}, which writes {}\nscripts and logs: {}\n",
                   array, job.shards, merge, job.output, job.folder);
    }
    return kDone;
}

}  // namespace

void add_submit(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command =
        app.add_subcommand("submit", "A sweep on a cluster: an array job, and a job that joins it");
    auto a = std::make_shared<SubmitArguments>();
    SlurmJob& job = a->job;
    command->add_flag("--slurm", a->slurm, "By Slurm's sbatch");
    command->add_option("--shards", job.shards, "Tasks to divide the work among")
        ->required()
        ->check(CLI::Range(1, 100000));
    command->add_option("--cpus", job.cpus, "CPUs per task")
        ->capture_default_str()
        ->check(CLI::Range(1, 4096));
    command->add_option("--time", job.time,
                        "Time limit of a task, as sbatch takes it; one that reaches it starts again");
    command->add_option("--mem", job.memory, "Memory of a task, as sbatch takes it");
    command->add_option("--at-once", job.at_once, "Tasks at a time; 0: any number")
        ->check(CLI::NonNegativeNumber);
    command
        ->add_option("--grace", job.grace,
                     "Seconds before the time limit at which a task makes way for its next start")
        ->capture_default_str()
        ->check(CLI::Range(10, 65535));
    command->add_option("--sbatch", job.options, "Further options of sbatch, like --sbatch=--partition=long");
    command->add_flag("--retry-failed", a->sweep.values.retry_failed,
                      "Shards that an earlier submission finished try again what failed in them");
    command->add_flag("--dry-run", a->dry_run, "Write the scripts, and submit nothing");
    add_sweep_options(command, &a->sweep);
    add_common(*command, common);
    command->footer(
        "Scripts, logs and shards go to OUTPUT.shards; docs/cluster.md says more.\n"
        "Example: ricci submit --slurm --shards 16 --cpus 8 --time 4:00:00 scans/ --vertices sample:500 -o "
        "scans.h5");
    command->callback([&common, &action, a, command] {
        action = [&common, a, command] { return submit(*a, resolved_config(*command, a->sweep), common); };
    });
}

}  // namespace ricci::app
