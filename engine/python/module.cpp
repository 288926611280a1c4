// The extension module ricci._core.
#include <malloc.h>

#include <limits>

#include "engine/app/commands.h"
#include "engine/app/processor_kind.h"
#include "engine/app/version.h"
#include "engine/linear/symmetric_solver.h"
#include "engine/python/bindings.h"
#include "engine/python/long_call.h"
#include "kernels/parallel.h"

namespace py = pybind11;

namespace ricci::python {
namespace {

/// As the program does: factors come and go at every step, and handing their pages back to the system each
/// time costs more than the analysis. Process-wide; memory that is free stays with the process.
void keep_memory() {
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
}

}  // namespace
}  // namespace ricci::python

PYBIND11_MODULE(_core, m) {
    using namespace ricci;
    m.doc() = "Compiled part of ricci: use the package.";
    python::set_up_log();
    python::add_errors(m);
    python::add_options(m);
    python::add_surfaces(m);
    python::add_stored(m);
    python::add_solves(m);
    python::add_sweeps(m);
    python::add_files(m);
    python::add_index(m);
    m.def("version", &ricci_version);
    m.def("git", &ricci_git);
    m.def("solver", [] { return std::string(symmetric_solver_name()); });
    m.def("processor", &app::processor_kind);
    m.def("hardware_threads", &hardware_threads);
    m.def("blas_is_safe", &python::blas_is_safe);
    m.def("keep_memory", &python::keep_memory);
    m.def("set_command_line", [](const std::string& text) { app::command_line() = text; });
}
