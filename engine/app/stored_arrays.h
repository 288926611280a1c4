// Arrays of a stored result group, checked as they are taken: whoever uses them need not look again.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "engine/layout/isometry.h"
#include "io/mesh/mesh_file.h"
#include "io/store/result_group.h"
#include "kernels/surface_mesh.h"

namespace ricci::app {

/// Arrays of a group by path. Refers to the group. All throw FileError naming item and array where something
/// is not as it should be.
class StoredArrays {
  public:
    explicit StoredArrays(const ResultGroup& group);

    [[nodiscard]] bool has(const std::string& path) const { return arrays_.contains(path); }
    template <class T>
    [[nodiscard]] const std::vector<T>& list(const std::string& path) const {
        const auto found = arrays_.find(path);
        const auto* values =
            found == arrays_.end() ? nullptr : std::get_if<std::vector<T>>(&found->second->values);
        if (values == nullptr) throw FileError(where_ + path + " is missing or not of the type it should be");
        return *values;
    }
    /// The same, of so many values.
    template <class T>
    [[nodiscard]] const std::vector<T>& list(const std::string& path, std::size_t size) const {
        const std::vector<T>& values = list<T>(path);
        if (values.size() != size) throw FileError(where_ + path + " has not the length it should have");
        return values;
    }
    template <std::size_t n>
    [[nodiscard]] std::vector<std::array<double, n>> rows(const std::string& path) const {
        const std::vector<double>& values = list<double>(path);
        if (values.size() % n != 0) throw FileError(where_ + path + " has not the right shape");
        std::vector<std::array<double, n>> result(values.size() / n);
        for (std::size_t i = 0; i < values.size(); ++i) result[i / n][i % n] = values[i];
        return result;
    }
    [[nodiscard]] std::vector<Isometry<double>> isometries(const std::string& path) const;
    /// Lists that lie one after another: <path>, <path>_first.
    [[nodiscard]] std::vector<std::vector<Index>> lists(const std::string& path) const;
    /// Polylines: the same, of points, all of them finite. `count` empty ones where nothing is stored.
    [[nodiscard]] std::vector<std::vector<Point>> polylines(const std::string& path, std::size_t count) const;
    /// `size` + 1 ascending numbers from 0 to `end`.
    [[nodiscard]] const std::vector<Index>& starts(const std::string& path, std::size_t end) const;
    void require(bool holds, const char* what) const;

  private:
    std::map<std::string, const ResultArray*> arrays_;
    std::string where_;  // "<item>: <kind>/"
};

/// A scalar or text attribute of a group; null where it is missing or of another type.
template <class T>
const T* find_attribute(const ResultGroup& group, const std::string& name) {
    for (const ResultAttribute& attribute : group.attributes)
        if (attribute.name == name) return std::get_if<T>(&attribute.value);
    return nullptr;
}

}  // namespace ricci::app
