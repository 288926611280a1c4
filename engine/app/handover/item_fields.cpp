#include "engine/app/handover/item_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "engine/app/result_values.h"
#include "engine/app/stored_arrays.h"

namespace ricci::app {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

/// A column of the sweep's rows by vertex.
template <class Value>
DataArray column(const StoredSweep& sweep, std::size_t vertices, const char* name, const char* unit,
                 Value value) {
    std::vector<double> values(vertices, kNone);
    for (const SweepRow& row : sweep.rows) values[at(row.vertex)] = static_cast<double>(value(row));
    return {name, unit, 1, std::move(values)};
}

void add_sweep(const StoredSweep& sweep, std::size_t vertices, std::vector<DataArray>& fields) {
    const auto add = [&](const char* name, const char* unit, auto value) {
        fields.push_back(column(sweep, vertices, name, unit, value));
    };
    add("area_distortion", "1", [](const SweepRow& r) { return r.area_distortion; });
    add("newton_iterations", "1", [](const SweepRow& r) { return r.newton_iterations; });
    add("residual_max", "rad", [](const SweepRow& r) { return r.residual_max; });
    add("flips", "1", [](const SweepRow& r) { return r.flips; });
    add("seconds", "s", [](const SweepRow& r) { return r.seconds; });
    add("gauss_bonnet_error", "rad", [](const SweepRow& r) { return r.gauss_bonnet_error; });
    add("precision_digits", "1", [](const SweepRow& r) { return r.precision_digits; });
    std::vector<std::int32_t> status(vertices, -1);
    for (const SweepRow& row : sweep.rows) status[at(row.vertex)] = row.status;
    fields.push_back({"status", "", 1, std::move(status)});
    for (const KeptFactor& kept : sweep.kept) {
        const bool best = kept.vertex == sweep.best, worst = kept.vertex == sweep.worst;
        if (best) fields.push_back({"best_conformal_factor", "1", 1, kept.conformal_factor});
        if (worst) fields.push_back({"worst_conformal_factor", "1", 1, kept.conformal_factor});
        if (!best && !worst)
            fields.push_back(
                {fmt::format("conformal_factor_of_vertex_{}", kept.vertex), "1", 1, kept.conformal_factor});
    }
}

/// The lowest chart of every face.
std::vector<std::int32_t> chart_of_faces(const ResultGroup& atlas, std::size_t faces) {
    const StoredArrays arrays(atlas);
    std::vector<std::int32_t> chart(faces, -1);
    const std::vector<std::vector<Index>> lists = arrays.lists("charts/face");
    for (std::size_t k = 0; k < lists.size(); ++k)
        for (const Index face : lists[k]) {
            arrays.require(face >= 0 && at(face) < faces, "a chart has a face that does not exist");
            if (chart[at(face)] < 0) chart[at(face)] = static_cast<std::int32_t>(k);
        }
    return chart;
}

/// Unit of a number that results carry as an attribute.
std::string attribute_unit(const std::string& name) {
    if (name == "residual_max" || name == "gauss_bonnet_error" || name == "angle") return "rad";
    if (name == "seconds") return "s";
    return "1";
}

/// One attribute as field data; those of 64 bits as doubles, which hold any count.
DataArray attribute_array(const std::string& kind, const ResultAttribute& attribute) {
    DataArray array;
    array.name = kind + "_" + attribute.name;
    std::visit(
        [&]<class T>(const T& value) {
            if constexpr (std::is_same_v<T, std::vector<std::string>>)
                array.values = value;
            else if constexpr (std::is_same_v<T, std::int64_t>)
                array.values = std::vector<double>{static_cast<double>(value)};
            else
                array.values = std::vector<T>{value};
        },
        attribute.value);
    if (!std::holds_alternative<std::vector<std::string>>(array.values))
        array.unit = attribute_unit(attribute.name);
    return array;
}

DataArray text(const char* name, const std::string& value) {
    return {name, "", 1, std::vector<std::string>{value}};
}

std::string status_name(const RunInfo& info, std::uint8_t status) {
    return status < info.status.names.size() ? info.status.names[status] : std::to_string(status);
}

void add_flow_data(const RunInfo& info, const FlowRecord& flow, std::vector<DataArray>& data) {
    data.push_back(text("flow_status", status_name(info, flow.status)));
    data.push_back(text("flow_geometry", flow.geometry));
    data.push_back(text("flow_scheme", flow.scheme));
    data.push_back(text("flow_boundary", flow.boundary));
    data.push_back({"flow_residual_max", "rad", 1, std::vector<double>{flow.residual_max}});
    data.push_back({"flow_gauss_bonnet_error", "rad", 1, std::vector<double>{flow.gauss_bonnet_error}});
    data.push_back({"flow_precision_digits", "1", 1, std::vector<std::int32_t>{flow.precision_digits}});
}

/// Arrays of a result that belong to the item as a whole.
void add_lists(const ResultGroup& group, std::vector<DataArray>& data) {
    struct Listed {
        const char *kind, *path, *name, *unit;
    };
    static constexpr Listed kListed[] = {
        {"spectrum", "length", "spectrum_length", "1"},
        {"spectrum", "power", "spectrum_power", "1"},
        {"spectrum", "geodesic", "spectrum_geodesic", ""},
        {"teichmuller", "coordinates", "teichmuller_coordinates", "1"},
        {"teichmuller", "names", "teichmuller_names", ""},
        {"teichmuller", "fenchel_nielsen/name", "fenchel_nielsen_name", ""},
        {"teichmuller", "fenchel_nielsen/length", "fenchel_nielsen_length", "1"},
        {"teichmuller", "fenchel_nielsen/twist", "fenchel_nielsen_twist", "1"}};
    for (const Listed& listed : kListed) {
        if (group.kind != listed.kind) continue;
        for (const ResultArray& array : group.arrays)
            if (array.path == listed.path)
                data.push_back(
                    {listed.name, listed.unit, 1,
                     std::visit([](const auto& v) { return decltype(DataArray::values)(v); }, array.values)});
    }
}

}  // namespace

