#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "body/thin_place.h"
#include "common/vec3.h"

namespace umtet {

/// How a valid mesh differs from psi = 0.
enum class DefectKind {
  Folded,    ///< boundary faces lie on psi = 0 the wrong way round
  Off,       ///< boundary vertices or faces are not on psi = 0
  Filled,    ///< the mesh closes a gap so that its boundary is a manifold
  Cut,       ///< the mesh omits a part of the body for the same reason
  Thin,      ///< the mesh lacks a body or a gap that is thinner than an edge
  Topology,  ///< the mesh lacks pieces or handles of psi = 0
  Missed,    ///< the mesh misses samples that psi = 0 passes
  Edges,     ///< the mesh lacks a sharp edge or a corner of the body
};

/// The word that documents and flags use: "folded", "off", "filled", "cut", "thin", "topology", "missed",
/// "edges".
const char* to_string(DefectKind kind);
/// Returns nothing if the word is not a kind.
std::optional<DefectKind> defect_kind_of(const std::string& word);

/// A connected part of the boundary that differs from psi = 0.
struct MeshDefect {
  DefectKind kind = DefectKind::Off;
  Vec3 where = Vec3::Zero();  ///< the point that is farthest off; model coordinates
  double off_over_h = 0;      ///< largest distance between psi = 0 and the boundary of the mesh
  double size_over_h = 0;     ///< diagonal of the box around the defect
  /// The size of the feature of psi = 0 there: the least of the distance to the other sheet, through the body or the
  /// gap, and of the smallest diameter of curvature. Empty if both are two edges or more.
  std::optional<double> feature_over_h{};
  std::optional<double> h_needed{};  ///< the edge length that shows such a feature, model units
  std::size_t n = 1;                 ///< number of its vertices, faces, points or samples
};

/// Where psi = 0 is finer than h can show, a small defect is at most this far off, in h, whatever its size.
inline constexpr double kSmallOff = .5;
/// A missing end of a thin part is at most this long, in h; elsewhere a small defect is at most this deep.
inline constexpr double kSmallLoss = 1;
/// The box around a small defect has at most this diagonal, in h: the faces around one vertex are 2 h across, and the
/// box around a disc of that diameter has a diagonal of 2 sqrt(2) h at most.
inline constexpr double kSmallSize = 2.83;

/// A small defect is named, and the mesh passes. It is no deeper than h and no larger than the faces
/// around one vertex, or psi = 0 is finer there than h can show. A difference in topology has no size: only the second
/// makes it small.
bool is_small(const MeshDefect& defect);

/// The defects of a mesh, by kind, as a document lists them.
struct DefectReport {
  struct OfKind {
    DefectKind kind;
    std::size_t n = 0, n_small = 0;
    MeshDefect worst;  ///< the farthest off, among those that are not small if there are any
    double max_off_over_h = 0;
  };
  std::vector<OfKind> kinds{};  ///< the kinds that occur, in the order of DefectKind
  /// At most kListedDefects: first those that are not small, the farthest off first.
  std::vector<MeshDefect> listed{};

  bool empty() const { return kinds.empty(); }
  std::size_t n() const;
};

/// The number of defects that a document lists; it counts all.
inline constexpr std::size_t kListedDefects = 100;

/// Sorts the defects as documents list them.
DefectReport report_on(std::vector<MeshDefect>& defects);

}  // namespace umtet
