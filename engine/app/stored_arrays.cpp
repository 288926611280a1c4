#include "engine/app/stored_arrays.h"

#include <algorithm>
#include <cmath>

namespace ricci::app {

StoredArrays::StoredArrays(const ResultGroup& group) : where_(group.item + ": " + group.kind + "/") {
    for (const ResultArray& array : group.arrays) arrays_[array.path] = &array;
}

std::vector<Isometry<double>> StoredArrays::isometries(const std::string& path) const {
    std::vector<Isometry<double>> result;
    for (const auto& [ar, ai, br, bi] : rows<4>(path)) result.push_back({{ar, ai}, {br, bi}});
    return result;
}

const std::vector<Index>& StoredArrays::starts(const std::string& path, std::size_t end) const {
    const std::vector<Index>& first = list<Index>(path);
    require(!first.empty() && first.front() == 0 && static_cast<std::size_t>(first.back()) == end &&
                std::is_sorted(first.begin(), first.end()),
            "lists do not fit together");
    return first;
}

std::vector<std::vector<Index>> StoredArrays::lists(const std::string& path) const {
    const auto& all = list<Index>(path);
    const auto& first = starts(path + "_first", all.size());
    std::vector<std::vector<Index>> lists;
    for (std::size_t k = 0; k + 1 < first.size(); ++k)
        lists.emplace_back(all.begin() + first[k], all.begin() + first[k + 1]);
    return lists;
}

std::vector<std::vector<Point>> StoredArrays::polylines(const std::string& path, std::size_t count) const {
    std::vector<std::vector<Point>> lines(count);
    if (!has(path)) return lines;
    const std::vector<Point> all = rows<3>(path);
    const auto& first = starts(path + "_first", all.size());
    require(first.size() == count + 1, "polylines are not as many as they should be");
    require(std::all_of(all.begin(), all.end(),
                        [](const Point& p) {
                            return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
                        }),
            "a point of a polyline is not finite");
    for (std::size_t k = 0; k < count; ++k)
        lines[k].assign(all.begin() + first[k], all.begin() + first[k + 1]);
    return lines;
}

void StoredArrays::require(bool holds, const char* what) const {
    if (!holds) throw FileError(where_ + ": " + what);
}

}  // namespace ricci::app