std::size_t vertex_count(const StoredItem& stored) {
    const ItemRecord& item = stored.item;
    if (!item.points.empty()) return item.points.size();
    return item.source_vertex.empty() ? at(item.vertices) : item.source_vertex.size();
}

std::vector<DataArray> vertex_fields(const StoredItem& stored) {
    const std::size_t vertices = vertex_count(stored);
    std::vector<DataArray> fields;
    if (!stored.item.source_vertex.empty())
        fields.push_back({"source_vertex", "", 1, stored.item.source_vertex});
    if (stored.sweep) add_sweep(*stored.sweep, vertices, fields);
    if (!stored.flow) return fields;
    const FlowRecord& flow = *stored.flow;
    fields.push_back({"conformal_factor", "1", 1, flow.conformal_factor});
    if (!flow.conformal_factor_low.empty())
        fields.push_back({"conformal_factor_low", "1", 1, flow.conformal_factor_low});
    fields.push_back({"curvature", "rad", 1, flow.curvature});
    fields.push_back({"target_curvature", "rad", 1, flow.target_curvature});
    return fields;
}

std::vector<DataArray> face_fields(const StoredItem& stored) {
    const std::size_t faces = stored.item.triangles.size();
    std::vector<DataArray> fields;
    if (const ResultGroup* quality = result_of(stored, "quality")) {
        const StoredArrays arrays(*quality);
        fields.push_back({"image_area", "1", 1, arrays.list<double>("image_area", faces)});
        fields.push_back({"log_area_ratio", "1", 1, arrays.list<double>("log_area_ratio", faces)});
        fields.push_back({"face_angle_ratio", "1", 3, arrays.list<double>("face_angles/ratio", 3 * faces)});
        fields.push_back(
            {"face_angle_kind", "", 3, arrays.list<std::uint8_t>("face_angles/kind", 3 * faces)});
    }
    if (const ResultGroup* atlas = result_of(stored, "atlas"))
        fields.push_back({"chart", "", 1, chart_of_faces(*atlas, faces)});
    return fields;
}

std::vector<DataArray> item_data(const RunInfo& info, const StoredItem& stored) {
    const ItemRecord& item = stored.item;
    std::vector<DataArray> data = {text("item", item.name),
                                   text("source", item.source),
                                   text("source_hash", item.source_hash),
                                   text("software", "ricci " + info.software_version),
                                   text("git", info.git),
                                   text("command", info.command),
                                   text("created", info.created),
                                   {"genus", "1", 1, std::vector<std::int32_t>{item.genus}},
                                   {"boundaries", "1", 1, std::vector<std::int32_t>{item.boundaries}}};
    if (stored.sweep) {
        data.push_back({"status_names", "", 1, info.status.names});
        if (stored.sweep->best)
            data.push_back({"sweep_best_vertex", "", 1, std::vector<std::int32_t>{*stored.sweep->best}});
        if (stored.sweep->worst)
            data.push_back({"sweep_worst_vertex", "", 1, std::vector<std::int32_t>{*stored.sweep->worst}});
    }
    if (stored.flow) add_flow_data(info, *stored.flow, data);
    for (const ResultGroup& group : stored.results) {
        data.push_back(
            {group.kind + "_status", "", 1, std::vector<std::string>{status_name(info, group.status)}});
        for (const ResultAttribute& attribute : group.attributes)
            data.push_back(attribute_array(group.kind, attribute));
        add_lists(group, data);
    }
    return data;
}

std::string length_unit(const StoredItem& stored) {
    return stored.item.units.empty() ? "input unit" : stored.item.units;
}

}  // namespace ricci::app
