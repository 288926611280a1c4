// The parts of the extension module ricci._core, one per topic. The package beside them gives it its form;
// nobody else imports it.
#pragma once

#include <pybind11/pybind11.h>

namespace ricci::python {

void add_errors(pybind11::module_& m);
void add_options(pybind11::module_& m);
void add_surfaces(pybind11::module_& m);
void add_stored(pybind11::module_& m);
void add_solves(pybind11::module_& m);
void add_sweeps(pybind11::module_& m);
void add_files(pybind11::module_& m);
void add_index(pybind11::module_& m);

}  // namespace ricci::python
