#include "engine/app/index_build.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <new>
#include <utility>

#include "engine/app/isolation/isolated_index.h"
#include "engine/app/shape_record.h"
#include "engine/app/solve_arguments.h"
#include "engine/app/sweep_config.h"
#include "engine/flow/cancellation.h"
#include "engine/sweep/task_queue.h"
#include "io/mesh/mesh_file.h"
#include "io/store/durable.h"
#include "kernels/parallel.h"

namespace ricci::app {
namespace {

// Memory of a task by the size of its file, generously.
constexpr std::int64_t kBytesPerFileByte = 100, kBytesAtLeast = 32 << 20;

std::uintmax_t size_of(const std::string& file) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    return error ? 0 : size;
}

}  // namespace

std::string joined_errors(const LoadedMesh& loaded) {
    std::string message;
    for (const Defect& error : loaded.report.errors) message += (message.empty() ? "" : "; ") + error.message;
    return message;
}

IndexBuild::IndexBuild(const IndexConfig& config, std::vector<IndexInput> inputs, IndexStore& store)
    : config_(config),
      options_(shape_options(config)),
      resolutions_(parse_resolutions(config.resolutions)),
      inputs_(std::move(inputs)),
      store_(&store) {
    for (std::size_t i = 0; i < inputs_.size(); ++i)
        if (inputs_[i].kept.empty()) readings_.push_back({i, size_of(inputs_[i].file), 0, false, "", {}});
}

void IndexBuild::run(const BuildOptions& build) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    ProgressLine own(build.quiet);
    ProgressLine& progress = build.progress != nullptr ? *build.progress : own;
    stop_ = build.stop;
    // The largest first, so that none of them is alone at the end.
    std::vector<Reading*> order;
    order.reserve(readings_.size());
    for (Reading& reading : readings_) order.push_back(&reading);
    std::stable_sort(order.begin(), order.end(),
                     [](const Reading* a, const Reading* b) { return a->size > b->size; });
    if (build.isolate) return run_in_children(order, build, progress);
    options_.flow.parallel = build.threads > 1 && order.size() == 1;
    const auto total = static_cast<std::int64_t>(order.size());
    std::int64_t done = 0;
    TaskQueueOptions queue;
    queue.threads = build.threads;
    queue.max_memory = build.max_memory;
    queue.stop = stop_;
    const auto work = [&](std::size_t task) {
        if (!read(*order[task])) return false;
        const std::lock_guard lock(mutex_);
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        progress.show({order.size(), order.size(), ++done, total, seconds});
        return true;
    };
    const auto finished = [&](const std::vector<std::size_t>& tasks) {
        std::vector<Reading*> block;
        for (const std::size_t task : tasks) block.push_back(order[task]);
        hand_over(block);
    };
    const auto bytes = [&](std::size_t task) {
        return kBytesAtLeast + kBytesPerFileByte * static_cast<std::int64_t>(order[task]->size);
    };
    with_thread_limit(build.threads, [&] { run_tasks(order.size(), work, finished, bytes, queue); });
    progress.clear();
}

/// False: cancelled.
bool IndexBuild::read(Reading& reading) {
    const std::string& file = inputs_[reading.input].file;
    try {
        fault_point("load", file);
        std::string bytes = read_text(file);
        reading.hash = checksum_of(std::string_view(bytes));
        reading.reused = store_->known_components(reading.hash) > 0;
        return reading.reused || describe(reading, std::move(bytes));
    } catch (const FileError& e) {
        reading.load_error = e.what();
    } catch (const std::bad_alloc&) {
        reading.load_error = file + ": memory ran out";
    }
    return true;
}

bool IndexBuild::describe(Reading& reading, std::string bytes) {
    const LoadedMesh loaded =
        load_mesh_bytes(inputs_[reading.input].file, std::move(bytes), parse_repair(config_.repair));
    if (!loaded.report.errors.empty()) {
        reading.load_error = joined_errors(loaded);
        return true;
    }
    const auto components = static_cast<std::int32_t>(loaded.components.size());
    for (std::int32_t c = 0; c < components; ++c) {
        if (!claim(reading.hash, c)) continue;  // a file with the same bytes is under way, or known
        fault_point("describe", shape_name(inputs_[reading.input].file, c, components));
        const CancellationScope scope(stop_);
        ShapeOptions options = options_;
        options.flow.interrupted = interruption(config_.timeout, stop_);
        ShapeRecord record =
            describe_to_record(loaded.components[static_cast<std::size_t>(c)], options, resolutions_);
        if (stop_() && record.status != static_cast<std::uint8_t>(Status::converged)) return false;
        record.hash = reading.hash;
        record.component = c;
        record.components = components;
        reading.shapes.push_back(std::move(record));
    }
    return true;
}

