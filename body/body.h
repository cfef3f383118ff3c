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

/// A body: the level set psi that is meshed, the box that contains it, and the samples that a mesh is judged against.
/// All lengths and places are in working coordinates: model coordinates minus `shift`.
struct Domain {
  std::optional<SharedFunction> formula;  ///< with a Hessian; one of these four is there
  std::shared_ptr<const GridLevelSet> grid;
  std::optional<LevelSet> level_set;            ///< psi; cut where limit_detail() said
  std::optional<ImplicitFunctionRef> function;  ///< the caller's, who keeps it; with a Hessian
  std::optional<FittedLevelSet> fitted;         ///< level_set with all its levels
  Box box;                                      ///< what the background mesh has to cover
  double diagonal = 0;                          ///< of the cloud's box, or of `box` for a formula
  Vec3 shift = Vec3::Zero();
  std::vector<Message> notices;                     ///< of how psi was made, for the user
  OrientedPointCloud cloud;                         ///< empty for a formula
  std::shared_ptr<const GivenTriangles> triangles;  ///< that bound the body; none of a cloud or a formula
  std::shared_ptr<const LabelVolume> labels;        ///< the voxels that `grid` was made of; none of a field
  double cloud_spacing = 0;                         ///< median distance between neighbouring samples, 0 for a formula
  std::optional<double> noise;  ///< standard deviation of the samples along the normal, as the fit took it, model units
  std::optional<InputFacts> facts;  ///< of the cloud; none for a formula or a grid
  double level_shift = 0;           ///< taken off the fitted psi wherever it is cut for an h, model units
  bool complement =
      false;  ///< MeshOptions::complement: it is {psi > 0} in the box that is meshed, the fluid around a body

  /// Cuts psi at the detail that a mesh of edge length h can show: boundary faces fold over what is finer.
  void limit_detail(double h);
  /// Takes this off the psi that was cut last, and off every one that will be; 0: nothing. \pre fitted
  void shift_level(double by, double h);

  /// A bound of |grad psi|: a fitted psi has gradients of length one at its samples, and hardly longer ones anywhere; a
  /// formula may have any.
  double steepest() const { return level_set ? 2 : std::numeric_limits<double>::infinity(); }

  bool has_samples() const { return !cloud.points.empty(); }

  /// Volume and area of what is meshed, measured at the first call: an estimate, whatever detail is cut.
  const BodySize& size() const;

  /// Negative in the body.
  ImplicitFunctionRef body() const {
    if (function) return *function;
    if (grid) return *grid;
    return formula ? formula->ref() : ImplicitFunctionRef(*level_set);
  }
  /// f(psi): psi() for places that are far apart (LevelSetApart).
  template <class F>
  auto with_psi_apart(const F& f) const {
    if (function || grid || formula || complement) return f(psi());
    const LevelSetApart apart(*level_set);
    return f(ImplicitFunctionRef(apart));
  }
  /// Negative in what is meshed. Valid while this domain stays where it is.
  ImplicitFunctionRef psi() const;
  /// The same: a domain is an ImplicitFunction. `gradient` and `hessian` may be null.
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;
  double value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }
  void values(std::span<const Vec3> x, double* out) const;
  const SideBySide* side_by_side() const { return body().side_by_side(); }

 private:
  mutable std::optional<std::pair<Box, BodySize>> size_;  ///< of psi in that box
};

}  // namespace umtet
