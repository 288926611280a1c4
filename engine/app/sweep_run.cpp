#include "engine/app/sweep_run.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>

#include "engine/app/records.h"
#include "engine/remesh/resample.h"

namespace ricci::app {
namespace {

constexpr const char* kSweepStage = "sweep";

/// The candidates of a block for what the assembled file keeps: its best and worst, or more where asked.
std::vector<KeptFactor> candidates_of(std::vector<SweepSolve>& solves, const KeepPolicy& keep) {
    std::vector<SweepSolve*> converged;
    for (SweepSolve& s : solves)
        if (s.status == Status::converged) converged.push_back(&s);
    std::sort(converged.begin(), converged.end(), [](const SweepSolve* a, const SweepSolve* b) {
        return a->area_distortion != b->area_distortion ? a->area_distortion < b->area_distortion
                                                        : a->vertex < b->vertex;
    });
    const std::size_t count = converged.size();
    // Best and worst do not count among the `count` others, so a block offers two more.
    const std::size_t others =
        keep.count > 0 ? static_cast<std::size_t>(keep.count) + 2 : (keep.best ? 1 : 0);
    const std::size_t first = keep.count < 0 ? count : std::min(count, others);
    std::vector<KeptFactor> kept;
    // The worst: largest distortion, ties to the lowest vertex.
    const auto worst = std::max_element(
        converged.begin(), converged.end(),
        [](const SweepSolve* a, const SweepSolve* b) { return a->area_distortion < b->area_distortion; });
    for (std::size_t k = 0; k < count; ++k) {
        const bool wanted = k < first || (keep.worst && converged[k] == *worst);
        if (wanted)
            kept.push_back({converged[k]->vertex, converged[k]->area_distortion,
                            std::move(converged[k]->conformal_factor)});
    }
    return kept;
}

}  // namespace

SweepRun::SweepRun(const SweepConfig& config, std::vector<std::string> files, RunStore* store,
                   ProgressLine& progress)
    : config_(config),
      files_(std::move(files)),
      store_(store),
      progress_(&progress),
      options_(sweep_options(config)),
      choice_(parse_vertices(config.vertices)),
      resolutions_(parse_resolutions(config.resolutions)),
      shard_(parse_shard(config.shard)),
      keep_(parse_keep(config.keep)),
      repair_(parse_repair(config.repair)) {}

std::string SweepRun::unique_name(const std::string& name) {
    const int uses = ++name_uses_[name];
    return uses == 1 ? name : fmt::format("{}~{}", name, uses);
}

std::size_t SweepRun::add_item(Item item) {
    const std::lock_guard lock(mutex_);
    items_.push_back(std::move(item));
    return items_.size() - 1;
}

void SweepRun::record_failure(std::size_t item, const std::string& stage, Status status,
                              const std::string& message) {
    std::string name;
    {
        const std::lock_guard lock(mutex_);
        items_[item].status = status;
        items_[item].message = message;
        name = items_[item].name;
        any_failure_ = true;
    }
    progress_->clear();
    spdlog::error("{}: {}: {}", name, name_of(status), message);
    const FailureRecord failure{name, stage, std::string(name_of(status)), message};
    if (store_ != nullptr && !store_->has_failure(failure)) store_->write_failure(failure);
}

std::vector<SweepTask> SweepRun::open(std::size_t number) {
    const std::string& file = files_[number];
    std::vector<SweepTask> tasks;
    const std::string fallback = std::filesystem::path(file).stem().string();
    LoadedMesh loaded;
    try {
        loaded = load_mesh(file, repair_);
    } catch (const FileError& e) {
        record_failure(add_item({unique_name(fallback), false, 0, {}, {}, 0.0}), "load",
                       Status::invalid_input, e.what());
        return tasks;
    }
    for (const Defect& note : loaded.report.notes) spdlog::debug("{}: {}", file, note.message);
    if (!loaded.report.errors.empty()) {
        std::string message;
        for (const Defect& error : loaded.report.errors)
            message += (message.empty() ? "" : "; ") + error.message;
        record_failure(add_item({unique_name(loaded.stem), false, 0, {}, {}, 0.0}), "load",
                       Status::invalid_input, message);
        return tasks;
    }
    for (std::size_t c = 0; c < loaded.components.size(); ++c) {
        const std::string stem =
            loaded.components.size() > 1 ? fmt::format("{}.c{}", loaded.stem, c) : loaded.stem;
        for (const Index resolution : resolutions_)
            if (auto task = open_surface(file, stem, loaded.content_hash, loaded.components[c], resolution))
                tasks.push_back(std::move(*task));
    }
    return tasks;
}

std::optional<SweepTask> SweepRun::open_surface(const std::string& file, const std::string& stem,
                                                std::uint64_t hash, const SurfaceMesh& mesh,
                                                Index resolution) {
    ResampledMesh resampled;
    if (resolution > 0) {
        try {
            resampled = resample(mesh, resolution);
        } catch (const std::invalid_argument& e) {
            record_failure(add_item({unique_name(item_name(stem, resolution)), false, 0, {}, {}, 0.0}),
                           "resample", Status::invalid_input, e.what());
            return std::nullopt;
        }
        for (Index& v : resampled.source_vertex) v = mesh.input_vertex[static_cast<std::size_t>(v)];
    } else {
        resampled.mesh = mesh;
        resampled.source_vertex = mesh.input_vertex;
    }
    const std::string name = unique_name(item_name(stem, resampled.mesh.connectivity.face_count()));
    if (store_ != nullptr && !store_->has_item(name))
        store_->write_item(make_item(name, file, hash, resampled.mesh, resampled.source_vertex));
    const std::size_t item = add_item({name, true, 0, {}, {}, 0.0});
    auto surface = std::make_shared<SweepSurface>(std::move(resampled.mesh), options_);
    if (!surface->inadmissible().empty()) {
        record_failure(item, kSweepStage, Status::inadmissible_target, surface->inadmissible());
        return std::nullopt;
    }
    std::vector<Index> chosen;
    try {
        chosen = choose_vertices(choice_, surface->candidates());
    } catch (const std::invalid_argument& e) {
        record_failure(item, kSweepStage, Status::invalid_input, e.what());
        return std::nullopt;
    }
    std::vector<Index> own;
    for (std::size_t k = shard_.index; k < chosen.size(); k += shard_.count) own.push_back(chosen[k]);
    {
        const std::lock_guard lock(mutex_);
        items_[item].vertices = own.size();
    }
    return SweepTask{item, std::move(surface), to_solve(name, std::move(own))};
}

std::vector<Index> SweepRun::to_solve(const std::string& item, std::vector<Index> chosen) const {
    if (store_ == nullptr) return chosen;
    const std::vector<Index> finished = store_->finished_vertices(item);
    std::vector<Index> left;
    std::set_difference(chosen.begin(), chosen.end(), finished.begin(), finished.end(),
                        std::back_inserter(left));
    return left;
}

void SweepRun::block_finished(std::size_t item, std::vector<SweepSolve> solves) {
    std::string name;
    {
        const std::lock_guard lock(mutex_);
        name = items_[item].name;
        for (const SweepSolve& s : solves) any_failure_ = any_failure_ || s.status != Status::converged;
    }
    SweepBlock block;
    block.item = name;
    for (const SweepSolve& s : solves) {
        block.rows.push_back(make_row(s));
        if (s.status == Status::converged) continue;
        progress_->clear();
        spdlog::error("{} vertex {}: {}: {}", name, s.vertex, name_of(s.status), s.message);
        if (store_ != nullptr)
            store_->write_failure({name, fmt::format("{} vertex {}", kSweepStage, s.vertex),
                                   std::string(name_of(s.status)), s.message});
    }
    block.kept = candidates_of(solves, keep_);
    if (store_ != nullptr) store_->write_sweep_block(block);
}

void SweepRun::item_finished(std::size_t item, double seconds) {
    const std::lock_guard lock(mutex_);
    items_[item].seconds = seconds;
}

void SweepRun::item_failed(std::size_t item, Status status, const std::string& message) {
    record_failure(item, kSweepStage, status, message);
}

void SweepRun::progress(const SchedulerProgress& progress) {
    progress_->show(progress);
}

std::vector<std::string> SweepRun::stored_items() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> names;
    for (const Item& item : items_)
        if (item.stored) names.push_back(item.name);
    return names;
}

std::vector<ItemSummary> SweepRun::summaries() const {
    const std::lock_guard lock(mutex_);
    std::vector<ItemSummary> result;
    for (const Item& item : items_) {
        ItemSummary summary{item.name, item.status, item.message, item.vertices, 0, 0, {}, {}, item.seconds};
        if (item.stored && store_ != nullptr) {
            for (const SweepRow& row : store_->finished_rows(item.name)) {
                if (row.status != static_cast<std::uint8_t>(Status::converged)) {
                    ++summary.failed;
                    continue;
                }
                ++summary.solved;
                if (!summary.best || row.area_distortion < summary.best->area_distortion) summary.best = row;
                if (!summary.worst || row.area_distortion > summary.worst->area_distortion)
                    summary.worst = row;
            }
        }
        result.push_back(std::move(summary));
    }
    return result;
}

}  // namespace ricci::app
