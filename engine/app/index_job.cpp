#include "engine/app/index_job.h"

#include <fnmatch.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

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

/// Whether a path as given to `remove` means this file of the index: itself, a folder above it, or a glob.
bool names_file(const std::string& path, const std::string& file) {
    std::string folder = path;
    while (folder.size() > 1 && folder.ends_with('/')) folder.pop_back();
    return file == path || file.starts_with(folder + "/") || fnmatch(path.c_str(), file.c_str(), 0) == 0;
}

}  // namespace

IndexWork index_of(const IndexConfig& config, const std::vector<std::string>& paths) {
    shape_options(config);  // complains before anything is written
    IndexWork work{config, {}, {}};
    for (const std::string& file : without_repeats(expand_inputs(paths))) work.inputs.push_back({file, {}});
    return work;
}

IndexWork index_with(const std::string& path, const std::vector<std::string>& paths) {
    const ShapeIndex index = read_shape_index(path);
    if (index.descriptor_version != kDescriptorVersion)
        throw UsageError(path + ": its shapes were described by another version of ricci; build it anew");
    IndexWork work{index_config_from_toml(index.info.fingerprint), kept_inputs(index), index.failures};
    for (const std::string& file : without_repeats(expand_inputs(paths))) {
        std::erase_if(work.failures, [&](const FailureRecord& f) { return concerns(f, file); });
        const auto known = std::find_if(work.inputs.begin(), work.inputs.end(),
                                        [&](const IndexInput& input) { return input.file == file; });
        if (known == work.inputs.end())
            work.inputs.push_back({file, {}});
        else
            known->kept.clear();  // read again: it may have changed
    }
    return work;
}

IndexJob write_index(const IndexWork& work, const BuildOptions& options, bool resume) {
    const std::string toml = to_toml(work.config);
    IndexStore store(options.output, make_run_info(toml, toml, options.threads), kDescriptorVersion, resume);
    for (const std::string& note : store.notes()) spdlog::warn("{}", note);
    IndexBuild build(work.config, work.inputs, store);
    build.run(options);
    IndexJob job;
    job.stopped = options.stop();
    if (job.stopped) return job;
    std::vector<FailureRecord> failures = work.failures;
    const std::vector<FailureRecord> unreadable = build.load_failures();
    failures.insert(failures.end(), unreadable.begin(), unreadable.end());
    job.shapes = build.shapes();
    store.assemble(build.sources(), failures);
    remove_other_bundles(options.output, build.failed_bundles());
    return job;
}

IndexRemoval remove_from_index(const std::string& path, const std::vector<std::string>& paths, int threads) {
    const ShapeIndex index = read_shape_index(path);
    std::set<std::string> removed;
    std::set<std::string> files;
    for (const IndexEntry& entry : index.entries) files.insert(entry.file);
    for (const FailureRecord& failure : index.failures) files.insert(failure.item);
    IndexRemoval removal;
    for (const std::string& given : paths) {
        std::size_t found = 0;
        for (const std::string& file : files)
            if (names_file(given, file)) {
                removed.insert(file);
                ++found;
            }
        if (found == 0) removal.not_found.push_back(given);
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
    IndexStore store(path, make_run_info(index.info.config, index.info.fingerprint, threads),
                     index.descriptor_version, false);
    store.assemble(sources, failures);
    removal.removed = index.entries.size() - sources.size();
    removal.left = sources.size();
    return removal;
}

}  // namespace ricci::app
