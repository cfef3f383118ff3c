#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/base/id_set.h"
#include "mesh/classification/star_cost_table.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/psi_values.h"

namespace umtet {

/// Lengths are in LinkTopology::unit. Measured on bodies of star_costs (seeds not of the fit, 100 of 40k tets and 60 of
/// 6k): of their 4.3 M tets smoothing alone leaves 24 below .82, in 6 bodies, and with another value what the line
/// says.
struct ClassificationParams {
  /// The states start as those of {psi < 0} moved inwards by this; 0 <= shift <= .15. 0: 25 tets, .05: 19,
  /// .15: 25; but with 0 the 1 % quantile of Q of T6 is .839 where it is .842 with .1 (as below, weight 20)
  double shift = .1;
  double reach_in = .9;   ///< how deep inside a state may change; >= 0
  double reach_out = .2;  ///< how far outside; >= 0. .5: 17 tets
  /// No state changes where projection would draw the vertices around apart by more than this factor; >= 1. A tip whose
  /// innermost vertex is no longer inside is cut off, or folds. Samples of a scan to its mesh of 160k tets, 99 %:
  /// .17 h, .21 h with 1.4, .33 h without limit; folded over faces of another's (2.1 M): 4, and 20 without.
  double most_stretch = 1.2;
  /// Nor where the body or the gap outside is thinner than this; >= 0. With 2 the thin fin of a scan keeps 98 tets
  /// below .81, with 1.5 two, and three of the clouds of data/ that are 2 h thick get boundaries that are no manifolds.
  double least_thickness = 1;
  /// Cost of a boundary vertex at height d outside: outside_weight (d - outside_height)^2; >= 0. Weight 20: 22 tets,
  /// but the 1 % quantile of Q of T6 (100k tets, the lattice in 41 places) is .842 at least, and .844 with 40; 80: 85
  /// tets, .838. Height -.15: 129 tets, 0: 65, .2: 15
  double outside_weight = 40, outside_height = .1;
  /// Cost of an inside vertex at depth d < inside_depth: inside_weight (inside_depth - d)^2; >= 0. Weight 10: 17 tets,
  /// 40: 30; depth .4: 17, .6: 37
  double inside_weight = 20, inside_depth = .5;
  int max_sweeps = 50;  ///< >= 0
  /// Where there is a mesh before, a state that is as it was then changes for a gain above this only; >= 0. A
  /// ball that drifts a fiftieth of a cell a step: .0151 states a face change (.0172 with 0, .0116 with 5; psi = 0
  /// passes over .0092 vertices), least Q .827 (.824, .828). In steps of a quarter cell they are .113 (.114, .109;
  /// .115). Where all states begin as they were, whatever that costs, least Q is up to .04 lower.
  double keep = 1;
  /// Costs of the configurations of a link; null: those of A15, a15_star_costs().
  const StarCostTable* costs = nullptr;
};

/// Every broken constraint, not just the first.
std::vector<std::string> problems(const ClassificationParams&);

struct ClassificationReport {
  std::size_t candidates = 0;    ///< vertices whose state might change
  std::size_t shifted = 0;       ///< states changed by the shift
  std::size_t returned = 0;      ///< states changed to those of the mesh before
  std::size_t flips = 0;         ///< states changed by the descent
  std::size_t stretched = 0;     ///< vertices near the boundary that kept theirs because of most_stretch
  std::size_t thin = 0;          ///< candidates that kept their state because of least_thickness
  std::size_t not_manifold = 0;  ///< outside vertices at the boundary of omega_h where it is no manifold
  int sweeps = 0;
  bool settled = false;  ///< the descent ended because it found nothing more to change, not by max_sweeps
  std::size_t psi_evaluations = 0;
};

/// True if psi changes sign within `thickness` edges of a foot on psi = 0, along the normal on either side: another
/// sheet lies there. @param n_evaluations  is raised by the number of values of psi
bool is_thin(ImplicitFunctionRef psi, const Vec3& foot, const Vec3& normal, double thickness, double h,
             std::size_t& n_evaluations);

/// Chooses which background vertices near the boundary count as inside, so that the mesh of them can be shaped well.
///
/// Which vertices are inside is free near psi = 0: projection moves the boundary onto it either way. A state changes
/// only at a simple vertex (LinkState), so the inside vertices and their complement keep their topology, and only if
/// the boundary of omega_h is manifold wherever it was. From the states of psi moved inwards by `shift`, a descent
/// changes single states, and then those of two neighbours at once, as long as that lowers
///
///     sum over outside vertices v of omega_h of cost(states of the link of v) + outside_weight (d_v -
///     outside_height)^2
///   + sum over inside vertices near the boundary of inside_weight max(0, inside_depth - depth)^2
///
/// with distances from psi / |grad psi|, corrected at the foot, in the unit of each vertex. Blocks of 4^3 cells in
/// eight colours: the same states for any number of threads.
///
/// @param inside  the vertices with psi < 0 on entry; none of them, nor a neighbour, on the background boundary
/// @param last    inside vertices of the mesh before, or null: a state that costs at most `keep` more begins as there
/// @param known   psi at all vertices with a neighbour on the other side, or null
/// \throw std::invalid_argument naming every broken constraint of params, Cancelled
ClassificationReport classify_vertices(const BackgroundMesh& background, const std::vector<LinkTopology>& links,
                                       ImplicitFunctionRef psi, const ClassificationParams& params, IdSet& inside,
                                       const Context& context = {}, const IdSet* last = nullptr,
                                       const PsiValues* known = nullptr);

}  // namespace umtet
