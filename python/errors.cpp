#include "python/errors.h"

#include <exception>
#include <string>
#include <system_error>

#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/parameters.h"
#include "pipeline/expression/expression.h"
#include "pipeline/memory/jobs.h"
#include "pipeline/memory/without_flags.h"
#include "python/arguments.h"
#include "reconstruct/io/grid_io.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/solve/solve_error.h"

namespace py = pybind11;

namespace umtet::python {
namespace {

/// With keyword arguments in the place of flags.
std::string in_python(const std::string& message) {
  return without_flags(message, [](const ParamField& field) { return field.key.substr(field.key.find('.') + 1); });
}

/// Raises `type` with an attribute `evidence`.
void raise(const py::handle& type, const char* message, const Json& evidence) {
  const py::object error = type(in_python(message));
  error.attr("evidence") = dict_of(evidence);
  PyErr_SetObject(type.ptr(), error.ptr());
}

}  // namespace

void register_errors(py::module_& m) {
  static py::exception<MeshingImpossible> meshing(m, "MeshingError", PyExc_RuntimeError);
  static py::exception<SolveError> reconstruction(m, "ReconstructionError", PyExc_RuntimeError);
  static py::exception<Cancelled> cancelled(m, "Cancelled", PyExc_RuntimeError);
  py::register_exception_translator([](std::exception_ptr error) {
    try {
      std::rethrow_exception(error);
    } catch (const MeshingFailed& e) {
      raise(meshing, e.what(), e.evidence);
    } catch (const MeshingImpossible& e) {
      raise(meshing, e.what(), Json::object());
    } catch (const ResourceLimit& e) {
      raise(meshing, e.what(), {{"status", "ResourceLimit"}});
    } catch (const SolveError& e) {
      raise(reconstruction, e.what(), {{"status", "SolveError"}});
    } catch (const SolveTooLarge& e) {
      raise(reconstruction, e.what(), {{"status", "SolveTooLarge"}});
    } catch (const GridRefused& e) {
      PyErr_SetString(PyExc_ValueError, e.what());
    } catch (const CloudRefused& e) {
      raise(reconstruction, e.what(), {{"status", "CloudRefused"}});
    } catch (const Cancelled& e) {
      cancelled(e.what());
    } catch (const UsageError& e) {
      PyErr_SetString(PyExc_ValueError, in_python(e.what()).c_str());
    } catch (const ExpressionError& e) {
      PyErr_SetString(PyExc_ValueError, in_python(e.what()).c_str());
    } catch (const MeshFileRefused& e) {
      PyErr_SetString(PyExc_ValueError, in_python(e.what()).c_str());
    } catch (const std::system_error& e) {
      PyErr_SetString(PyExc_OSError, e.what());
    }
  });
}

}  // namespace umtet::python
