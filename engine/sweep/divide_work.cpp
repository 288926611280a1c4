#include "engine/sweep/divide_work.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

namespace ricci {
namespace {

/// Who shares a unit: the emptiest shards, and how full they all are then.
struct Sharing {
    std::vector<std::pair<double, std::size_t>> takers;  // load before, shard
    double level = 0.0;
};

class Division {
  public:
    Division(const std::vector<WorkUnit>& units, std::size_t shards, const DivisionOptions& options)
        : units_(&units), options_(options) {
        result_.parts.resize(shards);
        result_.load.assign(shards, 0.0);
        for (std::size_t s = 0; s < shards; ++s) by_load_.emplace(0.0, s);
        for (const WorkUnit& unit : units) result_.whole += unit.divisible + unit.fixed;
        limit_ = (1.0 + options.slack) * result_.whole / static_cast<double>(shards);
    }

    WorkDivision run() {
        std::vector<std::size_t> order(units_->size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        const auto cost = [&](std::size_t u) { return (*units_)[u].divisible + (*units_)[u].fixed; };
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return cost(a) > cost(b); });
        for (const std::size_t unit : order) assign(unit, share((*units_)[unit]));
        for (auto& parts : result_.parts)
            std::sort(parts.begin(), parts.end(),
                      [](const WorkPart& a, const WorkPart& b) { return a.unit < b.unit; });
        return std::move(result_);
    }

  private:
    /// Parts whose cost, beside that of the whole unit, is small.
    [[nodiscard]] std::size_t cheap_parts(const WorkUnit& unit) const {
        const double further = options_.spread * unit.divisible;
        const double most = static_cast<double>(result_.parts.size());
        return 1 + static_cast<std::size_t>(further < most * unit.fixed ? further / unit.fixed : most);
    }

    /// As many takers as cost little or are needed to stay below the limit, while a further one helps.
    [[nodiscard]] Sharing share(const WorkUnit& unit) const {
        const std::size_t cheap = cheap_parts(unit);
        Sharing sharing;
        double before = 0.0;
        for (const auto& taker : by_load_) {
            const std::size_t count = sharing.takers.size() + 1;
            const double level =
                (before + taker.first + static_cast<double>(count) * unit.fixed + unit.divisible) /
                static_cast<double>(count);
            // A further taker must get a part of its own and help the others.
            if (count > 1 &&
                (count > unit.parts_at_most || taker.first + unit.fixed >= level || level >= sharing.level))
                break;
            before += taker.first;
            sharing.takers.push_back(taker);
            sharing.level = level;
            if (level <= limit_ && count >= cheap) break;
        }
        return sharing;
    }

    void assign(std::size_t number, Sharing sharing) {
        const WorkUnit& unit = (*units_)[number];
        std::sort(sharing.takers.begin(), sharing.takers.end(),
                  [](const auto& a, const auto& b) { return a.second < b.second; });
        double done = 0.0;
        std::uint32_t first = 0;
        for (std::size_t k = 0; k < sharing.takers.size(); ++k) {
            const auto [load, shard] = sharing.takers[k];
            const bool last_taker = k + 1 == sharing.takers.size();
            done += sharing.level - load - unit.fixed;
            const std::uint32_t last =
                last_taker ? kWholeUnit
                           : std::clamp(static_cast<std::uint32_t>(std::floor(
                                            done / unit.divisible * static_cast<double>(kWholeUnit))),
                                        first, kWholeUnit);
            by_load_.erase({load, shard});
            by_load_.emplace(sharing.level, shard);
            result_.load[shard] = sharing.level;
            if (last > first || sharing.takers.size() == 1)
                result_.parts[shard].push_back({number, first, last});
            first = last;
        }
    }

    const std::vector<WorkUnit>* units_;
    DivisionOptions options_;
    WorkDivision result_;
    std::set<std::pair<double, std::size_t>> by_load_;
    double limit_ = 0.0;
};

}  // namespace

double WorkDivision::imbalance() const {
    const double total = std::accumulate(load.begin(), load.end(), 0.0);
    if (!(total > 0.0)) return 1.0;
    return *std::max_element(load.begin(), load.end()) * static_cast<double>(load.size()) / total;
}

double WorkDivision::overhead() const {
    const double total = std::accumulate(load.begin(), load.end(), 0.0);
    return whole > 0.0 ? total / whole - 1.0 : 0.0;
}

WorkDivision divide_work(const std::vector<WorkUnit>& units, std::size_t shards,
                         const DivisionOptions& options) {
    if (shards == 0) throw std::invalid_argument("work is divided among at least one shard");
    return Division(units, shards, options).run();
}

bool belongs(std::size_t k, const WorkPart& part) {
    constexpr std::uint32_t kGolden = 2654435769U;  // 2^32 over the golden ratio
    const std::uint32_t place = (static_cast<std::uint32_t>(k) * kGolden) >> 12U;
    return place >= part.first && place < part.last;
}

}  // namespace ricci
