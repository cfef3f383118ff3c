#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "body/thin_place.h"
#include "common/vec3.h"

namespace umtet {

/// What a valid mesh does not show as psi = 0 has it.
enum class PlaceKind {
  Folded,    ///< boundary faces that lie on psi = 0 the wrong way round
  Off,       ///< boundary vertices or faces that are not on psi = 0
  Filled,    ///< a gap that the mesh closes so that its boundary is a manifold
  Cut,       ///< a part of the body that it leaves away for the same reason
  Thin,      ///< body or gap thinner than an edge that it lacks
  Topology,  ///< pieces or handles of psi = 0 that it does not have
  Missed,    ///< samples that psi = 0 passes by and the mesh does not
};

/// As documents and flags have it: "folded", "off", "filled", "cut", "thin", "topology", "missed".
const char* to_string(PlaceKind kind);
/// \return none for a word that is no kind
std::optional<PlaceKind> place_kind_of(const std::string& word);

/// A place where a mesh is not psi = 0.
struct MeshPlace {
  PlaceKind kind = PlaceKind::Off;
  Vec3 where = Vec3::Zero();  ///< where it is farthest off; model coordinates
  double off_over_h = 0;      ///< between psi = 0 and the boundary of the mesh
  double size_over_h = 0;     ///< diagonal of the box around all of it
  /// How small psi = 0 is there: the least of the distance to the other sheet, through the body or through the gap, and
  /// the smallest diameter of curvature. None where neither is below two edges.
  std::optional<double> feature_over_h{};
  std::optional<double> h_needed{};  ///< that shows such a feature, model units
  std::size_t n = 1;                 ///< of its vertices, faces, points or samples
};

/// Where psi = 0 is finer than h can show, a mesh of this h may be this far off, in h, however large the place is ...
inline constexpr double kSmallOff = .5;
/// ... and the end of a thin part may be missing as far as this. Elsewhere no small place is deeper ...
inline constexpr double kSmallLoss = 1;
/// ... or larger, as the diagonal of a box in h: the faces around one vertex are 2 h across, and the box around a disc
/// of that diameter has a diagonal of 2 sqrt(2) h at most.
inline constexpr double kSmallSize = 2.83;

/// A small place is a defect that is named, and the mesh passes. It is no deeper than h and no larger than the faces
/// around one vertex, or psi = 0 is finer there than h can show. A difference in topology has no size: only the second
/// makes it small.
bool is_small(const MeshPlace& place);

/// The places of a mesh, as a document has them.
struct PlaceReport {
  struct OfKind {
    PlaceKind kind;
    std::size_t n = 0, n_small = 0;
    MeshPlace worst;  ///< the farthest off, of those that are not small if there are any
    double max_off_over_h = 0;
  };
  std::vector<OfKind> kinds{};  ///< those that there are, in the order of PlaceKind
  std::vector<MeshPlace>
      listed{};  ///< at most kListedPlaces of them: first those that are not small, the farthest off first

  bool empty() const { return kinds.empty(); }
  std::size_t n() const;
};

/// Places that a document lists. All are counted.
inline constexpr std::size_t kListedPlaces = 100;

/// Sorts the places as they are to be listed.
PlaceReport report_on(std::vector<MeshPlace>& places);

}  // namespace umtet
