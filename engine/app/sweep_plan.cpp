#include "engine/app/sweep_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <filesystem>
#include <iterator>
#include <new>
#include <numeric>
#include <optional>
#include <utility>

#include "engine/app/console.h"
#include "engine/app/solve_options.h"
#include "engine/sweep/sweep_solver.h"
#include "io/mesh/mesh_file.h"
#include "io/store/durable.h"
#include "io/store/fault_point.h"
#include "io/store/shard_table.h"
#include "kernels/parallel.h"

namespace ricci::app {
namespace {

// Seconds of one thread on surfaces of V vertices, measured once; docs/results/shard_balance.md shows how
// evenly they divide the sample meshes. Only their ratios matter, and no host may measure its own: all shards
// must find the same numbers. No function of the mathematical library either, whose last digit depends on the
// processor.
constexpr double kLoadFile = 5e-3, kLoadVertex = 2e-6;
constexpr double kResampleVertex = 1e-5;  // of the input
constexpr double kSetUp = 1e-3, kSetUpVertex = 2e-5;
constexpr double kLaneSolve = 4e-4, kLaneSolveVertex = 2e-7;
constexpr double kNewtonSolve = 6e-3, kNewtonSolveVertex = 6e-6;

// Files are loaded for the plan up to this part of a shard's time, or for so many seconds anyway.
constexpr double kLoadShare = 0.02, kLoadSeconds = 5.0;
// And no more vertices at a time than these: about 500 bytes each while a file is loaded. A single larger
// file counts by its size, on every host, however much memory that has.
constexpr double kLoadedAtATime = 2e6;

/// What a plan knows of a component.
struct Surface {
    double vertices = 0.0, faces = 0.0, candidates = 0.0;
    bool admissible = true;
};

/// What a plan knows of a file.
struct Input {
    double bytes = 0.0, vertices = 0.0;  // vertices: by the size of the file
    std::vector<Surface> surfaces;       // none: it cannot be read
};

/// Bytes per vertex in files of a kind, with two faces for each.
double bytes_per_vertex(const std::string& file) {
    std::filesystem::path path(file);
    const bool packed = path.extension() == ".gz";
    if (packed) path = path.stem();
    const std::string suffix = path.extension().string();
    double bytes = 80.0;
    if (suffix == ".ply") bytes = 45.0;
    if (suffix == ".stl") bytes = 100.0;
    if (suffix == ".len") bytes = 160.0;
    return packed ? bytes / 3.0 : bytes;
}

Input by_size(const std::string& file) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    Input input;
    input.bytes = error ? 0.0 : static_cast<double>(size);
    input.vertices = input.bytes / bytes_per_vertex(file);
    input.surfaces = {{input.vertices, 2.0 * input.vertices, input.vertices, true}};
    return input;
}

/// Nothing where loading fails in a way that says nothing of the file: it counts by its size then.
std::optional<std::vector<Surface>> by_loading(const std::string& file, const RepairOptions& repair,
                                               const SweepOptions& options) {
    std::vector<Surface> surfaces;
    try {
        fault_point("plan", file);
        const LoadedMesh loaded = load_mesh(file, repair);
        for (const SurfaceMesh& mesh : loaded.components) {
            const Topology topology = topology_of(mesh.connectivity);
            const std::vector<std::uint8_t> boundary = boundary_vertices(mesh.connectivity);
            const auto on_boundary = std::count(boundary.begin(), boundary.end(), std::uint8_t{1});
            surfaces.push_back({static_cast<double>(topology.vertices), static_cast<double>(topology.faces),
                                static_cast<double>(topology.vertices) - static_cast<double>(on_boundary),
                                explain_inadmissible(topology, options).empty()});
        }
    } catch (const FileError&) {
        surfaces.clear();  // the sweep says so, and has nothing else to do
    } catch (const std::bad_alloc&) {
        // Other hosts may have had the memory, and another plan.
        throw FileError(file + ": memory ran out while it was loaded to divide the work");
    } catch (const std::exception&) {
        return std::nullopt;
    }
    return surfaces;
}

class CostModel {
  public:
    explicit CostModel(const SweepConfig& config)
        : choice_(parse_vertices(config.vertices)), options_(sweep_options(config)) {}

    [[nodiscard]] const SweepOptions& options() const { return options_; }
    [[nodiscard]] const VertexChoice& choice() const { return choice_; }

