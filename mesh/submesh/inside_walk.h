#pragma once

#include <cstdint>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/base/id_set.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/psi_values.h"

namespace umtet {

/// The set of background vertices with psi < 0, updated as psi changes.
class InsideWalk {
 public:
  explicit InsideWalk(const BackgroundMesh& background);

  /// Evaluates psi at every vertex of the background. @return number of evaluations \throw Cancelled
  std::size_t restart(ImplicitFunctionRef psi, const Context& context = {});
  /// Updates the set for a new psi. Evaluates psi at the vertices with a neighbour on the other side, at `more`, and at
  /// the neighbours of every vertex that has changed sides.
  ///
  /// A change is found wherever a connected set of vertices that change sides touches a vertex of the first two kinds.
  /// If it throws, the object is unchanged.
  /// @param more  vertex ids
  /// @return number of evaluations
  /// \throw Cancelled, and any exception of psi
  std::size_t update(ImplicitFunctionRef psi, const std::vector<std::int64_t>& more, const Context& context = {});

  const IdSet& inside() const { return inside_; }
  bool has_boundary() const { return !boundary_.empty(); }
  /// Values of psi from the last update, at the vertices that now have a neighbour on the other side; empty after
  /// restart().
  const PsiValues& values() const { return values_; }

 private:
  template <class F>
  void for_each_neighbour(std::int64_t v, const F& f) const;
  bool is_at_boundary(std::int64_t v) const;

  const BackgroundMesh& background_;
  std::vector<std::vector<std::int64_t>> steps_;  ///< per vertex type of a lattice
  IdSet inside_;
  IdSet seen_;                          ///< empty between calls
  std::vector<std::int64_t> boundary_;  ///< vertices with a neighbour on the other side
  PsiValues values_;                    ///< values at boundary_
};

}  // namespace umtet
