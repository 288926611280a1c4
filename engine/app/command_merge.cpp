#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>

#include "engine/app/app.h"
#include "engine/app/commands.h"
#include "engine/app/records.h"
#include "io/store/merge_shards.h"

namespace ricci::app {
namespace {

namespace fs = std::filesystem;

/// The result files of a folder, and those that an unfinished OUT.h5.parts is to become; sorted.
std::vector<std::string> shards_in(const std::string& folder) {
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder)) {
        fs::path path = entry.path();
        if (path.extension() == ".parts") path.replace_extension();
        if (path.extension() == ".h5") found.insert(path.string());
    }
    if (found.empty()) throw UsageError(fmt::format("the folder '{}' holds no result file", folder));
    return {found.begin(), found.end()};
}

std::vector<std::string> shard_files(const std::vector<std::string>& arguments) {
    std::vector<std::string> files;
    for (const std::string& argument : arguments) {
        const bool is_folder = fs::is_directory(argument);
        if (is_folder && !argument.ends_with(".parts")) {
            const std::vector<std::string> found = shards_in(argument);
            files.insert(files.end(), found.begin(), found.end());
        } else {
            files.push_back(is_folder ? argument.substr(0, argument.size() - 6) : argument);
        }
    }
    return files;
}

int merge(const std::vector<std::string>& arguments, const std::string& output, const CommonOptions& common) {
    const std::vector<std::string> files = shard_files(arguments);
    for (const std::string& file : files)
        if (fs::exists(file) && fs::exists(output) && fs::equivalent(file, output))
            throw UsageError(output + " is one of the shards; give the whole run another name");
    MergedRun merged;
    try {
        merged = merge_shards(files, output, make_run_info("", "", common.resolved_threads()));
    } catch (const ShardError& e) {
        for (const std::string& complaint : e.complaints()) spdlog::error("{}", complaint);
        spdlog::error("nothing is merged");
        return kUsage;
    }
    for (const std::string& warning : merged.warnings) spdlog::warn("{}", warning);
    if (common.json) {
        print_json({{"file", output},
                    {"shards", merged.shards},
                    {"items", merged.items},
                    {"rows", merged.rows},
                    {"failed_rows", merged.failed_rows},
                    {"failures", merged.failures}});
    } else {
        fmt::print("{} shards: {} items, {} rows, {} of them failed; {} failures in all\nwrote {}\n",
                   merged.shards, merged.items, merged.rows, merged.failed_rows, merged.failures, output);
    }
    return merged.failures > 0 ? kSomeFailed : kDone;
}

}  // namespace

void add_merge(CLI::App& app, CommonOptions& common, Action& action) {
    auto* command = app.add_subcommand("merge", "Join the results of all shards of a sweep into one file");
    auto shards = std::make_shared<std::vector<std::string>>();
    auto output = std::make_shared<std::string>();
    command->add_option("SHARD", *shards, "Result files of 'ricci sweep --shard', or a folder of them")
        ->required();
    command->add_option("-o,--output", *output, "The whole run's result file (HDF5)")->required();
    add_common(*command, common);
    command->footer(
        "Nothing is written unless every shard is there, finished, sound and of the same run: the same\n"
        "configuration, version, number of shards and contents of the inputs (docs/cluster.md says what is "
        "noticed).\n"
        "Shards from different kinds of processors are joined with a warning, and so are items that a shard "
        "gave\nup on: 'ricci sweep --shard i/N ... --retry-failed' tries them again.\n"
        "Example: ricci merge shard-0.h5 shard-1.h5 -o eight.h5");
    command->callback([&common, &action, shards, output] {
        action = [&common, shards, output] { return merge(*shards, *output, common); };
    });
}

}  // namespace ricci::app
