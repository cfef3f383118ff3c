#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "body/fidelity/mesh_measures.h"
#include "body/search/part_maker.h"
#include "body/sizing/edge_length.h"
#include "body/sizing/too_thin.h"
#include "mesh/background/background_mesh.h"
#include "mesh/second_order/quadratic_tets.h"
#include "mesh/sizes/size_field.h"
#include "mesh/universal_mesh.h"

namespace umtet {

/// One run of the algorithm and, if it made a mesh, what is true of it.
struct MeshAttempt {
  double h = 0;  ///< edge length of the background mesh, model units
  UmResult result;
  std::optional<SecondOrder> second;              ///< the mesh with curved edges, if mesh.order = 2
  MeshMeasures measured;                          ///< when there is a mesh
  std::vector<MeshDefect> defects;                ///< where it is not psi = 0
  std::vector<std::string> reasons;               ///< why it will not do, by judge_shape()
  ThinPlaces thin;                                ///< what h is too large for
  std::shared_ptr<const SizeField> sizes;         ///< that a graded background was made for
  std::optional<BackgroundMesh> background = {};  ///< that one
  int n_levels = 0;                               ///< of psi then; 0: a formula
  std::size_t n_pieces = 0, n_dropped = 0;        ///< of psi = 0: that were to be meshed, and that were left out
  /// Of a mesh that several processes have, which `result` has the boundary of.
  std::shared_ptr<const MeshInParts> parts = nullptr;
  std::vector<Vec3> mid_sides = {};  ///< of it, if mesh.order = 2: those of boundary edges

  bool made() const { return result.status == UmStatus::Success; }
  bool is_right() const { return made() && reasons.empty(); }
  /// There is no mesh, and what is too thin for h says why.
  bool fell_through() const { return !made() && !thin.empty(); }
  /// What is wrong with it first of all; empty if nothing is.
  std::string complaint() const;
};

/// Of `effort` below: a whole mesh is made again at most once, and small defects are named and left. More asks for
/// more: small folds are chased, too, and up to four meshes are made again.
inline constexpr double kDefaultEffort = 2.5;

/// Whether another mesh of the same psi may be better: something is wrong that is no small defect, and it is not psi
/// that no sample supports.
bool may_improve(const MeshAttempt& attempt, double effort);

/// Runs `attempt` at choice.h and, where that has a defect that is no small one, at an h that is forecast to pass: at
/// .985 h if nothing but folded faces and vertices off psi = 0 is wrong, which come and go with h; at the h that shows
/// all that is thin where it failed. Never below choice.least. Where noise decided h, what thin parts ask for is tried
/// with more effort only.
///
/// @param effort  an h is left out where all attempts together would make more than this many times the tets of the
///                first (of thin parts), as h alone says: the result does not depend on the machine
/// @param say     called with why another h is tried, and with which mesh is kept if it is not the last
/// @return the best of them: a mesh before none, then the one with the fewest reasons against it, then with the fewest
///         places, then the last
MeshAttempt best_attempt(const EdgeLength& choice, double effort, const std::function<MeshAttempt(double h)>& attempt,
                         const std::function<void(const std::string&)>& say);

/// Runs `attempt` at h and, while the mesh has a defect that is no small one, with smaller edges at the defects, at
/// most four times.
///
/// @param attempt  is also given the best of the attempts before, or null: it may leave as it is what did not fail
/// @param refine  asks for them, and returns the h of all that is asked for then; none where nothing may be finer
/// @param effort  ends it where all attempts together have made more than this many times the tets of the first
/// @return as best_attempt()
MeshAttempt refined_attempt(double h, double effort,
                            const std::function<MeshAttempt(double h, const MeshAttempt* former)>& attempt,
                            const std::function<std::optional<double>(const MeshAttempt&)>& refine,
                            const std::function<void(const std::string&)>& say);

/// Where an attempt failed, with half the size that was asked for there: the places that smaller edges may mend or, of
/// one that made no mesh, where it ended. In working coordinates. \pre attempt.sizes
/// @param effort  as above: it decides which defects are left
std::vector<SizeSource> finer_where_it_failed(const MeshAttempt& attempt, const Vec3& shift, double effort);

}  // namespace umtet
