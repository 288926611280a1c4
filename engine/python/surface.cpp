#include "engine/python/surface.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <charconv>
#include <span>

#include "engine/app/records.h"
#include "engine/python/array_views.h"
#include "engine/python/bindings.h"
#include "engine/python/long_call.h"
#include "engine/surfaces/generate.h"

namespace py = pybind11;

namespace ricci {

// A bound function's own argument types; std::array rows of NumPy arrays are read in place.
static_assert(sizeof(Point) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(Index));

namespace python {
namespace {

using PointArray = py::array_t<double, py::array::c_style>;
using TriangleArray = py::array_t<Index, py::array::c_style>;

std::span<const Point> rows_of(const PointArray& points) {
    return {reinterpret_cast<const Point*>(points.data()), static_cast<std::size_t>(points.shape(0))};
}

std::span<const Triangle> rows_of(const TriangleArray& triangles) {
    return {reinterpret_cast<const Triangle*>(triangles.data()),
            static_cast<std::size_t>(triangles.shape(0))};
}

py::tuple to_python(const Defect& d) {
    return py::make_tuple(d.code, d.element, d.index, d.message);
}

py::list to_python(const std::vector<Defect>& defects) {
    py::list list;
    for (const Defect& d : defects) list.append(to_python(d));
    return list;
}

/// Every component as a surface of its own, with the names of the command line: (surfaces, notes, errors).
py::tuple components_of(LoadedMesh loaded, const std::string& source) {
    py::list surfaces;
    const std::size_t count = loaded.components.size();
    for (std::size_t c = 0; c < count; ++c) {
        auto one = std::make_shared<LoadedMesh>();
        one->report = loaded.report;
        one->stem = count == 1 ? loaded.stem : fmt::format("{}.c{}", loaded.stem, c);
        one->content_hash = loaded.content_hash;
        one->components.push_back(std::move(loaded.components[c]));
        surfaces.append(py::cast(std::make_shared<Surface>(Surface{std::move(one), source})));
    }
    return py::make_tuple(surfaces, to_python(loaded.report.notes), to_python(loaded.report.errors));
}

py::tuple from_arrays(const PointArray& points, const TriangleArray& triangles, const std::string& name,
                      const std::string& repair) {
    const RepairOptions options = parse_repair(repair);
    const std::span<const Point> p = rows_of(points);
    const std::span<const Triangle> t = rows_of(triangles);
    return components_of(run_long(py::none(), [&](Call&) { return check_mesh(name, p, t, options); }), "");
}

py::tuple load(const std::string& path, const std::string& repair) {
    const RepairOptions options = parse_repair(repair);
    return components_of(run_long(py::none(), [&](Call&) { return load_mesh(path, options); }), path);
}

std::shared_ptr<Surface> from_mesh(SurfaceMesh mesh, const std::string& name) {
    auto loaded = std::make_shared<LoadedMesh>();
    loaded->stem = loaded->report.file = name;
    loaded->content_hash = mesh_hash(mesh.points, triangles_of(mesh.connectivity));
    loaded->components.push_back(std::move(mesh));
    return std::make_shared<Surface>(Surface{std::move(loaded), ""});
}

std::shared_ptr<Surface> generated(const std::string& name, const GenerateOptions& options) {
    return from_mesh(run_long(py::none(), [&](Call&) { return generate(name, options); }), name);
}

py::dict topology(const Surface& surface) {
    const Topology t = topology_of(surface.mesh().connectivity);
    py::dict d;
    d["vertices"] = t.vertices;
    d["edges"] = t.edges;
    d["faces"] = t.faces;
    d["boundaries"] = t.boundaries;
    d["genus"] = t.genus;
    d["euler_characteristic"] = t.euler_characteristic;
    return d;
}

py::object points(const py::object& self) {
    const SurfaceMesh& mesh = self.cast<const Surface&>().mesh();
    return mesh.intrinsic() ? py::object(py::none()) : view_of(mesh.points, self);
}

py::array triangles(const py::object& self) {
    const std::vector<Index>& tail = self.cast<const Surface&>().mesh().connectivity.tail;
    return view_of(tail.data(), {static_cast<py::ssize_t>(tail.size() / 3), 3}, {}, self);
}

template <auto member>
py::array connectivity_array(const py::object& self) {
    return view_of(self.cast<const Surface&>().mesh().connectivity.*member, self);
}

template <auto member>
py::array mesh_array(const py::object& self) {
    return view_of(self.cast<const Surface&>().mesh().*member, self);
}

}  // namespace

ItemRecord item_of(const Surface& surface, const SurfaceMesh& mesh) {
    return app::make_item(app::item_name(surface.loaded->stem, mesh.connectivity.face_count()),
                          surface.source, surface.loaded->content_hash, mesh);
}

Surface surface_of_item(const ItemRecord& item) {
    auto loaded = std::make_shared<LoadedMesh>();
    loaded->components.push_back(app::surface_of(item));
    loaded->components.front().input_vertex = item.source_vertex;
    loaded->stem = loaded->report.file = item.name.substr(0, item.name.rfind('@'));
    const std::string& hash = item.source_hash;
    std::from_chars(hash.data(), hash.data() + hash.size(), loaded->content_hash, 16);
    return {std::move(loaded), item.source};
}

app::SweepSource source_of(const Surface& surface) {
    return {surface.source, "", surface.loaded};
}

void add_surfaces(py::module_& m) {
    py::class_<Surface, std::shared_ptr<Surface>>(m, "Surface")
        .def_property_readonly("points", &points)
        .def_property_readonly("triangles", &triangles)
        .def_property_readonly("twin", &connectivity_array<&Connectivity::twin>)
        .def_property_readonly("edge_length", &mesh_array<&SurfaceMesh::edge_length>)
        .def_property_readonly("input_vertex", &mesh_array<&SurfaceMesh::input_vertex>)
        .def_property_readonly("intrinsic", [](const Surface& s) { return s.mesh().intrinsic(); })
        .def_property_readonly("name", [](const Surface& s) { return s.loaded->stem; })
        .def_property_readonly("source", [](const Surface& s) { return s.source; })
        .def_property_readonly("hash", [](const Surface& s) { return s.loaded->content_hash; })
        .def_property_readonly("notes", [](const Surface& s) { return to_python(s.loaded->report.notes); })
        .def("topology", &topology)
        .def("matches",
             [](const Surface& s, const PointArray& p, const TriangleArray& t) {
                 return mesh_hash(rows_of(p), rows_of(t)) == s.loaded->content_hash;
             })
        .def("save", [](const Surface& s, const std::string& path) {
            run_call(py::none(), [&](Call&) { save_mesh(path, s.mesh()); });
        });
    m.def("from_arrays", &from_arrays, py::arg("points").noconvert(), py::arg("triangles").noconvert(),
          py::arg("name"), py::arg("repair"));
    m.def("load", &load, py::arg("path"), py::arg("repair"));
    py::class_<GenerateOptions>(m, "GenerateOptions")
        .def(py::init<>())
        .def_readwrite("faces", &GenerateOptions::faces)
        .def_readwrite("major", &GenerateOptions::major_radius)
        .def_readwrite("minor", &GenerateOptions::minor_radius)
        .def_readwrite("semi_axes", &GenerateOptions::semi_axes)
        .def_readwrite("genus", &GenerateOptions::genus)
        .def_readwrite("height", &GenerateOptions::height)
        .def_readwrite("seed", &GenerateOptions::seed)
        .def_readwrite("jitter", &GenerateOptions::jitter);
    m.def("generate", &generated, py::arg("name"), py::arg("options"));
    m.def("generators", [] {
        py::dict names;
        for (const GeneratorInfo& info : generators()) names[py::str(info.name)] = info.description;
        return names;
    });
    m.def("set_max_unpacked", &set_max_unpacked, py::arg("bytes"));
}

}  // namespace python
}  // namespace ricci
