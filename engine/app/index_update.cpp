// `ricci index build`, `add` and `remove`: everything that writes an index.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>

#include "engine/app/app.h"
#include "engine/app/index_commands.h"
#include "engine/app/index_job.h"

namespace ricci::app {
namespace {

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

int run_build(const IndexArguments& a, const CommonOptions& common, const IndexWork& work) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    BuildOptions options;
    options.threads = common.resolved_threads();
    options.max_memory = a.max_memory.empty() ? 0 : parse_bytes(a.max_memory);
    options.quiet = common.quiet;
    options.isolate = a.isolate;
    options.hang_timeout = a.hang_timeout;
    options.output = a.index;
    catch_signals();
    const IndexJob job = write_index(work, options, a.resume);
    if (job.stopped) {
        spdlog::warn("stopped by a signal; what is finished is in {}.parts: continue with --resume", a.index);
        return 128 + caught_signal();
    }
    return report(job.shapes, a.index, std::chrono::duration<double>(Clock::now() - start).count(), common);
}

}  // namespace

int index_build(const IndexArguments& a, const CommonOptions& common) {
    return run_build(a, common, index_of(a.config, a.paths));
}

int index_add(const IndexArguments& a, const CommonOptions& common) {
    return run_build(a, common, index_with(a.index, a.paths));
}

int index_remove(const IndexArguments& a, const CommonOptions& common) {
    const IndexRemoval removal = remove_from_index(a.index, a.paths, common.resolved_threads());
    for (const std::string& path : removal.not_found)
        spdlog::error("{}: holds nothing at '{}'", a.index, path);
    if (common.json)
        print_json({{"file", a.index}, {"removed", removal.removed}, {"left", removal.left}});
    else
        fmt::print("{} shapes removed, {} left\nwrote {}\n", removal.removed, removal.left, a.index);
    return removal.not_found.empty() ? kDone : kSomeFailed;
}

}  // namespace ricci::app
