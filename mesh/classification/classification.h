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

/// Parameters of classify_vertices(). Lengths are in LinkTopology::unit; depths are inside, heights outside.
/// docs/constants.md lists the effect of other values.
struct ClassificationParams {
  /// The classification starts from {psi < 0} offset inwards by this; 0 <= shift <= .15
  double shift = .1;
  double reach_in = .9;   ///< a vertex deeper than this keeps its class; >= 0
  double reach_out = .2;  ///< a vertex higher than this keeps its class; >= 0
  /// A vertex keeps its class where projection would stretch the distances of the vertices around it by more than this
  /// factor; >= 1. If the innermost vertex of a tip changed to outside, the tip would be cut off or fold.
  double most_stretch = 1.2;
  /// A vertex keeps its class where the body, or the gap outside, is thinner than this; >= 0. 0: thickness is not
  /// tested
  double least_thickness = 1;
  /// Cost of a boundary vertex at height d: outside_weight (d - outside_height)^2; outside_weight >= 0
  double outside_weight = 40, outside_height = .1;
  /// Cost of an inside vertex at depth d < inside_depth: inside_weight (inside_depth - d)^2; inside_weight >= 0
  double inside_weight = 20, inside_depth = .5;
  int max_sweeps = 50;  ///< sweeps over the vertices whose gain may have changed, single and pair moves together; >= 0
  /// If a classification of a former mesh is given, a vertex with its former state changes only for a gain above this;
  /// >= 0. A larger value changes fewer faces from step to step, and lowers the least Q.
  double keep = 1;
  /// Costs of the configurations of a link; null: the costs of a15()
  const StarCostTable* costs = nullptr;
};

/// All broken constraints, not just the first.
std::vector<std::string> problems(const ClassificationParams&);

/// Report of classify_vertices().
struct ClassificationReport {
  std::size_t candidates = 0;              ///< vertices whose state may change
  std::size_t shifted = 0;                 ///< states changed by the shift
  std::size_t returned = 0;                ///< states changed back to the states of the former mesh
  std::size_t flips = 0;                   ///< states changed by the descent
  std::size_t stretched = 0;               ///< vertices near the boundary that kept their state because of most_stretch
  std::size_t thin = 0;                    ///< candidates that kept their state because of least_thickness
  std::vector<std::int64_t> not_manifold;  ///< outside vertices with a non-manifold boundary of omega_h; ascending
  int sweeps = 0;
  bool settled = false;  ///< the descent ended because it found no further change, not by max_sweeps
  std::size_t psi_evaluations = 0;
};

/// True if psi changes sign within `thickness` edges of a foot point on psi = 0, along the normal on either side: the
/// body or the gap is thin there. @param n_evaluations  is increased by the number of evaluations of psi
bool is_thin(ImplicitFunctionRef psi, const Vec3& foot, const Vec3& normal, double thickness, double h,
             std::size_t& n_evaluations);

/// Inside/outside classification: chooses which background vertices near the boundary count as inside, so that their
/// tets can be shaped well.
///
/// Near psi = 0 this choice is free, because projection moves the boundary onto psi = 0 in either case. A state changes
/// only
/// - at a simple vertex (LinkState), so that the inside vertices and their complement keep their topology, and
/// - if the boundary of omega_h stays a manifold wherever it was.
///
/// The initial states are those of psi offset inwards by `shift`. From there, iterated conditional modes change single
/// states, and then the states of two neighbours at once, while this lowers
///
///     sum over outside vertices v of omega_h of cost(states of the link of v) + outside_weight (d_v -
///     outside_height)^2
///   + sum over inside vertices near the boundary of inside_weight max(0, inside_depth - depth)^2
///
/// with distances psi / |grad psi|, corrected at the foot point, in the unit of each vertex. In a lattice the descent
/// runs by blocks of 4^3 cells in eight colours, in other backgrounds vertex by vertex; the states are the same for any
/// number of threads.
///
/// @param inside  the vertices with psi < 0 on entry; none of them, nor a neighbour, on the background boundary
/// @param last    inside vertices of the former mesh, or null: a former state that costs at most `keep` more is the
///                initial state
/// @param known   psi at all vertices with a neighbour on the other side, or null
/// @param part    part of a lattice whose other parts are classified by other processes, or null. `inside` is then
///                correct within five rings of own vertices. In the report, candidates and flips count all processes,
///                the rest this part
/// \throw std::invalid_argument naming every broken constraint of params, Cancelled
/// \throw std::invalid_argument naming every broken constraint of params, Cancelled
ClassificationReport classify_vertices(const BackgroundMesh& background, const VertexLinks& links,
                                       ImplicitFunctionRef psi, const ClassificationParams& params, IdSet& inside,
                                       const Context& context = {}, const IdSet* last = nullptr,
                                       const PsiValues* known = nullptr, ClassificationPart* part = nullptr);

}  // namespace umtet
