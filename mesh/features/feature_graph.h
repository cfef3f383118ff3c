#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/core/piecewise_domain.h"

namespace umtet {

/// A point where three or more patches meet, or where a curve changes from sharp to smooth.
struct FeatureCorner {
  Vec3 place;
  std::vector<int> patches;  ///< ascending
};

/// A curve f_p = f_q = 0 on the boundary of a domain, where the boundary has an edge.
struct FeatureCurve {
  std::array<int, 2> patches;          ///< p < q; p = q for a given curve inside of a patch
  std::array<int, 2> ends = {-1, -1};  ///< corners at the first and the last point; -1 for a closed curve
  std::vector<Vec3> points;            ///< on the curve; the first is repeated at the end of a closed curve
  std::vector<double> arc;             ///< arc length at the points, from 0
  std::vector<double> angle_deg;       ///< dihedral angle of the domain at the points, in (0, 360)
  /// The curve is the polyline of the points, instead of the common zeros of its patches near them.
  bool is_given = false;
  bool is_closed() const { return ends[0] < 0; }
  double length() const { return arc.back(); }

  /// Position on the polyline of the points.
  struct Place {
    double distance, arc;
  };
  Place nearest(const Vec3& x) const;
  /// The point at this arc length on the polyline.
  Vec3 at(double arc_length) const;
  double angle_deg_at(double arc_length) const;
};

/// A place where the curves of a domain, or their paths in a mesh, could not be made.
struct FeatureDefect {
  enum class Kind {
    NotTraced,    ///< a curve breaks off: two patches touch without crossing, or a corner has no solution
    TwoSheets,    ///< four regions alternate around a curve: the boundary is not a manifold there
    NoPath,       ///< no path of boundary edges is left for a curve
    NoCorner,     ///< two corners of the domain would share a vertex
    WrongPatch,   ///< the faces on both sides of a path are not on the patches of its curve
    NotOnStratum  ///< a vertex has not arrived on its corner, curve or patch
  };
  Kind kind;
  int curve = -1, corner = -1;  ///< curve or corner of the graph, if one is concerned
  Vec3 where = Vec3::Zero();
};
const char* to_string(FeatureDefect::Kind);

/// The sharp curves and the corners of a domain.
struct FeatureGraph {
  std::vector<FeatureCorner> corners;
  std::vector<FeatureCurve> curves;
  std::vector<FeatureDefect> defects;
};

/// Traces the sharp curves of the boundary of a domain and their corners.
///
/// From each seed near two patches, Newton's method leads to a point of f_p = f_q = 0. The point lies on a sharp curve
/// if each of both signs changes the region. The curve is followed in both directions with steps of .2 h, corrected
/// onto both zero sets, until it comes back or until another patch changes what is around it. That place is found by
/// bisection; Newton's method on all patches there gives the corner.
/// @param seeds  points within 2 h of every curve, for example the boundary vertices of omega_h
/// @param h      edge length; curves of one pair of patches that are nearer than .2 h to each other count as one
/// \throw Cancelled
FeatureGraph trace_features(const PiecewiseDomain& domain, const std::vector<Vec3>& seeds, double h,
                            const Context& context = {});

}  // namespace umtet
