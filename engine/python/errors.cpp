// Exceptions of the project as Python's.
#include <pybind11/pybind11.h>

#include <exception>

#include "engine/app/console.h"
#include "engine/flow/cancellation.h"
#include "engine/python/bindings.h"
#include "io/mesh/mesh_file.h"

namespace py = pybind11;

namespace ricci::python {

void add_errors(py::module_& /*m*/) {
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const app::UsageError& e) {
            PyErr_SetString(PyExc_ValueError, e.what());
        } catch (const FileError& e) {
            PyErr_SetString(py::module_::import("ricci._errors").attr("FileError").ptr(), e.what());
        } catch (const Cancelled&) {
            PyErr_SetNone(PyExc_KeyboardInterrupt);
        }
    });
}

}  // namespace ricci::python
