// Reading attributes and arrays of result groups.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/store/run_store.h"

namespace ricci::app {

/// The group of a kind; null where the item has none.
inline const ResultGroup* result_of(const StoredItem& item, const std::string& kind) {
    for (const ResultGroup& group : item.results)
        if (group.kind == kind) return &group;
    return nullptr;
}

/// The array at a path; null where the group has none of that type.
template <class T>
const std::vector<T>* array_of(const ResultGroup& group, const std::string& path) {
    for (const ResultArray& array : group.arrays)
        if (array.path == path) return std::get_if<std::vector<T>>(&array.values);
    return nullptr;
}

/// The same, empty where there is none.
template <class T>
std::vector<T> values_of(const ResultGroup& group, const std::string& path) {
    const std::vector<T>* values = array_of<T>(group, path);
    return values == nullptr ? std::vector<T>{} : *values;
}

template <class T>
std::optional<T> attribute_of(const ResultGroup& group, const std::string& name) {
    for (const ResultAttribute& attribute : group.attributes)
        if (attribute.name == name)
            if (const T* value = std::get_if<T>(&attribute.value)) return *value;
    return std::nullopt;
}

/// Lists that lie one after another, <path> and <path>_first, as rows of `width` values each; empty where
/// they do not fit together.
template <class T>
std::vector<std::vector<T>> lists_of(const ResultGroup& group, const std::string& path,
                                     std::size_t width = 1) {
    const std::vector<T>* all = array_of<T>(group, path);
    const std::vector<Index>* first = array_of<Index>(group, path + "_first");
    if (all == nullptr || first == nullptr || first->empty() || first->front() != 0) return {};
    std::vector<std::vector<T>> lists;
    for (std::size_t k = 0; k + 1 < first->size(); ++k) {
        const auto begin = static_cast<std::size_t>((*first)[k]) * width,
                   end = static_cast<std::size_t>((*first)[k + 1]) * width;
        if ((*first)[k] < 0 || begin > end || end > all->size()) return {};
        lists.emplace_back(all->begin() + static_cast<std::ptrdiff_t>(begin),
                           all->begin() + static_cast<std::ptrdiff_t>(end));
    }
    return lists;
}

/// Polylines in space: <path>, (n,3), and <path>_first.
inline std::vector<std::vector<Point>> polylines_of(const ResultGroup& group, const std::string& path) {
    std::vector<std::vector<Point>> lines;
    for (const std::vector<double>& flat : lists_of<double>(group, path, 3)) {
        std::vector<Point>& line = lines.emplace_back();
        for (std::size_t i = 0; i + 2 < flat.size(); i += 3)
            line.push_back({flat[i], flat[i + 1], flat[i + 2]});
    }
    return lines;
}

}  // namespace ricci::app
