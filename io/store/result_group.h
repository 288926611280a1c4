// Results of further kinds (a planar layout, a spectrum, ...): named attributes and arrays that the store
// keeps for an item without knowing what they mean.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace ricci {

/// An attribute of a result group. A name is a lower-case identifier ([a-z][a-z0-9_]*); `status`, `complete`,
/// `xxh3` and `attributes_xxh3` are the store's own.
struct ResultAttribute {
    std::string name;
    std::variant<std::string, double, std::int32_t, std::int64_t, std::uint8_t, std::vector<std::string>>
        value;
    bool operator==(const ResultAttribute&) const = default;
};

/// An array of a result group. A path is one or more names with slashes between them: "generators/matrix"
/// is `matrix` in the subgroup `generators`. An empty shape is a scalar.
struct ResultArray {
    std::string path;
    std::vector<std::uint64_t> shape;
    std::variant<std::vector<double>, std::vector<std::int32_t>, std::vector<std::uint8_t>,
                 std::vector<std::string>>
        values;  // in row order, as many as the shape says
    bool operator==(const ResultArray&) const = default;
};

/// One result of an item: the group <kind> beside its mesh. Kinds are lower-case identifiers; mesh, sweep,
/// flow and the words of the journal (io/store/journal.h) are taken. Groups that were read have their
/// attributes ascending by name, their arrays by path; texts come back as stored (bytes that are not UTF-8 as
/// \xNN).
struct ResultGroup {
    std::string item, kind;
    std::uint8_t status = 0;  // value of the run's status names
    std::vector<ResultAttribute> attributes{};
    std::vector<ResultArray> arrays{};
    bool operator==(const ResultGroup&) const = default;  // NaN differs from itself
};

}  // namespace ricci
