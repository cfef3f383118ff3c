#pragma once

#include <span>
#include <vector>

#include "mesh/second_order/mid_side_projection.h"
#include "mesh/second_order/quadratic_tets.h"

namespace umtet {

/// Relaxation of mid-sides until the Jacobians of all tets reach the bounds of SecondOrderParams: steps 2 and 3 of
/// quadratic_tets(). Mid-sides move one after the other, so the result does not depend on threads.
class MidSideRelaxation {
 public:
  /// Keeps references to all arguments but h.
  /// @param kind    role of every mid-side, by vertex index minus n_corners
  /// @param at_rim  for each tet of a part of a mesh: 1 if other tets at one of its edges are not in the part; null:
  ///                none
  MidSideRelaxation(QuadraticTetMesh& mesh, std::size_t n_corners, std::vector<MidSide>& kind, ImplicitFunctionRef psi,
                    double h, const SecondOrderParams& params, const std::vector<char>* at_rim = nullptr);

  /// Step 2.
  /// @param below  the tets below the target; receives those still below it
  /// @return number of evaluations of psi for closest points
  std::size_t relax(std::vector<int>& below, const Context& context);

  /// Step 3. Surface mid-sides that move become Fixed. @param below  tets that may be below params.least
  void retreat(const std::vector<int>& below);

  /// True if mid-sides of a tet at the rim were to move; the whole mesh may give them other positions.
  bool has_met_rim() const { return has_met_rim_; }

 private:
  std::span<const int> tets_at(int mid_side) const;
  Vec3 chord_middle(int mid_side) const;
  double energy(int mid_side) const;
  bool improve(int mid_side);
  std::vector<int> mid_sides_of(const std::vector<int>& tets);
  /// The tets at these mid-sides with min det / mean det proved to be at most `bar`, ascending.
  std::vector<int> tets_below_at(const std::vector<int>& mid_sides, double bar) const;

  QuadraticTetMesh& mesh_;
  const int n_corners_;
  std::vector<MidSide>& kind_;
  ImplicitFunctionRef psi_;
  const double h_;
  const SecondOrderParams& params_;
  const std::vector<char>* const at_rim_;
  bool has_met_rim_ = false;
  std::size_t n_psi_evaluations_ = 0;
  std::vector<std::size_t> begin_;  ///< for each mid-side, the begin of its tets in tets_
  std::vector<int> tets_;
};

}  // namespace umtet
