#pragma once

#include <pybind11/pybind11.h>

namespace umtet::python {

/// Adds mesh_regions() and the class of its results.
void bind_regions(pybind11::module_& m);

}  // namespace umtet::python
