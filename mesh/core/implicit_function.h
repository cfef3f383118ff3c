#pragma once

#include <concepts>
#include <cstddef>
#include <functional>
#include <span>

#include "common/vec3.h"

namespace umtet {

/// A function that computes value and derivatives together by evaluate(), which returns the value and writes the
/// gradient and the Hessian to pointers that are not null.
template <class F>
concept JointlyEvaluated = requires(const F f, const Vec3 x, Vec3* g, Mat3* H) {
  { f.evaluate(x, g, H) } -> std::convertible_to<double>;
};

/// Requirements on psi: Omega = {psi < 0}, psi C2 near the boundary             [Rangarajan2018, eq. (8)]
template <class F>
concept ImplicitFunction = JointlyEvaluated<F> || requires(const F f, const Vec3 x) {
  { f.value(x) } -> std::convertible_to<double>;
  { f.gradient(x) } -> std::convertible_to<Vec3>;
};

template <class F>
concept TwiceDifferentiable = JointlyEvaluated<F> ||(ImplicitFunction<F>&& requires(const F f, const Vec3 x) {
  { f.hessian(x) } -> std::convertible_to<Mat3>;
});

/// Runner of calls that evaluate psi side by side in one thread. A call that requests a value waits until all other
/// calls have requested one or have returned. One block of points then answers all requests.
class SideBySide {
 public:
  /// Calls f(i) for every i < n, in any order. \pre no call waits for another \throw any exception of f or psi
  virtual void for_each(std::size_t n, const std::function<void(std::size_t)>& f) const = 0;

 protected:
  ~SideBySide() = default;
};

/// A psi whose calls are so costly that it should be evaluated in blocks. values() sets out[i] = psi(x[i]), the same
/// numbers as single calls. side_by_side() may return null, which disables blocks.
template <class F>
concept AskedInBlocks = requires(const F f, std::span<const Vec3> x, double* out) {
  f.values(x, out);
  { f.side_by_side() } -> std::convertible_to<const SideBySide*>;
};

/// Non-owning reference to any ImplicitFunction, with one indirect call per evaluation. The function must outlive it.
/// Thread-safe if the function's const members are.
class ImplicitFunctionRef {
 public:
  template <ImplicitFunction F>
  requires(!std::same_as<F, ImplicitFunctionRef>) ImplicitFunctionRef(const F& f)
      : object_(&f), call_(&call<F>), has_hessian_(TwiceDifferentiable<F>) {
    if constexpr (AskedInBlocks<F>) side_by_side_ = f.side_by_side();
    if (side_by_side_) values_ = &values_of<F>;
  }

  double value(const Vec3& x) const { return call_(object_, x, nullptr, nullptr); }
  double value(const Vec3& x, Vec3& gradient) const { return call_(object_, x, &gradient, nullptr); }
  /// \pre has_hessian()
  double value(const Vec3& x, Vec3& gradient, Mat3& hessian) const { return call_(object_, x, &gradient, &hessian); }
  Vec3 gradient(const Vec3& x) const {
    Vec3 g;
    call_(object_, x, &g, nullptr);
    return g;
  }
  /// \pre has_hessian()
  Mat3 hessian(const Vec3& x) const {
    Vec3 g;
    Mat3 H;
    call_(object_, x, &g, &H);
    return H;
  }
  bool has_hessian() const { return has_hessian_; }

  /// Sets out[i] = psi(x[i]); a single call of the function if it is evaluated in blocks.
  void values(std::span<const Vec3> x, double* out) const {
    if (values_) return values_(object_, x, out);
    for (const Vec3& at : x) *out++ = value(at);
  }
  /// Null for a function that is not evaluated in blocks; loops over points then use threads (mesh/core/asking_psi.h).
  const SideBySide* side_by_side() const { return side_by_side_; }

 private:
  template <class F>
  static double call(const void* object, const Vec3& x, Vec3* g, Mat3* H) {
    const F& f = *static_cast<const F*>(object);
    if constexpr (JointlyEvaluated<F>) {
      return f.evaluate(x, g, H);
    } else {
      if (g) *g = f.gradient(x);
      if constexpr (TwiceDifferentiable<F>) {
        if (H) *H = f.hessian(x);
      }
      return f.value(x);
    }
  }

  template <class F>
  static void values_of(const void* object, std::span<const Vec3> x, double* out) {
    if constexpr (AskedInBlocks<F>) static_cast<const F*>(object)->values(x, out);
  }

  const void* object_;
  double (*call_)(const void*, const Vec3&, Vec3*, Mat3*);
  void (*values_)(const void*, std::span<const Vec3>, double*) = nullptr;
  const SideBySide* side_by_side_ = nullptr;
  bool has_hessian_;
};

/// -psi, the level set function of the complement of Omega. psi must outlive it.
template <ImplicitFunction F>
class Complement {
 public:
  explicit Complement(const F& psi) : psi_(psi) {}
  double value(const Vec3& x) const { return -ImplicitFunctionRef(psi_).value(x); }
  Vec3 gradient(const Vec3& x) const { return -ImplicitFunctionRef(psi_).gradient(x); }
  Mat3 hessian(const Vec3& x) const requires TwiceDifferentiable<F> { return -ImplicitFunctionRef(psi_).hessian(x); }
  double evaluate(const Vec3& x, Vec3* g, Mat3* H) const requires JointlyEvaluated<F> {
    const double value = psi_.evaluate(x, g, H);
    if (g) *g = -*g;
    if (H) *H = -*H;
    return -value;
  }
  void values(std::span<const Vec3> x, double* out) const {
    ImplicitFunctionRef(psi_).values(x, out);
    for (std::size_t i = 0; i < x.size(); ++i) out[i] = -out[i];
  }
  const SideBySide* side_by_side() const { return ImplicitFunctionRef(psi_).side_by_side(); }

 private:
  const F& psi_;
};

}  // namespace umtet
