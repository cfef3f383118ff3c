#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/background/vertex_links.h"
#include "mesh/base/id_set.h"
#include "mesh/classification/classification_part.h"
#include "mesh/classification/star_cost_table.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/psi_values.h"

namespace umtet {

/// Lengths are in LinkTopology::unit; depths are inside, heights outside. docs/constants.md has what other values do.
struct ClassificationParams {
  /// The classification starts from {psi < 0} moved inwards by this; 0 <= shift <= .15
  double shift = .1;
  double reach_in = .9;   ///< a vertex deeper than this keeps its class; >= 0
  double reach_out = .2;  ///< a vertex higher than this keeps its class; >= 0
  /// A vertex keeps its class where projection would draw the vertices around it apart by more than this factor; >= 1.
  /// A tip whose innermost vertex became an outside one would be cut off, or fold.
  double most_stretch = 1.2;
  /// A vertex keeps its class where the body, or the gap outside, is thinner than this; >= 0, 0: it is not looked at
  double least_thickness = 1;
  /// Cost of a boundary vertex at height d: outside_weight (d - outside_height)^2; outside_weight >= 0
  double outside_weight = 40, outside_height = .1;
  /// Cost of an inside vertex at depth d < inside_depth: inside_weight (inside_depth - d)^2; inside_weight >= 0
  double inside_weight = 20, inside_depth = .5;
  int max_sweeps = 50;  ///< over the vertices whose gain may have changed, single and pair moves together; >= 0
  /// With a classification of a mesh before, a vertex that is as it was then changes for a gain above this only; >= 0.
  /// The greater, the fewer faces change from step to step, and the lower the least Q.
  double keep = 1;
  /// Costs of the configurations of a link; null: those of a15()
  const StarCostTable* costs = nullptr;
};

/// Every broken constraint, not just the first.
std::vector<std::string> problems(const ClassificationParams&);

struct ClassificationReport {
  std::size_t candidates = 0;              ///< vertices whose state might change
  std::size_t shifted = 0;                 ///< states changed by the shift
  std::size_t returned = 0;                ///< states changed to those of the mesh before
  std::size_t flips = 0;                   ///< states changed by the descent
  std::size_t stretched = 0;               ///< vertices near the boundary that kept theirs because of most_stretch
  std::size_t thin = 0;                    ///< candidates that kept their state because of least_thickness
  std::vector<std::int64_t> not_manifold;  ///< outside vertices where the boundary of omega_h is none; ascending
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
/// with distances from psi / |grad psi|, corrected at the foot, in the unit of each vertex. In a lattice by blocks of
/// 4^3 cells in eight colours, in other backgrounds one vertex after the other: the same states for any number of
/// threads.
///
/// @param inside  the vertices with psi < 0 on entry; none of them, nor a neighbour, on the background boundary
/// @param last    inside vertices of the mesh before, or null: a state that costs at most `keep` more begins as there
/// @param known   psi at all vertices with a neighbour on the other side, or null
/// @param part    of a lattice, where other processes classify the rest, or null. `inside` is then right within five
///                rings of own vertices; of the report, candidates and flips are those
///                of all, the rest is about this part
/// \throw std::invalid_argument naming every broken constraint of params, Cancelled
ClassificationReport classify_vertices(const BackgroundMesh& background, const VertexLinks& links,
                                       ImplicitFunctionRef psi, const ClassificationParams& params, IdSet& inside,
                                       const Context& context = {}, const IdSet* last = nullptr,
                                       const PsiValues* known = nullptr, ClassificationPart* part = nullptr);

}  // namespace umtet
