#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "mesh/core/implicit_function.h"
#include "mesh/core/max_min.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/fast/flips/detail/edge_operations.h"
#include "mesh/fast/flips/local_flips.h"
#include "mesh/fast/smoothing/ring_newton.h"
#include "mesh/implicit/closest_point.h"

namespace umtet::detail {

/// Boundary faces with a smaller cosine of the angle to psi = 0 are misaligned (patch_state.h).
inline constexpr double kAligned = .5;
/// A face counts like a tet whose Q is less than the target by this much for a cosine that is less by one.
inline constexpr double kWeightOfCosine = .6;

/// The mean ratio of the tet that counts as much as a misaligned face.
inline double quality_of_cosine(double target, double cosine) {
  return target - kWeightOfCosine * std::max(0., kAligned - cosine) / 2;
}

/// A copy of the tets around an operation, on which the operation is tried.
struct FlipPatch {
  std::vector<int> vertices;  ///< vertices of the mesh
  std::vector<Vec3> V;
  std::vector<Tet> C;       ///< local indices; the new tets come first
  std::vector<int> region;  ///< per tet; empty: one region
  std::vector<std::uint8_t> moves;
  std::vector<std::vector<Triangle>> ring;  ///< per vertex that moves: its tets are (v, p, q, r)
};

/// The measures that are compared before and after an operation.
struct PatchMeasure {
  double sum = 0, least = 1;
  double shortest = std::numeric_limits<double>::infinity(), longest = 0;  ///< edges, relative
  double least_cosine = 1, farthest = 0;  ///< least cosine of boundary faces; largest distance in edges
};

/// Tries operations on patches of a mesh.
class PatchTrials {
 public:
  /// Keeps references to its arguments. The edges of the mesh are measured here.
  /// @param report  counts tries and evaluations of psi
  PatchTrials(const ChangingMesh& mesh, ImplicitFunctionRef psi, const LocalFlipParams& params,
              LocalFlipReport& report);

  /// Tries an operation and moves the vertices of its patch. The mesh stays unchanged.
  /// @param is_last  in the last pass all vertices also move at once, and a smaller gain is enough
  /// @param patch    receives the patch after the operation
  /// @return whether the patch is better than before
  bool operator()(const FlipCandidate& c, bool is_last, FlipPatch& patch);

  /// The tets of the last patch, before the operation; and those that the operation keeps. Both ascend.
  const std::vector<int>& patch_tets() const { return patch_tets_; }
  const std::vector<int>& kept_tets() const { return kept_tets_; }

 private:
  void measure_edges();
  void list_tets(const FlipCandidate& c);
  bool is_better(const PatchMeasure& made, const PatchMeasure& old, bool is_last) const;
  FlipPatch patch_of(const std::vector<Tet>& tets, std::vector<int> region);
  void shape(FlipPatch& patch);
  void shape_at_once(FlipPatch& patch, double needed);
  bool solve(FlipPatch& patch, std::size_t v, const OneRing& ring);
  bool solve_on_stratum(int vertex, const OneRing& ring, const Bar& bar, Vec3& x);
  const BallOnPatch& ball_of(int vertex);
  PatchMeasure measured(const FlipPatch& patch);
  void measure_faces(const FlipPatch& patch, PatchMeasure& m);

  const ChangingMesh& mesh_;
  std::vector<int> local_;         ///< per vertex, while a patch is made
  std::vector<double> edge_;       ///< mean length at each vertex, at first
  std::vector<BallOnPatch> ball_;  ///< per vertex, with strata: around a place where it has been
  ImplicitFunctionRef psi_;
  const LocalFlipParams& params_;
  LocalFlipReport& report_;
  const ClosestPointParams closest_point_{.method = ClosestPointMethod::Damped};
  const double good_f_;
  std::vector<int> moving_, patch_tets_, kept_tets_;
  struct Face {
    Triangle key, face;
    int region;
  };
  std::vector<Face> faces_;
};

}  // namespace umtet::detail