    [[nodiscard]] static double loading(double vertices) { return kLoadFile + kLoadVertex * vertices; }

    /// A file at a resolution (target faces; 0: as it is).
    [[nodiscard]] WorkUnit unit(const Input& input, Index resolution) const {
        WorkUnit unit;
        unit.fixed = loading(input.vertices);
        double solves = 0.0;
        for (const Surface& surface : input.surfaces) {
            const double scale =
                resolution > 0 ? static_cast<double>(resolution) / std::max(surface.faces, 1.0) : 1.0;
            const double vertices = scale * surface.vertices;
            if (resolution > 0) unit.fixed += kResampleVertex * surface.vertices;
            unit.fixed += kSetUp + (surface.admissible ? kSetUpVertex * vertices : 0.0);
            if (!surface.admissible) continue;
            const double count = chosen(scale * surface.candidates);
            solves += count;
            unit.divisible += count * solve(vertices);
        }
        // Fewer vertices than there are lanes take a worker as long as a full set.
        unit.parts_at_most = 1 + static_cast<std::size_t>(solves / kLanes);
        return unit;
    }

  private:
    [[nodiscard]] double chosen(double candidates) const {
        if (choice_.kind == VertexChoice::Kind::list) return static_cast<double>(choice_.list.size());
        return choice_.kind == VertexChoice::Kind::sample
                   ? std::min(candidates, static_cast<double>(choice_.count))
                   : candidates;
    }

    [[nodiscard]] double solve(double vertices) const {
        const bool lanes =
            options_.scheme == Scheme::vertex_scaling && options_.solver == SweepSolverKind::lanes;
        return lanes ? kLaneSolve + kLaneSolveVertex * vertices
                     : kNewtonSolve + kNewtonSolveVertex * vertices;
    }

    VertexChoice choice_;
    SweepOptions options_;
};

std::vector<WorkUnit> units_of(const std::vector<Input>& inputs, const std::vector<Index>& resolutions,
                               const CostModel& model) {
    std::vector<WorkUnit> units;
    for (const Input& input : inputs)
        for (const Index resolution : resolutions) units.push_back(model.unit(input, resolution));
    return units;
}

/// The largest files, as many as may be loaded for a plan.
std::vector<std::size_t> worth_loading(const std::vector<Input>& inputs, const std::vector<WorkUnit>& units,
                                       std::size_t shards) {
    double total = 0.0;
    for (const WorkUnit& unit : units) total += unit.divisible + unit.fixed;
    const double budget = std::max(kLoadSeconds, kLoadShare * total / static_cast<double>(shards));
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < inputs.size(); ++i)
        if (inputs[i].vertices <= kLoadedAtATime) order.push_back(i);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return inputs[a].vertices > inputs[b].vertices; });
    double spent = 0.0;
    const auto end = std::find_if(order.begin(), order.end(), [&](std::size_t input) {
        return (spent += CostModel::loading(inputs[input].vertices)) > budget;
    });
    order.erase(end, order.end());
    return order;
}

std::string digest_of(const std::vector<std::string>& files, const std::vector<Input>& inputs,
                      VertexChoice choice, const WorkDivision& division) {
    std::string text;
    if (choice.kind == VertexChoice::Kind::list) {
        // The configuration names the file alone.
        std::sort(choice.list.begin(), choice.list.end());
        choice.list.erase(std::unique(choice.list.begin(), choice.list.end()), choice.list.end());
        text += hex16(digest_of_vertices(choice.list)) + "\n";
    }
    for (std::size_t i = 0; i < files.size(); ++i)
        text += fmt::format("{}:{} {}\n", files[i].size(), files[i], inputs[i].bytes);
    for (const auto& parts : division.parts) {
        for (const WorkPart& part : parts) text += fmt::format("{} {} {};", part.unit, part.first, part.last);
        text += "\n";
    }
    return hex16(checksum_of(std::string_view(text)));
}

}  // namespace

void require_shardable(const SweepConfig& config) {
    if (config.component >= 0)
        throw UsageError("a sweep in shards does not go with --component ([input] component)");
    sweep_options(config);
    parse_repair(config.repair);
    parse_vertices(config.vertices);
    parse_resolutions(config.resolutions);
    parse_keep(config.keep);
    if (!config.max_memory.empty()) parse_bytes(config.max_memory);
}

