#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/context.h"
#include "common/vec3.h"
#include "mesh/background/background_mesh.h"
#include "mesh/background/vertex_links.h"
#include "mesh/regions/region_domain.h"

namespace umtet {

namespace detail {
class PeriodicCells;
}

/// Parameters of choose_labels(). Lengths are in edges of the background.
struct RegionLabelParams {
  /// A vertex begins in a greater region only where it is deeper than this below their sheet: the tets of the greater
  /// region reach one layer farther than its vertices. Half the height of a layer; 0 to 1.
  double shift = .4;
  double reach = 1.3;           ///< a vertex farther from every sheet keeps its label; > 0
  double distance_weight = .1;  ///< cost of the squared distance of an interface vertex from its sheets; >= 0
  int max_sweeps = 20;          ///< over vertices whose change may lower the cost; >= 0
  int pair_rounds = 6;          ///< rounds of changes of two neighbours, around bad vertices; >= 0
  /// Tets at curves and corners cost more the lower their mean ratio is below this one; 0: nothing. The ball cut in two
  /// of tools/regions/region_meshes.py has its greatest least Q at .5: .6 and .7 leave more places that are worse.
  double poor_quality = .5;
  double bad_cost = .4;        ///< a vertex that costs as much is bad: its surroundings are searched longer; > 0
  int annealing_rounds = 4;    ///< over the vertices that are still bad; >= 0
  int annealing_sweeps = 300;  ///< over the vertices around a bad one, fewer where more than 200 are bad; >= 1
  double temperature = 4;      ///< temperature of the first sweep: the cost of four vertices that are not valid; > 0
};

/// All broken constraints, not just the first.
std::vector<std::string> problems(const RegionLabelParams&);

/// A background vertex around which the tets of the regions do not lie as at a smooth sheet, curve or corner.
struct InvalidVertex {
  std::int64_t background_vertex;
  RegionSet regions;  ///< the regions of the tets around it
};

/// A region for each background vertex.
struct RegionLabels {
  std::vector<std::uint8_t> of_vertex;  ///< per id of the background
  std::vector<InvalidVertex> invalid;   ///< ascending
  std::size_t n_interface = 0;          ///< vertices with tets of several regions
  std::size_t n_invalid_at_start = 0;   ///< interface vertices that were not valid before any change
  std::size_t n_changes = 0;            ///< changes of labels
  std::size_t n_psi_evaluations = 0;
  bool leaves_background = false;  ///< a vertex of a region other than 0 is on the boundary of the background
};

/// Chooses the regions of the background vertices. A tet belongs to the greatest region of its vertices, so that
/// sheets, curves and corners follow from the labels: M(v), the regions of the tets around v, has two members where v
/// is on a sheet, three on a curve, four or more at a corner.
///
/// A vertex v on an interface is valid if its neighbours at the same two regions a and b, the set B_ab in the link of
/// v, lie as on a sheet, for all a and b in M(v):
///
///     v on a sheet: B_ab is one cycle without chords
///     v on a curve: two neighbours are at all three regions, and each B_ab is a path without chords between them
///     v at a corner: each B_ab consists of paths without chords between neighbours at three regions or more
///
/// Then no tet has four vertices on one sheet, no face has three without being a face of the sheet, and no edge two
/// without being an edge of it: such tets would be flat as h goes to 0.
///
/// The labels begin as the regions of the vertices, shrunk by `shift`. From there, iterated conditional modes
/// [Besag1986] change single labels and then two neighbours at once while this lowers
///
///     sum over interface vertices v of  [v is not valid] + distance_weight * sum over sheets of v of distance^2
///                                       + sum over tets at v, on curves and at corners, of max(0, 1 - Q / poor)^2
///
/// where Q is the mean ratio of the tet once all its vertices are at the foot of their stratum. Where a vertex still
/// costs `bad_cost`, simulated annealing [Kirkpatrick1983] searches the labels of two rings around it.
///
/// A label changes only where the vertices of each set {label >= k} keep their topology (LinkState::simple).
/// One thread; the same labels on every run.
/// @param cells  null, or the cells of a torus: copies of vertices have the labels of their representatives
/// \throw std::invalid_argument naming every broken constraint of params; Cancelled
RegionLabels choose_labels(const RegionDomain& domain, const BackgroundMesh& background, const VertexLinks& links,
                           const RegionLabelParams& params = {}, const Context& context = {},
                           const detail::PeriodicCells* cells = nullptr);

}  // namespace umtet
