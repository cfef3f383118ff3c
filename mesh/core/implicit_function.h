#pragma once

#include <concepts>

#include "common/vec3.h"

namespace umtet {

/// A function that shares work between its derivatives has evaluate(): value returned, gradient and Hessian written
/// where the pointers are not null.
template <class F>
concept JointlyEvaluated = requires(const F f, const Vec3 x, Vec3* g, Mat3* H) {
  { f.evaluate(x, g, H) } -> std::convertible_to<double>;
};

/// What the mesher needs of psi: Omega = {psi < 0}, psi C2 near the boundary     [Rangarajan2018, eq. (8)]
template <class F>
concept ImplicitFunction = JointlyEvaluated<F> || requires(const F f, const Vec3 x) {
  { f.value(x) } -> std::convertible_to<double>;
  { f.gradient(x) } -> std::convertible_to<Vec3>;
};

template <class F>
concept TwiceDifferentiable = JointlyEvaluated<F> ||(ImplicitFunction<F>&& requires(const F f, const Vec3 x) {
  { f.hessian(x) } -> std::convertible_to<Mat3>;
});

/// Non-owning view of any ImplicitFunction: two words, one indirect call per evaluation. The function must outlive it.
/// Thread-safe when the function's const members are.
class ImplicitFunctionRef {
 public:
  template <ImplicitFunction F>
  requires(!std::same_as<F, ImplicitFunctionRef>) ImplicitFunctionRef(const F& f)
      : object_(&f), call_(&call<F>), has_hessian_(TwiceDifferentiable<F>) {}

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

  const void* object_;
  double (*call_)(const void*, const Vec3&, Vec3*, Mat3*);
  bool has_hessian_;
};

/// -psi, the level set of the complement of Omega. psi must outlive it.
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

 private:
  const F& psi_;
};

}  // namespace umtet
