#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "mesh/core/tet_mesh.h"
#include "mesh/submesh/submesh.h"

namespace umtet {

/// Success of universal_mesh(), or the reason of its failure.
enum class UmStatus {
  Success,
  EmptyDomain,             ///< psi >= 0, or not finite, at every background vertex
  PsiNotFinite,            ///< psi is a finite number at no background vertex
  DomainLeavesBackground,  ///< psi < 0 at a vertex on the background boundary: the box is too small
  BoundaryNearWall,    ///< BackgroundBoundary::Wall: a positive vertex is within two edges of the background boundary
  DoublePositiveFace,  ///< the run failed at a face shared by two positively cut tets: too thin or curved for h
  ObtuseConditioningAngle,  ///< the run failed where the injectivity condition of Section 5.3 is broken
  ProjectionDiverged,       ///< 3.8(a) did not settle for a positive vertex
  InvertedTet,              ///< an intermediate mesh has a tet with Q <= 0
};
const char* to_string(UmStatus);

/// Evidence of a failure: ids of the background mesh (-1 = does not apply), a position in model units, a sentence.
struct UmEvidence {
  std::int64_t background_vertex = -1;
  std::int64_t background_tet = -1;
  Vec3 where = Vec3::Zero();
  std::size_t count = 0;  ///< number of places that break the rule; the fields above describe the first
  std::string what;
};

/// A background vertex whose class was changed to make the boundary of omega_h a manifold there: a bridge was filled or
/// a web was cut.
struct ManifoldFlip {
  std::int64_t background_vertex;
  Vec3 where;
  bool is_filled;   ///< true: the vertex is now inside; false: it was removed from the inside
  double distance;  ///< signed, from psi = 0 to the vertex, model units
};

/// Result of universal_mesh(): omega_h, the vertex positions of its stages, and statistics.
struct UmResult {
  UmStatus status = UmStatus::Success;
  UmEvidence evidence;  ///< set when status != Success
  Submesh submesh;      ///< omega_h with background coordinates (step 22)
  std::vector<Triangle>
      walls;  ///< BackgroundBoundary::Wall: the faces of omega_h on the background boundary, local vertex ids, outward
  std::vector<Vec3> projected;               ///< vertex coordinates after step 30, same numbering
  std::vector<Vec3> final;                   ///< vertex coordinates of T^{Omega_h} (step 35), same numbering
  std::vector<ManifoldFlip> manifold_flips;  ///< UmMode::Fast; ascending in background_vertex
  std::size_t n_stepped_back = 0;            ///< UmMode::Fast: vertices moved off psi = 0 to make the mesh embedded
  double conditioning_angle_max_deg = 0;
  std::size_t obtuse_conditioning_angles = 0;
  std::size_t double_positive_faces = 0;
  std::size_t n_psi_evaluations = 0;
  /// The mesh before flip_submesh(), whose tets are a set of tets of the background; null where no flip was made.
  std::shared_ptr<const UmResult> of_background = nullptr;
  /// Vertex coordinates after every projection pass, same numbering; only if PaperParams::keep_iterates is set.
  std::vector<std::vector<Vec3>> iterates;
};

}  // namespace umtet
