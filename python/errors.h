#pragma once

#include <pybind11/pybind11.h>

namespace umtet::python {

/// The exceptions of the module, MeshingError, ReconstructionError and Cancelled, and what is thrown in C++ as one of
/// them or of Python's own.
void register_errors(pybind11::module_& m);

}  // namespace umtet::python
