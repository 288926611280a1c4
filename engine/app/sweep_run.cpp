#include "engine/app/sweep_run.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <new>

#include "engine/app/records.h"
#include "io/store/fault_point.h"

namespace ricci::app {
namespace {

/// The candidates of a block for what the assembled file keeps: its best and worst, or more where asked.
std::vector<KeptFactor> candidates_of(std::vector<SweepSolve>& solves, const KeepPolicy& keep) {
    std::vector<KeptFactor> kept;
    for (SweepSolve& s : solves)
        if (s.status == Status::converged)
            kept.push_back({s.vertex, s.area_distortion, std::move(s.conformal_factor)});
    drop_needless(kept, keep);
    return kept;
}

/// The exception being handled as a status: what concerns one item ends that item.
Status status_of(const std::exception& e) {
    if (dynamic_cast<const std::bad_alloc*>(&e) != nullptr) return Status::out_of_memory;
    const bool input = dynamic_cast<const FileError*>(&e) != nullptr ||
                       dynamic_cast<const std::invalid_argument*>(&e) != nullptr;
    return input ? Status::invalid_input : Status::internal_error;
}

std::string message_of(const std::exception& e) {
    return dynamic_cast<const std::bad_alloc*>(&e) != nullptr ? "memory ran out" : e.what();
}

}  // namespace

SweepRun::SweepRun(const SweepConfig& config, std::vector<SweepSource> sources, const SweepPlan& plan,
                   SweepRecords& records, ProgressLine& progress)
    : config_(config),
      sources_(std::move(sources)),
      records_(&records),
      progress_(&progress),
      options_(sweep_options(config)),
      choice_(parse_vertices(config.vertices)),
      resolutions_(parse_resolutions(config.resolutions)),
      plan_(&plan),
      keep_(parse_keep(config.keep)),
      repair_(parse_repair(config.repair)) {}

std::size_t SweepRun::add_item(const SweepStage& stage, bool stored, const ShardItem& place) {
    const std::lock_guard lock(mutex_);
    items_.emplace_back();
    items_.back().name = stage.item;
    items_.back().stored = stored;
    items_.back().place = place;
    stages_.push_back(stage);
    return items_.size() - 1;
}

/// A failure that is on record already.
void SweepRun::take_over(std::size_t item, const FailureRecord& failure) {
    const auto name = std::find(kStatusNames.begin(), kStatusNames.end(), failure.status);
    const std::lock_guard lock(mutex_);
    items_[item].status = name == kStatusNames.end() ? Status::internal_error
                                                     : static_cast<Status>(name - kStatusNames.begin());
    items_[item].message = failure.message;
    any_failure_ = true;
}

void SweepRun::record_failure(std::size_t item, Status status, const std::string& message) {
    const SweepStage stage = stage_of(item);
    const FailureRecord failure{stage.item, stage.stage, std::string(name_of(status)), message};
    take_over(item, failure);
    records_->failed(failure);
}

std::vector<SweepTask> SweepRun::open(std::size_t i) {
    const std::size_t number = plan_->files()[i];
    const SweepSource& source = sources_[number];
    const SweepStage stage{source.name, kLoadStage};
    ShardItem place;
    place.base = source.name;
    place.input = static_cast<std::int32_t>(number);
    if (const auto known = records_->begin(stage)) {
        take_over(add_item(stage, false, place), *known);
        return {};
    }
    LoadedMesh loaded;
    try {
        fault_point("load", source.name);
        loaded = source.loaded ? *source.loaded : load_mesh(source.file, repair_);
    } catch (const std::exception& e) {
        record_failure(add_item(stage, false, place), status_of(e), message_of(e));
        return {};
    }
    for (const Defect& note : loaded.report.notes) spdlog::debug("{}: {}", source.file, note.message);
    std::string complaint;
    for (const Defect& error : loaded.report.errors)
        complaint += (complaint.empty() ? "" : "; ") + error.message;
    const auto components = static_cast<Index>(loaded.components.size());
    if (complaint.empty() && config_.component >= components)
        complaint = fmt::format("there is no component {}: it has {}", config_.component, components);
    if (!complaint.empty()) {
        record_failure(add_item(stage, false, place), Status::invalid_input, complaint);
        return {};
    }
    records_->passed(stage);
    std::vector<SweepTask> tasks;
    for (Index c = 0; c < components; ++c) {
        if (config_.component >= 0 && config_.component != c) continue;
        for (std::size_t r = 0; r < resolutions_.size(); ++r) {
            const WorkPart* part = plan_->part(number, r);
            if (part == nullptr) continue;
            place.component = c;
            place.resolution = static_cast<std::int32_t>(r);
            if (auto task = open_surface(source, loaded, place, *part)) tasks.push_back(std::move(*task));
        }
    }
    return tasks;
}

std::optional<ResampledMesh> SweepRun::resampled(const SurfaceMesh& mesh, const SweepStage& stage,
                                                 const ShardItem& place) {
    if (stage.resolution == 0) return ResampledMesh{mesh, mesh.input_vertex};
    if (const auto known = records_->begin(stage)) {
        take_over(add_item(stage, false, place), *known);
        return std::nullopt;
    }
    ResampledMesh result;
    try {
        fault_point("resample", stage.item);
        result = resample(mesh, stage.resolution);
    } catch (const std::exception& e) {
        record_failure(add_item(stage, false, place), status_of(e), message_of(e));
        return std::nullopt;
    }
    for (Index& v : result.source_vertex) v = mesh.input_vertex[static_cast<std::size_t>(v)];
    records_->passed(stage);
    return result;
}

std::optional<SweepTask> SweepRun::open_surface(const SweepSource& source, const LoadedMesh& loaded,
                                                ShardItem place, const WorkPart& part) {
    const auto component = static_cast<std::size_t>(place.component);
    const Index resolution = resolutions_[static_cast<std::size_t>(place.resolution)];
    const std::string stem =
        loaded.components.size() > 1 ? fmt::format("{}.c{}", loaded.stem, component) : loaded.stem;
    SweepStage stage{item_name(stem, resolution) + source.suffix(), kResampleStage, place.component,
                     resolution};
    place.base = stage.item;
    auto found = resampled(loaded.components[component], stage, place);
    if (!found) return std::nullopt;
    SurfaceMesh& mesh = found->mesh;
    place.base = item_name(stem, mesh.connectivity.face_count());
    const Admission admission = records_->admit(
        make_item(place.base, source.file, loaded.content_hash, mesh, found->source_vertex), stage);
    stage.item = admission.name;
    stage.stage = kSweepStage;
    const std::size_t item = add_item(stage, true, place);
    if (const auto known = records_->begin(stage)) {
        take_over(item, *known);
        return std::nullopt;
    }
    std::shared_ptr<SweepSurface> surface;
    std::vector<Index> chosen;
    try {
        fault_point("prepare", admission.name);
        surface = std::make_shared<SweepSurface>(std::move(mesh), options_);
        if (surface->inadmissible().empty()) chosen = choose_vertices(choice_, surface->candidates());
    } catch (const std::exception& e) {
        record_failure(item, status_of(e), message_of(e));
        return std::nullopt;
    }
    if (!surface->inadmissible().empty()) {
        record_failure(item, Status::inadmissible_target, surface->inadmissible());
        return std::nullopt;
    }
    std::vector<Index> own, left;
    for (std::size_t k = 0; k < chosen.size(); ++k)
        if (belongs(k, part)) own.push_back(chosen[k]);
    std::set_difference(own.begin(), own.end(), admission.finished.begin(), admission.finished.end(),
                        std::back_inserter(left));
    const ChosenVertices choice{static_cast<std::int32_t>(chosen.size()), digest_of_vertices(chosen),
                                own.size(), left.size()};
    records_->chosen(admission.name, choice);
    {
        const std::lock_guard lock(mutex_);
        choice.put_into(items_[item]);
    }
    return SweepTask{item, std::move(surface), std::move(left)};
}

SweepStage SweepRun::stage_of(std::size_t item) const {
    const std::lock_guard lock(mutex_);
    return stages_[item];
}

void SweepRun::solve_started(std::size_t item, Index vertex) {
    const std::string name = stage_of(item).item;
    records_->started(name, vertex);
    fault_point("solve", name);
}

void SweepRun::block_finished(std::size_t item, std::vector<SweepSolve> solves) {
    SweepBlock block;
    block.item = stage_of(item).item;
    std::size_t doubtful = 0;
    for (const SweepSolve& s : solves) {
        block.rows.push_back(make_row(s));
        if (s.status == Status::converged) {
            if (!s.message.empty() && doubtful++ == 0)
                spdlog::warn("{}, vertex {}: {}", block.item, s.vertex, s.message);
            continue;
        }
        {
            const std::lock_guard lock(mutex_);
            any_failure_ = true;
        }
        records_->failed({block.item, vertex_stage(s.vertex), std::string(name_of(s.status)), s.message});
    }
    if (doubtful > 1) spdlog::warn("{}: the same holds for {} vertices more", block.item, doubtful - 1);
    block.kept = candidates_of(solves, keep_);
    records_->finished(block);
}

void SweepRun::item_finished(std::size_t item, double seconds) {
    const SweepStage stage = stage_of(item);
    {
        const std::lock_guard lock(mutex_);
        items_[item].seconds = seconds;
    }
    records_->passed(stage);
    records_->item_finished(stage.item, seconds);
}

void SweepRun::item_failed(std::size_t item, Status status, const std::string& message) {
    record_failure(item, status, message);
}

void SweepRun::progress(const SchedulerProgress& progress) {
    progress_->show(progress);
}

std::vector<SweepItem> SweepRun::items() const {
    const std::lock_guard lock(mutex_);
    return items_;
}

}  // namespace ricci::app
