// Options as the command line has them: structs with the same names and defaults, filled by the package.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "engine/app/index_config.h"
#include "engine/app/solve_arguments.h"
#include "engine/app/sweep_config.h"
#include "engine/python/bindings.h"

namespace py = pybind11;

namespace ricci::python {

using app::IndexConfig;
using app::SolveArguments;
using app::SweepConfig;

void add_options(py::module_& m) {
    py::class_<SolveArguments>(m, "SolveOptions")
        .def(py::init<>())
        .def_readwrite("mesh", &SolveArguments::mesh)
        .def_readwrite("repair", &SolveArguments::repair)
        .def_readwrite("geometry", &SolveArguments::geometry)
        .def_readwrite("scheme", &SolveArguments::scheme)
        .def_readwrite("method", &SolveArguments::method)
        .def_readwrite("sphere", &SolveArguments::sphere)
        .def_readwrite("precision", &SolveArguments::precision)
        .def_readwrite("target", &SolveArguments::target)
        .def_readwrite("boundary", &SolveArguments::boundary)
        .def_readwrite("delaunay", &SolveArguments::delaunay)
        .def_readwrite("cones", &SolveArguments::cones)
        .def_readwrite("tolerance", &SolveArguments::tolerance)
        .def_readwrite("timeout", &SolveArguments::timeout)
        .def_readwrite("max_iterations", &SolveArguments::max_iterations)
        .def_readwrite("densify", &SolveArguments::densify);
    py::class_<SweepConfig>(m, "SweepOptions")
        .def(py::init<>())
        .def_readwrite("meshes", &SweepConfig::meshes)
        .def_readwrite("repair", &SweepConfig::repair)
        .def_readwrite("component", &SweepConfig::component)
        .def_readwrite("scheme", &SweepConfig::scheme)
        .def_readwrite("boundary", &SweepConfig::boundary)
        .def_readwrite("cone_curvature", &SweepConfig::cone_curvature)
        .def_readwrite("delaunay", &SweepConfig::delaunay)
        .def_readwrite("tolerance", &SweepConfig::tolerance)
        .def_readwrite("max_iterations", &SweepConfig::max_iterations)
        .def_readwrite("densify", &SweepConfig::densify)
        .def_readwrite("solver", &SweepConfig::solver)
        .def_readwrite("precision", &SweepConfig::precision)
        .def_readwrite("vertices", &SweepConfig::vertices)
        .def_readwrite("resolutions", &SweepConfig::resolutions)
        .def_readwrite("keep", &SweepConfig::keep)
        .def_readwrite("output", &SweepConfig::output)
        .def_readwrite("shard", &SweepConfig::shard)
        .def_readwrite("threads", &SweepConfig::threads)
        .def_readwrite("lanes", &SweepConfig::lanes)
        .def_readwrite("max_memory", &SweepConfig::max_memory)
        .def_readwrite("timeout", &SweepConfig::timeout)
        .def_readwrite("isolate", &SweepConfig::isolate)
        .def_readwrite("resume", &SweepConfig::resume)
        .def_readwrite("retry_failed", &SweepConfig::retry_failed);
    m.def("read_sweep_config", &app::read_sweep_config, py::arg("path"));
    py::class_<IndexConfig>(m, "IndexOptions")
        .def(py::init<>())
        .def_readwrite("repair", &IndexConfig::repair)
        .def_readwrite("scheme", &IndexConfig::scheme)
        .def_readwrite("delaunay", &IndexConfig::delaunay)
        .def_readwrite("tolerance", &IndexConfig::tolerance)
        .def_readwrite("max_iterations", &IndexConfig::max_iterations)
        .def_readwrite("max_length", &IndexConfig::max_length)
        .def_readwrite("count", &IndexConfig::count)
        .def_readwrite("coordinates", &IndexConfig::coordinates)
        .def_readwrite("fingerprint", &IndexConfig::fingerprint)
        .def_readwrite("resolutions", &IndexConfig::resolutions)
        .def_readwrite("timeout", &IndexConfig::timeout);
}

}  // namespace ricci::python
