// Work for several machines, divided by its cost: no clock and no chance in it, so that each of them can work
// out the same plan for itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ricci {

/// Work that can be cut. Costs in any unit, the same for all; not negative.
struct WorkUnit {
    double divisible = 0.0;         // shared out among the parts
    double fixed = 0.0;             // comes again with every part
    std::size_t parts_at_most = 1;  // at least 1
};

/// A unit is cut at multiples of 1/kWholeUnit.
inline constexpr std::uint32_t kWholeUnit = 1U << 20U;

/// A part of a unit, [first, last) of kWholeUnit.
struct WorkPart {
    std::size_t unit = 0;
    std::uint32_t first = 0, last = kWholeUnit;
};

/// Who does what.
struct WorkDivision {
    std::vector<std::vector<WorkPart>> parts;  // of each shard, ascending by unit
    std::vector<double> load;                  // of each shard
    double whole = 0.0;                        // all units, each in one piece

    /// The largest load over the mean one; 1 when there is nothing to do.
    [[nodiscard]] double imbalance() const;
    /// What cutting adds to the work, as a part of it.
    [[nodiscard]] double overhead() const;
};

/// How far a division goes to be even.
struct DivisionOptions {
    double slack = 0.02;   // a unit is cut where a shard would come this much above the mean,
    double spread = 0.03;  // and in any case in as many parts as add this much to its cost: a unit that costs
                           // more than was foreseen is then no shard's burden alone
};

/// The costliest units first, each to the shards with the least to do (Graham 1969), as few as the options
/// allow, in parts that leave them level. The parts of a unit are disjoint and cover it. Throws
/// std::invalid_argument for no shards.
WorkDivision divide_work(const std::vector<WorkUnit>& units, std::size_t shards,
                         const DivisionOptions& options = {});

/// Whether the k-th of the elements of a unit belongs to the part. The elements of a part lie spread over the
/// unit (multiples of the golden ratio, Knuth 6.4), so that a costly neighbourhood is shared out.
[[nodiscard]] bool belongs(std::size_t k, const WorkPart& part);

}  // namespace ricci
