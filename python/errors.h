#pragma once

#include <pybind11/pybind11.h>

namespace umtet::python {

/// Registers the exceptions of the module, MeshingError, ReconstructionError and Cancelled, and the translation of C++
/// exceptions to these or to Python's own.
void register_errors(pybind11::module_& m);

}  // namespace umtet::python