SweepPlan::SweepPlan(std::size_t files, std::size_t resolutions) : inputs_(files), resolutions_(resolutions) {
    std::vector<WorkPart> parts;
    for (std::size_t unit = 0; unit < files * resolutions; ++unit) parts.push_back({unit, 0, kWholeUnit});
    take_parts(std::move(parts));
}

SweepPlan::SweepPlan(std::vector<WorkPart> parts, std::size_t resolutions)
    : inputs_(1), resolutions_(resolutions) {
    take_parts(std::move(parts));
}

SweepPlan::SweepPlan(const SweepConfig& config, const std::vector<std::string>& files, int threads)
    : inputs_(files.size()), sharded_(true), shard_(parse_shard(config.shard)) {
    const std::vector<Index> resolutions = parse_resolutions(config.resolutions);
    const RepairOptions repair = parse_repair(config.repair);
    const CostModel model(config);
    resolutions_ = resolutions.size();
    std::vector<Input> inputs;
    std::transform(files.begin(), files.end(), std::back_inserter(inputs), by_size);
    const std::vector<std::size_t> load =
        worth_loading(inputs, units_of(inputs, resolutions, model), shard_.count);
    // The first is the largest.
    const double largest = load.empty() ? 1.0 : std::max(inputs[load.front()].vertices, 1.0);
    const int workers = static_cast<int>(std::min(static_cast<double>(threads), kLoadedAtATime / largest));
    std::atomic<std::size_t> next{0}, loaded{0};
    run_workers(workers, [&](int) {
        for (std::size_t k = next++; k < load.size(); k = next++) {
            auto surfaces = by_loading(files[load[k]], repair, model.options());
            if (!surfaces) continue;
            inputs[load[k]].surfaces = std::move(*surfaces);
            ++loaded;
        }
    });
    loaded_ = loaded;
    WorkDivision division = divide_work(units_of(inputs, resolutions, model), shard_.count);
    digest_ = digest_of(files, inputs, model.choice(), division);
    imbalance_ = division.imbalance();
    overhead_ = division.overhead();
    const double total = std::accumulate(division.load.begin(), division.load.end(), 0.0);
    if (total > 0.0) share_ = division.load[shard_.index] * static_cast<double>(shard_.count) / total;
    idle_ = static_cast<std::size_t>(std::count_if(division.parts.begin(), division.parts.end(),
                                                   [](const auto& parts) { return parts.empty(); }));
    take_parts(std::move(division.parts[shard_.index]));
}

void SweepPlan::take_parts(std::vector<WorkPart> parts) {
    parts_ = std::move(parts);
    for (const WorkPart& part : parts_)
        if (const std::size_t file = part.unit / resolutions_; files_.empty() || files_.back() != file)
            files_.push_back(file);
}

const WorkPart* SweepPlan::part(std::size_t file, std::size_t resolution) const {
    const std::size_t unit = file * resolutions_ + resolution;
    const auto found = std::lower_bound(parts_.begin(), parts_.end(), unit,
                                        [](const WorkPart& part, std::size_t u) { return part.unit < u; });
    return found == parts_.end() || found->unit != unit ? nullptr : &*found;
}

std::vector<WorkPart> SweepPlan::parts_of(std::size_t file) const {
    std::vector<WorkPart> parts;
    for (std::size_t r = 0; r < resolutions_; ++r)
        if (const WorkPart* known = part(file, r)) parts.push_back({r, known->first, known->last});
    return parts;
}

std::string SweepPlan::summary() const {
    const auto cut = std::count_if(parts_.begin(), parts_.end(), [](const WorkPart& part) {
        return part.first > 0 || part.last < kWholeUnit;
    });
    return fmt::format("shard {}/{}: {} of {} files, {} in part, {:.2f} of the mean work; {}", shard_.index,
                       shard_.count, files_.size(), inputs_, cut, share_, division());
}

std::string SweepPlan::division() const {
    return fmt::format(
        "the largest of {} shards has {:.2f} of the mean, cutting adds {:.0f} % (foreseen from the topology "
        "of {} files and the size of {})",
        shard_.count, imbalance_, 100.0 * overhead_, loaded_, inputs_ - loaded_);
}

}  // namespace ricci::app
