#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/memory/jobs.h"
#include "python/function.h"

// Conversion between arguments of Python and of the libraries.
namespace umtet::python {

using Points = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;
using Settings = std::vector<std::pair<std::string, std::string>>;  ///< key and text of a parameter

/// Parses settings. \throw UsageError
Parameters parameters_of(const Settings& settings);

/// A watch that checks for Ctrl-C and calls the callback, both at most every 20 ms.
/// @param progress  a callable (step, fraction), or None; it must outlive the watch
Watch watch_of(const pybind11::object& progress);

/// Runs f without the GIL. @param threads  0: all hardware threads
template <class F>
auto in_arena(int threads, const F& f) {
  const pybind11::gil_scoped_release no_gil;
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  return arena.execute(f);
}

/// Rows of an array (n, 3). \throw std::invalid_argument with its name
std::vector<Vec3> vectors(const Points& a, const char* name);

/// An array (n, 3) of x + shift.
pybind11::array_t<double> array(const std::vector<Vec3>& x, const Vec3& shift);

template <std::size_t n>
pybind11::array_t<int> array(const std::vector<std::array<int, n>>& rows) {
  pybind11::array_t<int> out({static_cast<pybind11::ssize_t>(rows.size()), static_cast<pybind11::ssize_t>(n)});
  int* p = out.mutable_data();
  for (const auto& row : rows) p = std::copy(row.begin(), row.end(), p);
  return out;
}

template <class T>
pybind11::array_t<T> array(const std::vector<T>& v) {
  return pybind11::array_t<T>(static_cast<pybind11::ssize_t>(v.size()), v.data());
}

/// A dict with the content of a JSON value.
pybind11::object dict_of(const Json& json);

/// The psi of a call, in any of its forms, as a domain. Keeps alive the objects that the domain refers to.
struct Psi {
  std::shared_ptr<Function> function;
  Domain domain;
  int threads;  ///< one for a callable, so that no thread waits for the GIL
};

/// Converts an argument to a psi.
/// @param psi  a Reconstruction, a formula (text) or a callable
/// @param box  model coordinates; a Reconstruction has its own
/// @param t    value of t in a formula
/// \throw std::invalid_argument, ExpressionError, and exceptions of the callable
Psi psi_of(const pybind11::object& psi, const std::optional<Box>& box, std::optional<double> t, int threads);

}  // namespace umtet::python
