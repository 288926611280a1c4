// Records that do not fit together are errors of the caller, found before anything is written.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string_view>

#include "io/store/schema.h"

namespace ricci::schema {
namespace {

constexpr std::size_t kMaximalRank = 32;  // HDF5's

void require(bool holds, const std::string& item, const char* what) {
    if (!holds) throw std::invalid_argument(fmt::format("record of {}: {}", item, what));
}

bool all_below(const std::vector<Triangle>& triangles, std::size_t limit) {
    return std::all_of(triangles.begin(), triangles.end(), [&](const Triangle& triangle) {
        return std::all_of(triangle.begin(), triangle.end(),
                           [&](Index v) { return v >= 0 && static_cast<std::size_t>(v) < limit; });
    });
}

// [a-z][a-z0-9_]*
bool identifier(std::string_view name) {
    const auto lower = [](char c) { return c >= 'a' && c <= 'z'; };
    return !name.empty() && lower(name.front()) && std::all_of(name.begin(), name.end(), [&](char c) {
        return lower(c) || (c >= '0' && c <= '9') || c == '_';
    });
}

// Names that have a meaning of their own beside an item's mesh or in the journal.
bool taken_kind(std::string_view kind) {
    constexpr std::array<std::string_view, 9> kTaken = {"mesh",    "sweep",   "flow", "item", "run",
                                                        "failure", "retract", "drop", "base"};
    return std::find(kTaken.begin(), kTaken.end(), kind) != kTaken.end();
}

bool taken_attribute(std::string_view name) {
    return name == "status" || name == "complete" || name == "xxh3" || name == "attributes_xxh3";
}

bool path_of_identifiers(std::string_view path) {
    for (std::size_t slash = path.find('/'); slash != std::string_view::npos; slash = path.find('/')) {
        if (!identifier(path.substr(0, slash))) return false;
        path.remove_prefix(slash + 1);
    }
    return identifier(path);
}

// Whether `count` values fill the shape, whose product may be beyond any integer.
bool fills(const std::vector<std::uint64_t>& shape, std::uint64_t count) {
    if (std::find(shape.begin(), shape.end(), 0U) != shape.end()) return count == 0;
    std::uint64_t product = 1;
    for (const std::uint64_t extent : shape) {
        if (extent > count / product) return false;
        product *= extent;
    }
    return product == count;
}

// Paths that name one array twice, or an array and a subgroup alike.
bool clash(const std::vector<ResultArray>& arrays) {
    std::set<std::string_view> taken, groups;
    for (const ResultArray& array : arrays) {
        const std::string_view path = array.path;
        if (!taken.insert(path).second) return true;
        for (std::size_t slash = path.find('/'); slash != std::string_view::npos;
             slash = path.find('/', slash + 1))
            groups.insert(path.substr(0, slash));
    }
    return std::any_of(groups.begin(), groups.end(), [&](auto group) { return taken.contains(group); });
}

}  // namespace

std::size_t vertex_slots(const ItemRecord& item) {
    if (!item.points.empty()) return item.points.size();
    return item.source_vertex.empty() ? static_cast<std::size_t>(item.vertices) : item.source_vertex.size();
}

void require_valid(const ItemRecord& item) {
    const std::size_t slots = vertex_slots(item);
    const bool name_ok = !item.name.empty() && item.name != "." && item.name != ".." &&
                         item.name.find('/') == std::string::npos;
    require(name_ok, item.name, "a name is not empty and holds no slash");
    require(item.vertices >= 0 && static_cast<std::size_t>(item.vertices) <= slots, item.name,
            "more vertices than points");
    require(item.triangles.size() == static_cast<std::size_t>(item.faces), item.name,
            "faces is not the number of triangles");
    require(all_below(item.triangles, slots), item.name, "a triangle names a vertex that does not exist");
    require(item.source_vertex.empty() || item.source_vertex.size() == slots, item.name,
            "source_vertex has not V values");
    if (!item.points.empty()) return;
    require(item.twin.size() == 3 * item.triangles.size() && item.edge_length.size() == item.twin.size(),
            item.name, "an intrinsic surface needs 3F twins and edge lengths");
}

void require_valid(const SweepBlock& block, std::size_t vertex_count, const StatusNames& status) {
    const auto converged = converged_status(status);
    for (const SweepRow& row : block.rows) {
        require(row.vertex >= 0 && static_cast<std::size_t>(row.vertex) < vertex_count, block.item,
                "a row's vertex does not exist");
        require(row.status < status.names.size(), block.item, "a row's status has no name");
        require(row.status != converged || std::isfinite(row.area_distortion), block.item,
                "a converged row has no finite area distortion");
    }
    for (const KeptFactor& factor : block.kept) {
        require(factor.conformal_factor.size() == vertex_count, block.item,
                "a conformal factor has not V values");
        const auto row = std::find_if(block.rows.begin(), block.rows.end(),
                                      [&](const SweepRow& r) { return r.vertex == factor.vertex; });
        require(row != block.rows.end(), block.item, "a conformal factor belongs to no row of its block");
        require(row->status == converged && row->area_distortion == factor.area_distortion, block.item,
                "a conformal factor's row did not converge, or to another area distortion");
    }
}

void require_valid(const FlowRecord& flow, std::size_t vertex_count, const StatusNames& status) {
    require(flow.status < status.names.size(), flow.item, "the flow's status has no name");
    const auto fits = [&](const std::vector<double>& values) { return values.size() == vertex_count; };
    require(fits(flow.conformal_factor) && fits(flow.target_curvature) && fits(flow.curvature), flow.item,
            "a field of the flow has not V values");
    require(flow.conformal_factor_low.empty() || fits(flow.conformal_factor_low), flow.item,
            "conformal_factor_low has not V values");
    const std::size_t halfedges = 3 * flow.triangles.size();
    require(flow.twin.size() == halfedges && flow.edge_length.size() == halfedges, flow.item,
            "the flow's triangulation has not 3F twins and edge lengths");
    const std::size_t steps = flow.log_residual_max.size();
    require(
        flow.log_step.size() == steps && flow.log_seconds.size() == steps && flow.log_flips.size() == steps,
        flow.item, "the columns of the flow's log differ in length");
}

void require_valid(const ResultGroup& result, const StatusNames& status) {
    require(identifier(result.kind) && !taken_kind(result.kind), result.item,
            "the kind of a result is a lower-case identifier with no other meaning");
    const std::string where = result.item + "/" + result.kind;
    require(result.status < status.names.size(), where, "the status has no name");
    std::set<std::string_view> names;
    for (const ResultAttribute& attribute : result.attributes) {
        require(identifier(attribute.name) && !taken_attribute(attribute.name), where + ": " + attribute.name,
                "the name of an attribute is a lower-case identifier with no other meaning");
        require(names.insert(attribute.name).second, where + ": " + attribute.name,
                "an attribute comes twice");
    }
    for (const ResultArray& array : result.arrays) {
        const std::string path = where + "/" + array.path;
        require(path_of_identifiers(array.path), path,
                "a path is lower-case identifiers with slashes between");
        require(array.shape.size() <= kMaximalRank, path, "an array has at most 32 axes");
        const std::size_t count = std::visit([](const auto& values) { return values.size(); }, array.values);
        require(fills(array.shape, count), path, "the values do not fill the shape");
    }
    require(!clash(result.arrays), where, "two arrays, or an array and a subgroup, have one path");
}

std::optional<std::uint8_t> converged_status(const StatusNames& status) {
    const auto found = std::find(status.names.begin(), status.names.end(), "converged");
    if (found == status.names.end()) return std::nullopt;
    return static_cast<std::uint8_t>(found - status.names.begin());
}

}  // namespace ricci::schema
