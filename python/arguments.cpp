#include "python/arguments.h"

#include <chrono>
#include <cmath>

#include "body/piecewise_body.h"
#include "python/interruptible.h"

namespace umtet::python {
namespace py = pybind11;
namespace {

// Acquiring the GIL takes time; Ctrl-C may take a fifth of a second.
constexpr auto kPatience = std::chrono::milliseconds(20);

/// False of Python or of numpy, as comparisons give it.
bool says_stop(const py::object& answer) {
  py::detail::make_caster<bool> value;
  return value.load(answer, false) && !static_cast<bool>(value);
}

}  // namespace

Parameters parameters_of(const Settings& settings) {
  Parameters parameters;
  for (const auto& [key, text] : settings) parameters.set(key, text, ParamSource::Set, "python");
  return parameters;
}

Watch watch_of(const py::object& progress) {
  using Clock = std::chrono::steady_clock;
  return [progress = py::handle(progress), step = std::string(), next = Clock::time_point()](const char* name,
                                                                                             double fraction) mutable {
    const bool is_new = name && step != name;
    if (!is_new && Clock::now() < next) return;
    next = Clock::now() + kPatience;
    if (name) step = name;
    const py::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (progress.is_none() || !name) return;
    if (says_stop(progress(step, fraction))) throw Cancelled();
  };
}

Watch watch_in_thread(const py::object& progress, std::shared_ptr<std::atomic<bool>> stopped) {
  using Clock = std::chrono::steady_clock;
  return [progress = py::handle(progress), stopped = std::move(stopped), step = std::string(),
          next = Clock::time_point()](const char* name, double fraction) mutable {
    if (*stopped) throw Cancelled();
    const bool is_new = name && step != name;
    if (name) step = name;
    if (progress.is_none() || !name || (!is_new && Clock::now() < next)) return;
    next = Clock::now() + kPatience;
    const py::gil_scoped_acquire gil;
    if (*stopped) throw Cancelled();
    if (says_stop(progress(step, fraction))) throw Cancelled();
  };
}

std::vector<Vec3> vectors(const Points& a, const char* name) {
  if (a.ndim() != 2 || a.shape(1) != 3) throw std::invalid_argument(std::string(name) + " must be an array (n, 3)");
  std::vector<Vec3> out(static_cast<std::size_t>(a.shape(0)));
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = Eigen::Map<const Vec3>(a.data() + 3 * i);
  return out;
}

py::array_t<double> array(const std::vector<Vec3>& x, const Vec3& shift) {
  py::array_t<double> out({static_cast<py::ssize_t>(x.size()), py::ssize_t{3}});
  double* p = out.mutable_data();
  for (const Vec3& v : x) {
    for (int k = 0; k < 3; ++k) *p++ = v[k] + shift[k];
  }
  return out;
}

py::object dict_of(const Json& json) { return py::module_::import("json").attr("loads")(json.dump()); }

Psi psi_of(const py::object& psi, const std::optional<Box>& box, std::optional<double> t, int threads) {
  if (t && !std::isfinite(*t)) throw std::invalid_argument("t must be a finite number");
  if (py::isinstance<Reconstruction>(psi)) {
    return {nullptr, domain_of(psi.cast<const Reconstruction&>(), box), threads};
  }
  Psi out{nullptr, {}, threads};
  Domain& domain = out.domain;
  if (!box) throw std::invalid_argument("box is missing: (x0, y0, z0, x1, y1, z1) around the domain");
  domain.box = *box;
  domain.diagonal = box->diagonal().norm();
  if (py::isinstance<py::str>(psi)) {
    set_formula(domain, psi.cast<std::string>(), t);
    return out;
  }
  if (PyCallable_Check(psi.ptr()) == 0) throw py::type_error("psi must be a LevelSet, a formula or a callable");
  out.threads = 1;
  out.function = std::make_shared<Function>(psi, box->center(), domain.diagonal);
  domain.function.emplace(*out.function);
  return out;
}

}  // namespace umtet::python
