// Filling result groups with the engine's arrays.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "engine/layout/isometry.h"
#include "io/store/result_group.h"
#include "kernels/connectivity.h"

namespace ricci::app {

/// Rows one after another.
template <class T, std::size_t n>
std::vector<T> flattened(const std::vector<std::array<T, n>>& rows) {
    std::vector<T> values;
    values.reserve(rows.size() * n);
    for (const auto& row : rows) values.insert(values.end(), row.begin(), row.end());
    return values;
}

/// Adds arrays to a result group, in the shapes that occur.
class ResultArrays {
  public:
    explicit ResultArrays(ResultGroup& group) : group_(&group) {}

    template <class T>
    void list(const std::string& path, std::vector<T> values) {
        const auto size = static_cast<std::uint64_t>(values.size());
        group_->arrays.push_back({path, {size}, std::move(values)});
    }
    template <class T, std::size_t n>
    void rows(const std::string& path, const std::vector<std::array<T, n>>& values) {
        group_->arrays.push_back({path, {values.size(), n}, flattened(values)});
    }
    /// Square matrices, row by row.
    template <std::size_t n>
    void matrices(const std::string& path, std::uint64_t size,
                  const std::vector<std::array<double, n>>& values) {
        group_->arrays.push_back({path, {values.size(), size, size}, flattened(values)});
    }
    /// Isometries as (Re a, Im a, Re b, Im b).
    void isometries(const std::string& path, const std::vector<Isometry<double>>& values) {
        std::vector<std::array<double, 4>> entries;
        entries.reserve(values.size());
        for (const auto& x : values) entries.push_back({x.a.re, x.a.im, x.b.re, x.b.im});
        rows(path, entries);
    }
    /// Lists of different lengths, one after another: <path> and <path>_first.
    void lists(const std::string& path, const std::vector<std::vector<Index>>& values) {
        std::vector<Index> all, first{0};
        for (const auto& one : values) {
            all.insert(all.end(), one.begin(), one.end());
            first.push_back(static_cast<Index>(all.size()));
        }
        list(path, std::move(all));
        list(path + "_first", std::move(first));
    }

    /// Polylines, one after another: <path>, (n,3), and <path>_first. Nothing where there are no points.
    void polylines(const std::string& path, const std::vector<std::vector<std::array<double, 3>>>& curves) {
        std::vector<std::array<double, 3>> points;
        std::vector<Index> first{0};
        for (const auto& curve : curves) {
            points.insert(points.end(), curve.begin(), curve.end());
            first.push_back(static_cast<Index>(points.size()));
        }
        if (points.empty()) return;
        rows(path, points);
        list(path + "_first", std::move(first));
    }

  private:
    ResultGroup* group_;
};

}  // namespace ricci::app
