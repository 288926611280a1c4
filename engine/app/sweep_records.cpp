#include "engine/app/sweep_records.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <utility>

namespace ricci::app {
namespace {

constexpr std::string_view kVertexStage = "sweep vertex ";

bool costly(const std::string& status) {
    return status == name_of(Status::internal_error) || status == name_of(Status::out_of_memory) ||
           status == name_of(Status::timeout);
}

}  // namespace

std::string vertex_stage(Index vertex) {
    return fmt::format("{}{}", kVertexStage, vertex);
}

std::optional<Index> vertex_of_stage(const std::string& stage) {
    if (!stage.starts_with(kVertexStage)) return std::nullopt;
    Index vertex = 0;
    const char* const end = stage.data() + stage.size();
    const auto read = std::from_chars(stage.data() + kVertexStage.size(), end, vertex);
    if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
    return vertex;
}

std::optional<FailureRecord> StoreRecords::begin(const SweepStage& stage) {
    if (store_ == nullptr) return std::nullopt;
    auto known = store_->failure_of(stage.item, stage.stage);
    if (!known || !costly(known->status)) return std::nullopt;
    {
        const std::lock_guard lock(mutex_);
        const std::pair key(stage.item, stage.stage);
        if (retry_ && !failed_.contains(key)) return std::nullopt;
        failed_.insert(key);
    }
    if (stage.stage == kSweepStage) store_->release(stage.item);
    return known;
}

void StoreRecords::passed(const SweepStage& stage) {
    if (store_ == nullptr || has_failed(stage.item, stage.stage)) return;
    store_->retract_failure({stage.item, stage.stage, "", ""});
}

std::string StoreRecords::name_for(const ItemRecord& item) {
    const std::lock_guard lock(mutex_);
    for (int use = 1;; ++use) {
        std::string name = use == 1 ? item.name : fmt::format("{}~{}", item.name, use);
        if (used_.contains(name)) continue;
        if (store_ != nullptr) {
            const auto stored = store_->source_of(name);
            // Another file's: it got the name when this one failed, or was not there.
            if (stored && stored->source != stored_form(item.source)) continue;
            if (stored && stored->source_hash != item.source_hash)
                throw UsageError(fmt::format(
                    "{}: has changed since its item {} was stored; sweep it afresh, without --resume",
                    item.source, name));
        }
        used_.insert(name);
        return name;
    }
}

Admission StoreRecords::admit(const ItemRecord& item, const SweepStage& /*stage*/) {
    const std::string name = name_for(item);
    if (store_ != nullptr && !store_->has_item(name)) {
        ItemRecord named = item;
        named.name = name;
        store_->write_item(named);
    }
    return admission_of(name);
}

Admission StoreRecords::admission_of(const std::string& name) const {
    Admission admission{name, {}};
    if (store_ == nullptr) return admission;
    for (const SweepRow& row : store_->finished_rows(name))
        if (!retry_ || row.status == static_cast<std::uint8_t>(Status::converged))
            admission.finished.push_back(row.vertex);
    return admission;
}

void StoreRecords::finished(const SweepBlock& block) {
    if (store_ == nullptr) return;
    store_->write_sweep_block(block);
    for (const SweepRow& row : block.rows)
        if (row.status == static_cast<std::uint8_t>(Status::converged))
            store_->retract_failure({block.item, vertex_stage(row.vertex), "", ""});
}

void StoreRecords::item_finished(const std::string& item, double /*seconds*/) {
    if (store_ != nullptr) store_->release(item);
}

void StoreRecords::failed(const FailureRecord& failure) {
    progress_->clear();
    spdlog::error("{} ({}): {}: {}", failure.item, failure.stage, failure.status, failure.message);
    {
        const std::lock_guard lock(mutex_);
        failed_.emplace(failure.item, failure.stage);
    }
    if (store_ == nullptr) return;
    const auto known = store_->failure_of(failure.item, failure.stage);
    if (!known || known->status != failure.status || known->message != failure.message)
        store_->write_failure(failure);
    if (failure.stage == kSweepStage) store_->release(failure.item);
}

bool StoreRecords::was_admitted(const std::string& item) const {
    const std::lock_guard lock(mutex_);
    return used_.contains(item);
}

bool StoreRecords::has_failed(const std::string& item, const std::string& stage) const {
    const std::lock_guard lock(mutex_);
    return failed_.contains({item, stage});
}

void StoreRecords::forget_mended() {
    std::string item;  // that `rows` are of: failures of one item follow each other
    std::vector<SweepRow> rows;
    for (const FailureRecord& failure : store_->failures()) {
        if (has_failed(failure.item, failure.stage)) continue;
        if (store_->has_item(failure.item) && !was_admitted(failure.item)) continue;  // nobody tried again
        if (const auto vertex = vertex_of_stage(failure.stage)) {
            if (std::exchange(item, failure.item) != failure.item) rows = store_->finished_rows(item);
            const auto row = std::lower_bound(rows.begin(), rows.end(), *vertex,
                                              [](const SweepRow& a, Index v) { return a.vertex < v; });
            const bool failing = row != rows.end() && row->vertex == *vertex &&
                                 row->status != static_cast<std::uint8_t>(Status::converged);
            if (failing) continue;
        }
        store_->retract_failure(failure);
    }
}

void drop_needless(std::vector<KeptFactor>& kept, const KeepPolicy& keep) {
    if (keep.count < 0) return;
    std::sort(kept.begin(), kept.end(), [](const KeptFactor& a, const KeptFactor& b) {
        return a.area_distortion != b.area_distortion ? a.area_distortion < b.area_distortion
                                                      : a.vertex < b.vertex;
    });
    // Best and worst do not count among the `count` others, so a block offers two more.
    const std::size_t others =
        keep.count > 0 ? static_cast<std::size_t>(keep.count) + 2 : (keep.best ? 1 : 0);
    if (kept.size() <= others) return;
    // The worst: largest distortion, ties to the lowest vertex.
    const auto worst = std::max_element(
        kept.begin(), kept.end(),
        [](const KeptFactor& a, const KeptFactor& b) { return a.area_distortion < b.area_distortion; });
    const auto rest = kept.begin() + static_cast<std::ptrdiff_t>(others);
    if (keep.worst && worst >= rest) {
        std::iter_swap(rest, worst);
        kept.erase(rest + 1, kept.end());
    } else {
        kept.erase(rest, kept.end());
    }
}

}  // namespace ricci::app
