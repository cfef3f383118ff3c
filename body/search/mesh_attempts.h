#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/fidelity/mesh_measures.h"
#include "body/search/part_maker.h"
#include "body/sizing/edge_length.h"
#include "body/sizing/too_thin.h"
#include "mesh/background/background_mesh.h"
#include "mesh/features/piecewise_mesh.h"
#include "mesh/second_order/quadratic_tets.h"
#include "mesh/sizes/size_field.h"
#include "mesh/universal_mesh.h"

namespace umtet {

/// One run of the algorithm and, if it made a mesh, the measurements of the mesh.
struct MeshAttempt {
  double h = 0;  ///< edge length of the background mesh, model units
  UmResult result;
  std::optional<SecondOrder> second;              ///< the mesh with curved edges, if mesh.order = 2
  MeshMeasures measured;                          ///< measurements, if there is a mesh
  std::vector<MeshDefect> defects;                ///< differences between the mesh and psi = 0
  std::vector<std::string> reasons;               ///< reasons for failure, by judge_shape()
  ThinPlaces thin;                                ///< places for which h is too large
  std::shared_ptr<const SizeField> sizes;         ///< sizes for which a graded background was made
  std::optional<BackgroundMesh> background = {};  ///< the graded background
  int n_levels = 0;                               ///< number of levels of psi at this h; 0: a formula
  std::size_t n_pieces = 0, n_dropped = 0;        ///< numbers of pieces of psi = 0 that were selected and dropped
  /// The mesh of several processes, if they made it; `result` then contains only its boundary.
  std::shared_ptr<const MeshInParts> parts = nullptr;
  std::vector<Vec3> mid_sides = {};  ///< mid-sides of the boundary edges of `parts`, if mesh.order = 2
  /// The curves and patches of the mesh of Domain::piecewise, by the numbers of vertices in `result`; it has vertices
  /// and faces, and no tets. Null for a smooth body.
  std::shared_ptr<const PiecewiseMesh> features = nullptr;

  bool made() const { return result.status == UmStatus::Success; }
  bool is_right() const { return made() && reasons.empty(); }
  /// There is no mesh, because places are too thin for h.
  bool fell_through() const { return !made() && !thin.empty(); }
  /// Returns the main reason for failure; empty if there is none.
  std::string complaint() const;
};

/// Default of `effort` below: at most one other mesh is made as a whole, and small defects remain and are named. With a
/// larger effort small folds are also a reason for another attempt, and up to four other meshes are made as a whole.
inline constexpr double kDefaultEffort = 2.5;

/// Returns whether another mesh of the same psi may be better: it has a fault other than small defects, and the reason
/// is not a part of psi without the support of samples.
bool may_improve(const MeshAttempt& attempt, double effort);

/// The attempts that use one h for the whole mesh:
///
///     AttemptsWithOneH attempts(choice, effort, say);
///     while (const std::optional<double> h = attempts.next_h()) attempts.add(attempt_at(*h));
///     return attempts.take_best();
///
/// The first h is choice.h. If the mesh has a defect that is not small, the next h is one for which no such defect is
/// expected: .985 h if the only faults are folded faces and vertices off psi = 0, because these depend on h
/// irregularly, otherwise the h that resolves all thin parts at the defects. h is never below choice.least. If noise
/// determined h, the smaller h for thin parts is tried only with more than the default effort.
class AttemptsWithOneH {
 public:
  /// @param effort  largest ratio of the tets of all attempts to the tets of the first (or the first for thin parts);
  ///                an h beyond it is not tried. The ratio is estimated from h alone, so the result does not depend on
  ///                the machine.
  /// @param say     receives the reason for each further attempt, and the choice of the mesh if it is not the last
  AttemptsWithOneH(const EdgeLength& choice, double effort, std::function<void(const std::string&)> say);

  /// Returns the h of the next attempt; empty if there is none.
  std::optional<double> next_h() const { return next_h_; }

  /// Receives the attempt at next_h(), which must not be empty, and chooses the h after it.
  void add(MeshAttempt attempt);

  /// Returns the best attempt: one with a mesh; among these, one with the fewest reasons for failure, then the fewest
  /// defects, then the last. \pre add() has been called
  MeshAttempt take_best() { return std::move(*best_); }

 private:
  std::optional<double> h_after(const MeshAttempt& last);
  bool may_try(double h);

  const EdgeLength choice_;
  const double effort_;
  const std::function<void(const std::string&)> say_;
  std::optional<double> next_h_;
  std::optional<MeshAttempt> best_;
  int left_;               ///< number of attempts that may follow
  double h_, unit_;        ///< h of the last attempt that was not only nearby; the h whose tets are the unit
  double spent_ = 1;       ///< tets of all attempts, estimated, in tets at unit_
  bool is_begun_ = false;  ///< the h of thin parts has been tried
  bool was_nearby_ = false, is_smaller_ = false;
};

/// Runs `attempt` at h. While the mesh has a defect that is not small, it runs `attempt` again with smaller edges at
/// the defects, at most four times.
///
/// @param attempt  also receives the best earlier attempt, or null; it may keep the parts of that mesh that did not
///                 fail
/// @param refine  requests smaller edges at the defects of an attempt, and returns the new least edge length; empty if
///                no edge may be smaller
/// @param effort  no further attempt is made if all attempts together have more than this many times the tets of the
///                first
/// @return the best attempt, as AttemptsWithOneH::take_best()
MeshAttempt refined_attempt(double h, double effort,
                            const std::function<MeshAttempt(double h, const MeshAttempt* former)>& attempt,
                            const std::function<std::optional<double>(const MeshAttempt&)>& refine,
                            const std::function<void(const std::string&)>& say);

/// Returns sizes for a further attempt, in working coordinates: half the previous size at each defect that smaller
/// edges may repair or, if there is no mesh, at the position of the failure.
/// \pre attempt.sizes
/// @param effort  as above: it determines which small defects remain
std::vector<SizeSource> finer_where_it_failed(const MeshAttempt& attempt, const Vec3& shift, double effort);

}  // namespace umtet
