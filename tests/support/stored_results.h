// Finding one's way in results that were read back.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>

#include "io/store/run_store.h"

namespace ricci::testing {

/// The group of a kind, of the first item.
inline const ResultGroup& group_of(const StoredRun& run, const std::string& kind) {
    const auto& results = run.items.at(0).results;
    const auto found =
        std::find_if(results.begin(), results.end(), [&](const ResultGroup& g) { return g.kind == kind; });
    if (found == results.end()) throw std::runtime_error("no group " + kind);
    return *found;
}

inline const ResultArray& array_of(const ResultGroup& group, const std::string& path) {
    for (const ResultArray& a : group.arrays)
        if (a.path == path) return a;
    throw std::out_of_range("no array " + path);
}
template <class Value>
const std::vector<Value>& values_of(const ResultGroup& group, const std::string& path) {
    return std::get<std::vector<Value>>(array_of(group, path).values);
}

}  // namespace ricci::testing
