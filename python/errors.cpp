#include "python/errors.h"

#include <exception>
#include <string>
#include <system_error>

#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/option_words.h"
#include "mesh/expression/expression.h"
#include "pipeline/memory/jobs.h"
#include "python/arguments.h"
#include "reconstruct/io/grid_io.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/solve/solve_error.h"

namespace py = pybind11;

namespace umtet::python {
namespace {

/// The message with keyword arguments in place of options.
std::string said(const ExplainedError& error) { return text_of(error.message, as_keyword); }

/// Raises `type` with an attribute `evidence`.
void raise(const py::handle& type, const std::string& message, const Json& evidence) {
  const py::object error = type(message);
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
      raise(meshing, said(e), Json::object());
    } catch (const ResourceLimit& e) {
      raise(meshing, said(e), {{"status", "ResourceLimit"}});
    } catch (const SolveError& e) {
      raise(reconstruction, e.what(), {{"status", "SolveError"}});
    } catch (const SolveTooLarge& e) {
      raise(reconstruction, said(e), {{"status", "SolveTooLarge"}});
    } catch (const GridRefused& e) {
      PyErr_SetString(PyExc_ValueError, said(e).c_str());
    } catch (const CloudRefused& e) {
      raise(reconstruction, said(e), {{"status", "CloudRefused"}});
    } catch (const Cancelled& e) {
      cancelled(e.what());
    } catch (const UsageError& e) {
      PyErr_SetString(PyExc_ValueError, said(e).c_str());
    } catch (const ExpressionError& e) {
      PyErr_SetString(PyExc_ValueError, e.what());
    } catch (const MeshFileRefused& e) {
      PyErr_SetString(PyExc_ValueError, e.what());
    } catch (const std::system_error& e) {
      PyErr_SetString(PyExc_OSError, e.what());
    }
  });
}

}  // namespace umtet::python
