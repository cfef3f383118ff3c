#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "mesh/core/piecewise_domain.h"
#include "mesh/core/polyline.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// A piece of the boundary of a piecewise smooth domain: a patch, a curve where two patches meet, or a corner where
/// three or more do. A vertex on it satisfies one equation for each patch, and has the other directions free. The patch
/// on both sides of a curve may be the same one.
struct Stratum {
  /// An end of a curve, beyond which a vertex must not slide.
  struct End {
    Vec3 place;
    Vec3 tangent;   ///< unit vector into the curve
    double within;  ///< distance from the end in which the tangent describes the curve, model units
  };

  int dimension = 2;  ///< degrees of freedom: 2 on a patch, 1 on a curve, 0 at a corner
  /// Ascending. More than two on a curve: any two describe it. Empty: the surface psi = 0 as a whole, where no patch is
  /// known.
  std::vector<int> patches;
  Vec3 place = Vec3::Zero();  ///< position of a corner
  std::vector<End> ends;      ///< ends of a curve that is not closed
  /// The polyline of a curve that is known as one: its vertices are on it, and the patches are not evaluated. Else
  /// null.
  std::shared_ptr<const Polyline> course = nullptr;
  /// The border of a patch whose curves are known as polylines. No value: the border is not known.
  std::optional<std::vector<std::shared_ptr<const Polyline>>> border = std::nullopt;
};

/// The free directions of a boundary vertex.
struct FreeDirections {
  int n = 0;                                                                   ///< columns that are set
  Eigen::Matrix<double, 3, 2> tangents = Eigen::Matrix<double, 3, 2>::Zero();  ///< orthonormal
};

/// A ball around a point of a patch. The part of the patch inside of the ball is far from the border of the patch.
struct BallOnPatch {
  Vec3 centre = Vec3::Zero();
  double radius = -1;  ///< model units; 0 where nothing is known, negative where nobody has asked
};

/// The strata of a boundary, and the moves of vertices on them. Thread-safe if the domain is.
class BoundaryStrata {
 public:
  /// @param domain  must outlive this
  BoundaryStrata(const PiecewiseDomain& domain, std::vector<Stratum> strata)
      : domain_(&domain), strata_(std::move(strata)) {}

  const PiecewiseDomain& domain() const { return *domain_; }
  std::size_t size() const { return strata_.size(); }
  const Stratum& operator[](int stratum) const { return strata_[stratum]; }

  /// The directions in which a vertex at x may move on its stratum. Fewer than its dimension where gradients vanish or
  /// are parallel.
  FreeDirections directions(int stratum, const Vec3& x) const;
  /// Newton's method from x to the stratum, with the shortest steps: f_p = 0 for its patches.
  /// @param h     edge length: a step is at most h, and the result is within 1e-10 h of each zero set
  /// @param place receives the point
  /// @param ball  null, or ball_on_patch() of this stratum: psi is not evaluated where the foot is in the ball
  /// @return whether the method converged within 2 h, at a point of the boundary; on a curve, between its ends
  bool foot(int stratum, const Vec3& x, double h, Vec3& place, const BallOnPatch* ball = nullptr) const;
  /// The ball around a point of a patch whose radius is half of the distance to the border of the patch. The zero set
  /// of the patch passes no border in the ball, so that a foot there is on the boundary, as x is. The radius is 0 where
  /// x is not on the boundary, the stratum is no patch, or its border is not known.
  /// @param h  edge length, as that of foot()
  BallOnPatch ball_on_patch(int stratum, const Vec3& x, double h) const;
  /// Distance of x from the stratum by its equations to first order, or from its place or course, model units.
  double distance(int stratum, const Vec3& x) const;
  /// The value of a patch (-1: of psi as a whole), oriented so that it is negative inside.
  double value(int patch, const Vec3& x, Vec3* gradient) const;

  /// The patch of a boundary face with corners of these strata: their only common patch, -1 if one of them belongs to
  /// no patch, and -2 if no patch or several are common to all.
  int patch_of(int a, int b, int c) const;
  /// Whether stratum a is b or a part of its border: a vertex on b may collapse into one on a.
  bool is_in_closure(int a, int b) const;

 private:
  /// The function of a patch, divided by the norm of its gradient.
  struct UnitPatch {
    double value;
    Vec3 gradient;  ///< unit vector; not finite where there is none
  };
  std::pair<UnitPatch, UnitPatch> steepest_pair(const Stratum& s, const Vec3& x) const;

  const PiecewiseDomain* domain_;
  std::vector<Stratum> strata_;
};

}  // namespace umtet
