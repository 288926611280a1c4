#include "engine/quality/distribution.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ricci {

Distribution distribution_of(std::span<const double> values, std::span<const double> weight) {
    struct Entry {
        double value, weight;
    };
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isnan(values[i])) entries.push_back({values[i], weight.empty() ? 1.0 : weight[i]});
    Distribution d;
    if (entries.empty()) return d;
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& x, const Entry& y) { return x.value < y.value; });
    d.count = static_cast<std::int64_t>(entries.size());
    d.min = entries.front().value;
    d.max = entries.back().value;
    double total = 0.0, sum = 0.0;
    for (const Entry& e : entries) {
        total += e.weight;
        if (e.weight > 0.0) sum += e.weight * e.value;
    }
    d.mean = sum / total;
    double below = 0.0;
    std::size_t level = 0;
    for (const Entry& e : entries) {
        below += e.weight;
        while (level < kQuantileLevels.size() && below >= kQuantileLevels[level] * total)
            d.quantile[level++] = e.value;
    }
    return d;
}

double share_within(std::span<const double> values, double low, double high, std::span<const double> weight) {
    double total = 0.0, inside = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isnan(values[i])) continue;
        const double w = weight.empty() ? 1.0 : weight[i];
        total += w;
        if (values[i] >= low && values[i] <= high) inside += w;
    }
    return total > 0.0 ? inside / total : 0.0;
}

}  // namespace ricci
