// `ricci index build`, `add` and `remove`: everything that writes an index.
#include <fmt/format.h>
#include <fnmatch.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <set>

#include "engine/app/app.h"
#include "engine/app/index_build.h"
#include "engine/app/index_commands.h"
#include "engine/app/isolation/failure_bundle.h"
#include "engine/app/records.h"

namespace ricci::app {
namespace {

// Files in the order given, each once.
std::vector<std::string> without_repeats(const std::vector<std::string>& files) {
    std::set<std::string> seen;
    std::vector<std::string> result;
    for (const std::string& file : files)
        if (seen.insert(file).second) result.push_back(file);
    return result;
}

/// Whether a failure is one of this file or of a component of it.
bool concerns(const FailureRecord& failure, const std::string& file) {
    return failure.item == file || failure.item.starts_with(file + "#c");
}

/// Entries of an index, file by file, in its order.
std::vector<IndexInput> kept_inputs(const ShapeIndex& index) {
    std::vector<IndexInput> inputs;
    std::map<std::string, std::size_t> number;
    for (const IndexEntry& entry : index.entries) {
        const auto [found, added] = number.emplace(entry.file, inputs.size());
        if (added) inputs.push_back({entry.file, {}});
        inputs[found->second].kept.push_back({entry.file, entry.shape.hash, entry.shape.component});
    }
    return inputs;
}

nlohmann::json to_json(const BuiltShape& shape) {
    const bool failed = !shape.failure.status.empty();
    return {{"file", shape.file},
            {"component", shape.component},
            {"components", shape.components},
            {"status", failed ? shape.failure.status : std::string(name_of(Status::converged))},
            {"stage", failed ? nlohmann::json(shape.failure.stage) : nlohmann::json()},
            {"message", shape.failure.message},
            {"reused", shape.reused}};
}

/// What a build, or an addition, did. Returns the exit status.
int report(const std::vector<BuiltShape>& shapes, const std::string& output, double seconds,
           const CommonOptions& common) {
    std::size_t failed = 0, reused = 0;
    for (const BuiltShape& shape : shapes) {
        failed += shape.failure.status.empty() ? 0 : 1;
        reused += shape.reused ? 1 : 0;
        if (common.json) print_json(to_json(shape));
    }
    if (!common.json) {
        const std::size_t described = shapes.size() - reused - failed;
        fmt::print("{} shapes described, {} known before, {} failed; {:.2f} s, {:.1f} shapes/s\nwrote {}\n",
                   described, reused, failed, seconds,
                   seconds > 0.0 ? static_cast<double>(described) / seconds : 0.0, output);
    }
    return failed > 0 ? kSomeFailed : kDone;
}

int run_build(const IndexArguments& a, const CommonOptions& common, const IndexConfig& config,
              std::vector<IndexInput> inputs, std::vector<FailureRecord> failures) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    BuildOptions options;
    options.threads = common.resolved_threads();
    options.max_memory = a.max_memory.empty() ? 0 : parse_bytes(a.max_memory);
    options.quiet = common.quiet;
    options.isolate = a.isolate;
    options.hang_timeout = a.hang_timeout;
    options.output = a.index;
    const std::string toml = to_toml(config);
    IndexStore store(a.index, make_run_info(toml, toml, options.threads), kDescriptorVersion, a.resume);
    for (const std::string& note : store.notes()) spdlog::warn("{}", note);
    catch_signals();
    IndexBuild build(config, std::move(inputs), store);
    build.run(options);
    if (const int signal = caught_signal(); signal != 0) {
        spdlog::warn("stopped by a signal; what is finished is in {}.parts: continue with --resume", a.index);
        return 128 + signal;
    }
    const std::vector<FailureRecord> unreadable = build.load_failures();
    failures.insert(failures.end(), unreadable.begin(), unreadable.end());
    const std::vector<BuiltShape> shapes = build.shapes();
    store.assemble(build.sources(), failures);
    remove_other_bundles(a.index, build.failed_bundles());
    return report(shapes, a.index, std::chrono::duration<double>(Clock::now() - start).count(), common);
}

/// Whether a path as given to `remove` means this file of the index: itself, a folder above it, or a glob.
bool names_file(const std::string& path, const std::string& file) {
    std::string folder = path;
    while (folder.size() > 1 && folder.ends_with('/')) folder.pop_back();
    return file == path || file.starts_with(folder + "/") || fnmatch(path.c_str(), file.c_str(), 0) == 0;
}

}  // namespace

int index_build(const IndexArguments& a, const CommonOptions& common) {
    shape_options(a.config);  // complains before anything is written
    std::vector<IndexInput> inputs;
    for (const std::string& file : without_repeats(expand_inputs(a.paths))) inputs.push_back({file, {}});
    return run_build(a, common, a.config, std::move(inputs), {});
}

int index_add(const IndexArguments& a, const CommonOptions& common) {
    const ShapeIndex index = read_shape_index(a.index);
    if (index.descriptor_version != kDescriptorVersion)
        throw UsageError(a.index + ": its shapes were described by another version of ricci; build it anew");
    const IndexConfig config = index_config_from_toml(index.info.fingerprint);
    std::vector<IndexInput> inputs = kept_inputs(index);
    std::vector<FailureRecord> failures = index.failures;
    for (const std::string& file : without_repeats(expand_inputs(a.paths))) {
        std::erase_if(failures, [&](const FailureRecord& f) { return concerns(f, file); });
        const auto known = std::find_if(inputs.begin(), inputs.end(),
                                        [&](const IndexInput& input) { return input.file == file; });
        if (known == inputs.end())
            inputs.push_back({file, {}});
        else
            known->kept.clear();  // read again: it may have changed
    }
    return run_build(a, common, config, std::move(inputs), std::move(failures));
}

int index_remove(const IndexArguments& a, const CommonOptions& common) {
    const ShapeIndex index = read_shape_index(a.index);
    std::set<std::string> removed;
    std::set<std::string> files;
    for (const IndexEntry& entry : index.entries) files.insert(entry.file);
    for (const FailureRecord& failure : index.failures) files.insert(failure.item);
    int status = kDone;
    for (const std::string& path : a.paths) {
        std::size_t found = 0;
        for (const std::string& file : files)
            if (names_file(path, file)) {
                removed.insert(file);
                ++found;
            }
        if (found > 0) continue;
        spdlog::error("{}: holds nothing at '{}'", a.index, path);
        status = kSomeFailed;
    }
    std::vector<IndexSource> sources;
    for (const IndexEntry& entry : index.entries)
        if (!removed.contains(entry.file))
            sources.push_back({entry.file, entry.shape.hash, entry.shape.component});
    std::vector<FailureRecord> failures;
    for (const FailureRecord& failure : index.failures)
        if (std::none_of(removed.begin(), removed.end(),
                         [&](const std::string& file) { return concerns(failure, file); }))
            failures.push_back(failure);
    RunInfo info = make_run_info(index.info.config, index.info.fingerprint, common.resolved_threads());
    IndexStore store(a.index, info, index.descriptor_version, false);
    store.assemble(sources, failures);
    const std::size_t shapes = index.entries.size() - sources.size();
    if (common.json)
        print_json({{"file", a.index}, {"removed", shapes}, {"left", sources.size()}});
    else
        fmt::print("{} shapes removed, {} left\nwrote {}\n", shapes, sources.size(), a.index);
    return status;
}

}  // namespace ricci::app
