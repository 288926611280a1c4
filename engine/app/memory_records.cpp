#include "engine/app/memory_records.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "engine/flow/status.h"

namespace ricci::app {
namespace {

bool converged(const SweepRow& row) {
    return row.status == static_cast<std::uint8_t>(Status::converged);
}

/// Takes the factor of a vertex out of the candidates.
void move_factor(std::vector<KeptFactor>& from, Index vertex, std::vector<KeptFactor>& to) {
    const auto found =
        std::find_if(from.begin(), from.end(), [&](const KeptFactor& k) { return k.vertex == vertex; });
    if (found == from.end()) return;
    to.push_back(std::move(*found));
    from.erase(found);
}

}  // namespace

Admission MemoryRecords::admit(const ItemRecord& item, const SweepStage& /*stage*/) {
    const std::lock_guard lock(mutex_);
    std::string name = item.name;
    for (int use = 2; items_.contains(name); ++use) name = fmt::format("{}~{}", item.name, use);
    StoredItem& stored = items_[name];
    stored.item = item;
    stored.item.name = name;
    return {name, {}};
}

void MemoryRecords::finished(const SweepBlock& block) {
    const std::lock_guard lock(mutex_);
    StoredItem& stored = items_.at(block.item);
    if (!stored.sweep) stored.sweep.emplace();
    StoredSweep& sweep = *stored.sweep;
    sweep.rows.insert(sweep.rows.end(), block.rows.begin(), block.rows.end());
    sweep.kept.insert(sweep.kept.end(), block.kept.begin(), block.kept.end());
    drop_needless(sweep.kept, keep_);
}

void MemoryRecords::failed(const FailureRecord& failure) {
    progress_->clear();
    spdlog::error("{} ({}): {}: {}", failure.item, failure.stage, failure.status, failure.message);
    const std::lock_guard lock(mutex_);
    failures_.push_back(failure);
}

StoredRun MemoryRecords::take(const std::vector<std::string>& names) {
    const std::lock_guard lock(mutex_);
    StoredRun run;
    std::map<std::string, std::size_t> places;
    for (const std::string& name : names) {
        places.emplace(name, places.size());
        run.items.push_back(std::move(items_.at(name)));
        if (run.items.back().sweep) choose_kept(*run.items.back().sweep, keep_);
    }
    const auto key = [&](const FailureRecord& f) {
        const auto found = places.find(f.item);
        return std::tuple(found == places.end() ? places.size() : found->second, f.item, f.stage);
    };
    run.failures = std::exchange(failures_, {});
    std::stable_sort(run.failures.begin(), run.failures.end(),
                     [&](const FailureRecord& a, const FailureRecord& b) { return key(a) < key(b); });
    items_.clear();
    return run;
}

void choose_kept(StoredSweep& sweep, const KeepPolicy& keep) {
    std::sort(sweep.rows.begin(), sweep.rows.end(),
              [](const SweepRow& a, const SweepRow& b) { return a.vertex < b.vertex; });
    const SweepRow* best = nullptr;
    const SweepRow* worst = nullptr;
    for (const SweepRow& row : sweep.rows) {
        if (!converged(row)) continue;
        if (best == nullptr || row.area_distortion < best->area_distortion) best = &row;
        if (worst == nullptr || row.area_distortion > worst->area_distortion) worst = &row;
    }
    std::vector<KeptFactor> candidates = std::exchange(sweep.kept, {});
    if (keep.best && best != nullptr) sweep.best = best->vertex;
    if (keep.worst && worst != nullptr) sweep.worst = worst->vertex;
    if (sweep.best) move_factor(candidates, *sweep.best, sweep.kept);
    if (sweep.worst && sweep.worst != sweep.best) move_factor(candidates, *sweep.worst, sweep.kept);
    if (keep.count == 0) return;
    std::sort(candidates.begin(), candidates.end(), [](const KeptFactor& a, const KeptFactor& b) {
        return std::tie(a.area_distortion, a.vertex) < std::tie(b.area_distortion, b.vertex);
    });
    if (keep.count > 0 && candidates.size() > static_cast<std::size_t>(keep.count))
        candidates.resize(static_cast<std::size_t>(keep.count));
    std::move(candidates.begin(), candidates.end(), std::back_inserter(sweep.kept));
}

}  // namespace ricci::app
