#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "body/fitted_level_set.h"
#include "body/given_triangles.h"
#include "body/input_facts.h"
#include "body/shared_function.h"
#include "common/message.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"
#include "mesh/sizes/body_size.h"
#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/level_set/grid_fit.h"
#include "reconstruct/level_set/level_set.h"

namespace umtet {

struct LabelVolume;
struct PiecewiseBody;

/// A body: the level set psi that is meshed, the box that contains it, and the samples that a mesh is compared with.
/// All lengths and positions are in working coordinates, which are model coordinates minus `shift`.
struct Domain {
  std::optional<SharedFunction> formula;  ///< has a Hessian; exactly one of these four is set
  std::shared_ptr<const GridLevelSet> grid;
  std::optional<LevelSet> level_set;               ///< psi with the levels that limit_detail() keeps
  std::optional<ImplicitFunctionRef> function;     ///< function of the caller, who owns it; has a Hessian
  std::optional<FittedLevelSet> fitted;            ///< psi with all its levels
  std::shared_ptr<const PiecewiseBody> piecewise;  ///< patches whose psi is `formula`; null for a smooth body
  Box box;                                         ///< box that the background mesh must cover
  double diagonal = 0;                             ///< diagonal of the cloud's box, or of `box` for a formula
  Vec3 shift = Vec3::Zero();
  std::vector<Message> notices;                     ///< notices to the user about how psi was made
  OrientedPointCloud cloud;                         ///< empty for a formula
  std::shared_ptr<const GivenTriangles> triangles;  ///< triangles that bound the body; null for a cloud or a formula
  std::shared_ptr<const LabelVolume> labels;        ///< voxels from which `grid` was made; null for a field
  double cloud_spacing = 0;                         ///< median distance between neighbouring samples, 0 for a formula
  /// Standard deviation of the samples along the normal that the fit assumed, model units.
  std::optional<double> noise;
  std::optional<InputFacts> facts;  ///< facts about the cloud; empty for a formula or a grid
  double level_shift = 0;           ///< subtracted from the fitted psi whenever it is cut for an h, model units
  bool complement =
      false;  ///< MeshOptions::complement: {psi > 0} in the box is meshed, which is the fluid around a body

  /// Limits psi to the detail that a mesh of edge length h can resolve; boundary faces fold over finer detail.
  void limit_detail(double h);
  /// Subtracts `by` from psi, now (with the detail for h) and after every later call of limit_detail(); 0 restores psi.
  /// \pre fitted
  void shift_level(double by, double h);

  /// An upper bound of |grad psi|. A fitted psi has gradients of length one at its samples, and not much longer ones
  /// elsewhere. The gradient of a formula has no bound.
  double steepest() const {
    if (has_edges_of_triangles()) return 1;  // psi is a distance
    return level_set ? 2 : std::numeric_limits<double>::infinity();
  }

  /// The body is one of triangles with sharp edges, with a function for each smooth patch.
  bool has_edges_of_triangles() const { return piecewise && triangles; }

  bool has_samples() const { return !cloud.points.empty(); }

  /// Estimates of the volume and area of the meshed region. They are measured at the first call; later changes of the
  /// detail of psi do not change them.
  const BodySize& size() const;

  /// The function psi, negative in the body.
  ImplicitFunctionRef body() const {
    if (function) return *function;
    if (grid) return *grid;
    return formula ? formula->ref() : ImplicitFunctionRef(*level_set);
  }
  /// Returns f(psi), where psi is psi() in a form that is faster for points that are far apart (LevelSetApart).
  template <class F>
  auto with_psi_apart(const F& f) const {
    if (function || grid || formula || complement) return f(psi());
    const LevelSetApart apart(*level_set);
    return f(ImplicitFunctionRef(apart));
  }
  /// The function that is negative in the meshed region. Valid until this domain is moved or destroyed.
  ImplicitFunctionRef psi() const;
  /// Evaluates psi(): a domain is an ImplicitFunction. `gradient` and `hessian` may be null.
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;
  double value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }
  void values(std::span<const Vec3> x, double* out) const;
  const SideBySide* side_by_side() const { return body().side_by_side(); }

 private:
  mutable std::optional<std::pair<Box, BodySize>> size_;  ///< the box, and the size of the body in it
};

}  // namespace umtet
