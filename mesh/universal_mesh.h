#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/max_min.h"
#include "mesh/fast/fast_params.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/paper/relaxation_direction.h"
#include "mesh/submesh/submesh.h"

namespace umtet {

enum class UmMode {
  Fast,   ///< beyond the paper: chosen labels, guarded projection and p-norm smoothing of a layer, repair; fast_mesh.h
  Paper,  ///< Algorithm 1 to the letter
};
/// What becomes of a domain that reaches the background boundary.
enum class BackgroundBoundary {
  Refuse,  ///< UmStatus::DomainLeavesBackground
  /// The background boundary is a wall: it bounds the mesh where Omega reaches it, and stays where it is. Labels, which
  /// are chosen and repaired off the background boundary only, stay those of psi but for those that part double
  /// positive faces (double_faces.h).
  Wall,
};
enum class SubmeshSearch { FullLoop, Crawl };  ///< Alg. 1, steps 1-22, or Section 3.8(c) from given seeds

struct UmParams {
  UmMode mode = UmMode::Paper;
  FastParams fast;                 ///< of UmMode::Fast, which has no use for those down to max_min, and the seed
  int projection_passes = 5;       ///< N_P: positive vertices reach the boundary in this many steps, eq. (1); >= 1
  int relaxation_iterations = 25;  ///< N_R of Algorithms 1 and 2; >= 0
  int samples = 20;                ///< N_S: 2 N_S + 1 candidates in [-h, h], eq. (7); >= 1
  DirectionRule directions = DirectionRule::Random;  ///< Section 3.8(d); least_quality in mesh_bench compares
  /// Exact; GoldenSection, the paper's faster, suboptimal choice (Fig. 18), in a build without GSL.
  MaxMin max_min = kBestMaxMin;
  SubmeshSearch search = SubmeshSearch::FullLoop;
  BackgroundBoundary background_boundary = BackgroundBoundary::Refuse;
  ClosestPointParams closest_point;
  std::uint64_t seed = 0;  ///< random tangents of boundary dvr are a function of (seed, iteration, vertex)
};

/// Every broken constraint, not just the first; empty when the parameters are usable.
std::vector<std::string> problems(const UmParams&);

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
  Cancelled,                ///< the observer said stop
};
const char* to_string(UmStatus);

/// What happened, where: ids of the background mesh (-1 = does not apply), a place in model units, a sentence.
struct UmEvidence {
  std::int64_t background_vertex = -1;
  std::int64_t background_tet = -1;
  Vec3 where = Vec3::Zero();
  std::size_t count = 0;  ///< how many offenders there are; the fields above describe the first
  std::string what;
};

struct UmResult {
  UmStatus status = UmStatus::Success;
  UmEvidence evidence;  ///< filled when status != Success
  Submesh submesh;      ///< omega_h with background coordinates (step 22)
  std::vector<Triangle>
      walls;  ///< BackgroundBoundary::Wall: the faces of omega_h on the background boundary, local vertex ids, outward
  std::vector<Vec3> projected;  ///< vertex coordinates after step 30, same numbering
  std::vector<Vec3> final;      ///< vertex coordinates of T^{Omega_h} (step 35), same numbering
  double conditioning_angle_max_deg = 0;
  std::size_t obtuse_conditioning_angles = 0;
  std::size_t double_positive_faces = 0;
  std::size_t n_psi_evaluations = 0;
};

/// Where the algorithm stands; return false to stop at the next safe point (at most one sweep later).
struct UmProgress {
  const char* step;             ///< "search" (V is empty yet), "submesh", "project", "relax"
  int pass, n_passes;           ///< 1-based
  const std::vector<Vec3>* V;   ///< the current iterate
  std::size_t n_tets;           ///< of omega_h, and of every mesh made from it
  int sweep = 1, n_sweeps = 1;  ///< relaxation sweeps of this pass done so far, and in all; equal at the end of a pass
};
using UmObserver = std::function<bool(const UmProgress&)>;

/// A boundary-fitting mesh of {psi < 0}: Algorithm 1 of the paper, or what goes beyond it (fast_mesh.h).
///
/// Foreseen failures are statuses with evidence; the arrays of the result then hold the last iterate. A double positive
/// face or an obtuse conditioning angle breaks an assumption of the algorithm but need not break the mesh: both are
/// counted in the result, and become the status only when a projection diverges or a tet inverts right there. With
/// double positive faces the boundary of the mesh is not the set of positive faces, which a certificate will say.
/// Around a body in a box: psi is a Complement (implicit_function.h), the background boundary a wall; walls are flat in
/// an a15_box().
/// @param seeds  for SubmeshSearch::Crawl: at least one point near every component of the boundary
/// \throw std::invalid_argument naming every broken constraint of params
UmResult universal_mesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const UmParams& params = {},
                        const UmObserver& observer = {}, const std::vector<Vec3>& seeds = {});

}  // namespace umtet
