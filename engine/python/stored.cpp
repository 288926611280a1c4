#include "engine/python/stored.h"

#include <pybind11/stl.h>

#include <algorithm>

#include "engine/app/export_item.h"
#include "engine/app/result_values.h"
#include "engine/app/sweep_config.h"
#include "engine/flow/status.h"
#include "engine/python/array_views.h"
#include "engine/python/bindings.h"
#include "engine/python/long_call.h"
#include "engine/python/surface.h"

namespace py = pybind11;

namespace ricci::python {
namespace {

std::string status_text(const Stored& stored, std::uint8_t status) {
    return stored.info->status.names.at(status);
}

py::object points(const py::object& self) {
    const ItemRecord& item = self.cast<const Stored&>().item.item;
    return item.points.empty() ? py::object(py::none()) : view_of(item.points, self);
}

py::dict counts(const Stored& stored) {
    const ItemRecord& item = stored.item.item;
    py::dict d;
    d["vertices"] = item.vertices;
    d["faces"] = item.faces;
    d["genus"] = item.genus;
    d["boundaries"] = item.boundaries;
    d["euler_characteristic"] = item.euler_characteristic;
    return d;
}

/// Columns of the sweep by the names of the file; None without one.
py::object sweep_columns(const py::object& self) {
    const auto& stored = self.cast<const Stored&>();
    if (!stored.item.sweep) return py::none();
    const std::vector<SweepRow>& rows = stored.item.sweep->rows;
    py::dict d;
    d["vertex"] = view_of(rows, &SweepRow::vertex, self);
    d["status_code"] = view_of(rows, &SweepRow::status, self);
    d["area_distortion"] = view_of(rows, &SweepRow::area_distortion, self);
    d["newton_iterations"] = view_of(rows, &SweepRow::newton_iterations, self);
    d["residual_max"] = view_of(rows, &SweepRow::residual_max, self);
    d["flips"] = view_of(rows, &SweepRow::flips, self);
    d["seconds"] = view_of(rows, &SweepRow::seconds, self);
    d["gauss_bonnet_error"] = view_of(rows, &SweepRow::gauss_bonnet_error, self);
    d["precision_digits"] = view_of(rows, &SweepRow::precision_digits, self);
    return d;
}

/// (vertex, area distortion, conformal factor) of all that are kept; (best vertex, worst vertex) or None
/// each.
py::tuple sweep_kept(const py::object& self) {
    const auto& stored = self.cast<const Stored&>();
    py::list list;
    if (!stored.item.sweep) return py::make_tuple(list, py::none(), py::none());
    for (const KeptFactor& k : stored.item.sweep->kept)
        list.append(py::make_tuple(k.vertex, k.area_distortion, view_of(k.conformal_factor, self)));
    return py::make_tuple(list, stored.item.sweep->best, stored.item.sweep->worst);
}

py::object flow_scalars(const Stored& stored) {
    if (!stored.item.flow) return py::none();
    const FlowRecord& f = *stored.item.flow;
    py::dict d;
    d["geometry"] = f.geometry;
    d["scheme"] = f.scheme;
    d["method"] = f.method;
    d["boundary"] = f.boundary;
    d["status"] = status_text(stored, f.status);
    d["newton_iterations"] = f.newton_iterations;
    d["flips"] = f.flips;
    d["residual_max"] = f.residual_max;
    d["gauss_bonnet_error"] = f.gauss_bonnet_error;
    d["seconds"] = f.seconds;
    d["precision_digits"] = f.precision_digits;
    d["doubled"] = f.doubled;
    return d;
}

py::object flow_arrays(const py::object& self) {
    const auto& stored = self.cast<const Stored&>();
    if (!stored.item.flow) return py::none();
    const FlowRecord& f = *stored.item.flow;
    py::dict d;
    d["conformal_factor"] = view_of(f.conformal_factor, self);
    d["conformal_factor_low"] = view_of(f.conformal_factor_low, self);
    d["target_curvature"] = view_of(f.target_curvature, self);
    d["curvature"] = view_of(f.curvature, self);
    d["triangles"] = view_of(f.triangles, self);
    d["twin"] = view_of(f.twin, self);
    d["edge_length"] = view_of(f.edge_length, self);
    d["log_residual_max"] = view_of(f.log_residual_max, self);
    d["log_step"] = view_of(f.log_step, self);
    d["log_flips"] = view_of(f.log_flips, self);
    d["log_seconds"] = view_of(f.log_seconds, self);
    return d;
}

std::vector<std::string> kinds(const Stored& stored) {
    std::vector<std::string> names;
    for (const ResultGroup& group : stored.item.results) names.push_back(group.kind);
    return names;
}

const ResultGroup& group_of(const Stored& stored, const std::string& kind) {
    const ResultGroup* group = app::result_of(stored.item, kind);
    if (group == nullptr) throw py::key_error(kind);
    return *group;
}

py::object array_of(const ResultArray& array, const py::object& self) {
    std::vector<py::ssize_t> shape;
    for (const std::uint64_t n : array.shape) shape.push_back(static_cast<py::ssize_t>(n));
    return std::visit(
        [&](const auto& values) -> py::object {
            using Values = std::decay_t<decltype(values)>;
            if constexpr (std::is_same_v<Values, std::vector<std::string>>)
                return py::cast(values);
            else
                return view_of(values.data(), shape, {}, self);
        },
        array.values);
}

/// (status, attributes, arrays) of a further result, arrays by their paths.
py::tuple result(const py::object& self, const std::string& kind) {
    const auto& stored = self.cast<const Stored&>();
    const ResultGroup& group = group_of(stored, kind);
    py::dict attributes, arrays;
    for (const ResultAttribute& a : group.attributes)
        attributes[py::str(a.name)] = std::visit([](const auto& value) { return py::cast(value); }, a.value);
    for (const ResultArray& a : group.arrays) arrays[py::str(a.path)] = array_of(a, self);
    return py::make_tuple(status_text(stored, group.status), attributes, arrays);
}

py::list failures(const std::vector<FailureRecord>& records) {
    py::list list;
    for (const FailureRecord& f : records) list.append(py::make_tuple(f.item, f.stage, f.status, f.message));
    return list;
}

py::dict info(const RunInfo& i) {
    py::dict d;
    d["software_version"] = i.software_version;
    d["git"] = i.git;
    d["command"] = i.command;
    d["config"] = i.config;
    d["host"] = i.host;
    d["threads"] = i.threads;
    d["created"] = i.created;
    return d;
}

void export_one(const Stored& stored, const std::string& path, const std::string& model,
                const std::string& picture, int checker, const std::vector<std::string>& what,
                const std::string& field) {
    app::ExportOptions options;
    options.model = model;
    options.picture = picture;
    options.handover.checker = checker;
    options.handover.what = what;
    options.handover.field = field;
    run_call(py::none(), [&](Call&) {
        const app::ExportOptions checked = app::checked_options(path, options);
        app::export_item(path, app::ItemSource(*stored.info, stored.item, checked.handover.blocks), checked);
    });
}

/// What the item's sweep was asked to keep: by the run's configuration, where it says, else by what is there.
KeepPolicy keep_of(const RunInfo& info, const StoredSweep& sweep) {
    try {
        return app::parse_keep(app::sweep_config_from_toml(info.config, "config").keep);
    } catch (const std::exception&) {
        const auto extremes = static_cast<std::int64_t>(sweep.best.has_value()) +
                              static_cast<std::int64_t>(sweep.worst.has_value() && sweep.worst != sweep.best);
        return {sweep.best.has_value(), sweep.worst.has_value(),
                std::max<std::int64_t>(0, static_cast<std::int64_t>(sweep.kept.size()) - extremes)};
    }
}

}  // namespace

Run run_of(StoredRun read) {
    Run run;
    run.info = std::make_shared<const RunInfo>(std::move(read.info));
    run.complete = read.complete;
    run.failures = std::move(read.failures);
    for (StoredItem& item : read.items) {
        auto stored = std::make_shared<Stored>();
        stored->item = std::move(item);
        stored->info = run.info;
        if (stored->item.sweep) stored->keep = keep_of(*run.info, *stored->item.sweep);
        for (const FailureRecord& f : run.failures)
            if (f.item == stored->item.item.name) stored->failures.push_back(f);
        run.items.push_back(std::move(stored));
    }
    return run;
}

void add_stored(py::module_& m) {
    py::class_<Stored, std::shared_ptr<Stored>>(m, "Stored")
        .def_property_readonly("name", [](const Stored& s) { return s.item.item.name; })
        .def_property_readonly("source", [](const Stored& s) { return s.item.item.source; })
        .def_property_readonly("source_hash", [](const Stored& s) { return s.item.item.source_hash; })
        .def_property_readonly("points", &points)
        .def_property_readonly("triangles",
                               [](const py::object& self) {
                                   return view_of(self.cast<const Stored&>().item.item.triangles, self);
                               })
        .def_property_readonly("source_vertex",
                               [](const py::object& self) {
                                   return view_of(self.cast<const Stored&>().item.item.source_vertex, self);
                               })
        .def_property_readonly("counts", &counts)
        .def_property_readonly(
            "surface",
            [](const Stored& s) { return std::make_shared<Surface>(surface_of_item(s.item.item)); })
        .def_property_readonly("sweep_columns", &sweep_columns)
        .def_property_readonly("sweep_kept", &sweep_kept)
        .def_property_readonly("flow_scalars", &flow_scalars)
        .def_property_readonly("flow_arrays", &flow_arrays)
        .def_property_readonly("kinds", &kinds)
        .def("result", &result, py::arg("kind"))
        .def_property_readonly("failures", [](const Stored& s) { return failures(s.failures); })
        .def_property_readonly("info", [](const Stored& s) { return info(*s.info); })
        .def_readonly("message", &Stored::message)
        .def_readonly("seconds", &Stored::seconds)
        .def_readonly("area", &Stored::area)
        .def_readonly("max_length_error", &Stored::max_length_error)
        .def_readonly("mean_length_error", &Stored::mean_length_error)
        .def("export", &export_one, py::arg("path"), py::arg("model"), py::arg("picture"), py::arg("checker"),
             py::arg("what"), py::arg("field"));
    py::class_<Run, std::shared_ptr<Run>>(m, "Run")
        .def_readonly("items", &Run::items)
        .def_readonly("complete", &Run::complete)
        .def_property_readonly("failures", [](const Run& r) { return failures(r.failures); })
        .def_property_readonly("info", [](const Run& r) { return info(*r.info); });
    py::list names;
    for (const std::string_view name : kStatusNames) names.append(std::string(name));
    m.attr("status_names") = py::tuple(names);
}

}  // namespace ricci::python
