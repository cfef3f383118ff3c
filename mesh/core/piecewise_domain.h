#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "mesh/core/implicit_function.h"

namespace umtet {

/// A C2 function whose zero set contains a part of the boundary of a domain. It returns the value and writes the
/// gradient and the Hessian to pointers that are not null. It must be thread-safe.
using PatchFunction = std::function<double(const Vec3&, Vec3* gradient, Mat3* hessian)>;

/// The value of psi, and the patch whose function decides it.
struct ActivePatch {
  double value;
  int patch;
};
/// psi at a point, for patches whose signs alone do not decide on the region. It must be thread-safe.
using ActivePatchFunction = std::function<ActivePatch(const Vec3&)>;

/// A domain whose boundary is piecewise smooth.
///
/// The boundary consists of patches, each on the zero set of a C2 function f_p. The signs of all f_p at a point decide
/// on which side of the boundary it is. Here the decision is a tree of max and min over the patches:
///
///     psi = max(a, b): intersection,  psi = min(a, b): union,  -psi: complement;   inside where psi < 0
///
/// All code that looks for patches, curves and corners asks region() only: patch p is on the boundary at a point of
/// f_p = 0 where the sign of f_p changes the region; a curve f_p = f_q = 0 is sharp where both signs do. A domain with
/// more than two regions is the same notion with more values of region().
///
/// Patches of measured surfaces are valid only near their part of the boundary. Another function then decides which of
/// them is active at a point (of_patches()), and the curves and corners have to be known.
///
/// Models ImplicitFunction and JointlyEvaluated, with the derivatives of the active patch: psi is C2 except where two
/// patches are active.
class PiecewiseDomain {
 public:
  /// {f < 0}, a domain with one patch.
  explicit PiecewiseDomain(PatchFunction f);
  /// {f < 0} for any function with second derivatives, which is copied.
  template <TwiceDifferentiable F>
  static PiecewiseDomain of(F f) {
    return PiecewiseDomain(PatchFunction([f = std::move(f)](const Vec3& x, Vec3* g, Mat3* H) {
      if constexpr (JointlyEvaluated<F>) {
        return static_cast<double>(f.evaluate(x, g, H));
      } else {
        if (g) *g = f.gradient(x);
        if (H) *H = f.hessian(x);
        return static_cast<double>(f.value(x));
      }
    }));
  }

  /// A domain of patches whose functions are negative inside, with psi from another function.
  static PiecewiseDomain of_patches(std::vector<PatchFunction> patches, ActivePatchFunction psi);

  /// max(a, b). A patch of a copy of one domain in both operands is one patch.
  /// \pre decides_by_signs() of both, here and below
  /// \throw std::invalid_argument if a patch bounds the domain from both of its sides, as in max(f, -f)
  friend PiecewiseDomain intersection(const PiecewiseDomain& a, const PiecewiseDomain& b);
  /// min(a, b). \throw as intersection()
  friend PiecewiseDomain united(const PiecewiseDomain& a, const PiecewiseDomain& b);
  /// -a
  friend PiecewiseDomain complement(const PiecewiseDomain& a);

  int n_patches() const { return static_cast<int>(patches_.size()); }
  /// f_p, with derivatives where the pointers are not null.
  double patch(int p, const Vec3& x, Vec3* gradient = nullptr, Mat3* hessian = nullptr) const {
    return (*patches_[p])(x, gradient, hessian);
  }
  /// 1 if f_p is negative on the inside, -1 if it is positive there.
  int side(int p) const { return side_[p]; }
  /// Whether the signs of all patches decide on the region: not for a domain of of_patches().
  bool decides_by_signs() const { return !active_; }
  /// The region of a point where f_p has these values, or values with these signs: 1 inside, 0 outside.
  /// \pre decides_by_signs()
  int region(std::span<const double> values) const { return psi_of(values).value < 0 ? 1 : 0; }
  /// The patch whose function decides psi at x.
  int active(const Vec3& x) const;

  double value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }
  Vec3 gradient(const Vec3& x) const;
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;

 private:
  struct Node {
    bool is_leaf, is_max;
    int patch;        ///< patch of a leaf
    int left, right;  ///< nodes before this one
  };
  PiecewiseDomain() = default;
  static PiecewiseDomain joined(const PiecewiseDomain& a, const PiecewiseDomain& b, bool is_max);
  ActivePatch psi_of(std::span<const double> values) const;
  ActivePatch psi_at(const Vec3& x) const;

  std::vector<std::shared_ptr<const PatchFunction>> patches_;
  std::vector<int> side_;
  std::vector<Node> nodes_;     ///< the last one is the root
  ActivePatchFunction active_;  ///< in the place of nodes; empty if signs decide
};

PiecewiseDomain intersection(const PiecewiseDomain& a, const PiecewiseDomain& b);
PiecewiseDomain united(const PiecewiseDomain& a, const PiecewiseDomain& b);
PiecewiseDomain complement(const PiecewiseDomain& a);

}  // namespace umtet