bool IndexBuild::claim(std::uint64_t hash, std::int32_t component) {
    if (store_->knows(hash, component)) return false;
    const std::lock_guard lock(mutex_);
    return claimed_.emplace(hash, component).second;
}

void IndexBuild::hand_over(const std::vector<Reading*>& finished) {
    std::vector<ShapeRecord> shapes;
    for (Reading* reading : finished) {
        const std::string& file = inputs_[reading->input].file;
        if (!reading->load_error.empty()) spdlog::error("{}: {}", file, reading->load_error);
        for (ShapeRecord& shape : reading->shapes) {
            const auto status = static_cast<Status>(shape.status);
            if (status != Status::converged)
                spdlog::error("{}: {}: {}", shape_name(file, shape.component, shape.components),
                              name_of(status), shape.message);
            shapes.push_back(std::move(shape));
        }
        reading->shapes = {};
    }
    if (!shapes.empty()) store_->write_shapes(shapes);
}

void IndexBuild::run_in_children(const std::vector<Reading*>& order, const BuildOptions& build,
                                 ProgressLine& progress) {
    IsolatedIndex work(*this, order, build.output, progress);
    run_isolated(order.size(), work, {build.threads, build.max_memory, build.hang_timeout, build.stop});
    work.settle();
    progress.clear();
}

std::vector<std::string> IndexBuild::failed_bundles() const {
    std::vector<std::string> names;
    for (const Reading& reading : readings_) {
        if (!reading.load_error.empty()) continue;
        const std::int32_t components = store_->known_components(reading.hash);
        for (std::int32_t c = 0; c < components; ++c)
            if (store_->shape(reading.hash, c).status != static_cast<std::uint8_t>(Status::converged))
                names.push_back(IsolatedIndex::bundle_name(inputs_[reading.input].file, reading.hash, c));
    }
    return names;
}

std::vector<IndexSource> IndexBuild::sources() const {
    std::vector<IndexSource> sources;
    auto reading = readings_.begin();
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
        sources.insert(sources.end(), inputs_[i].kept.begin(), inputs_[i].kept.end());
        if (reading == readings_.end() || reading->input != i) continue;
        if (reading->load_error.empty())
            for (std::int32_t c = 0; c < store_->known_components(reading->hash); ++c)
                sources.push_back({inputs_[i].file, reading->hash, c});
        ++reading;
    }
    return sources;
}

std::vector<FailureRecord> IndexBuild::load_failures() const {
    std::vector<FailureRecord> failures;
    for (const Reading& reading : readings_)
        if (!reading.load_error.empty())
            failures.push_back({inputs_[reading.input].file, "load",
                                std::string(name_of(Status::invalid_input)), reading.load_error});
    return failures;
}

std::vector<BuiltShape> IndexBuild::shapes() const {
    std::vector<BuiltShape> shapes;
    for (const Reading& reading : readings_) {
        const std::string& file = inputs_[reading.input].file;
        if (!reading.load_error.empty()) {
            shapes.push_back(
                {file,
                 0,
                 1,
                 false,
                 {file, "load", std::string(name_of(Status::invalid_input)), reading.load_error}});
            continue;
        }
        const std::int32_t components = store_->known_components(reading.hash);
        for (std::int32_t c = 0; c < components; ++c) {
            const ShapeRecord shape = store_->shape(reading.hash, c);
            const auto status = static_cast<Status>(shape.status);
            FailureRecord failure;
            if (status != Status::converged)
                failure = {shape_name(file, c, components), "describe", std::string(name_of(status)),
                           shape.message};
            shapes.push_back({file, c, components, reading.reused, failure});
        }
    }
    return shapes;
}

}  // namespace ricci::app
