#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/background/tiling.h"

namespace umtet {

/// Set of inside vertices of a link: bit k belongs to link vertex k.
using LinkMask = std::uint64_t;
inline constexpr int kMaxLink = 64;

/// Properties of a vertex that follow from the states of its link.
struct LinkState {
  /// The vertex is a simple point: the inside and outside parts of the link are connected and not empty. It may be
  /// flipped without a change of the homotopy type of {inside} or {outside} [KongRosenfeld1989; Bertrand1994].
  bool simple = false;
  /// For an outside vertex: the tets with an inside vertex fill a half-ball around it, whose boundary at the vertex is
  /// a disc made of positive faces only; no face there is positive from both sides.
  bool manifold = false;
  std::uint8_t n_positive_faces = 0;  ///< bv: link triangles with exactly one inside vertex
  std::uint8_t n_tets = 0;            ///< nt: link triangles with an inside vertex
};

/// The link of a vertex as bit masks: a triangulated sphere, or a disc on the background boundary. All vertices of a
/// type share it.
struct LinkTopology {
  int n = 0;                       ///< number of vertices; in a tiling they are in the order of TilingTables::link
  std::vector<LinkMask> adjacent;  ///< per link vertex: its neighbours along edges of the link
  std::array<std::uint8_t, kMaxLink> back{};           ///< index of the vertex itself in the link of link vertex k
  std::vector<std::array<std::uint8_t, 3>> triangles;  ///< each with the vertex in front is a positively oriented tet
  std::vector<LinkState> states;                       ///< one per mask; empty if there would be too many
  /// Index of the table of states: vertex types with the same table, up to the order of the link, share it. Sites of
  /// one symmetry have the same number of link vertices and of triangles. Outside of lattices it is the number of link
  /// vertices.
  int site = 0;

  /// Unit of the lengths in ClassificationParams at such a vertex, relative to h of the background.
  float unit = 1;

  LinkMask full() const { return n == 0 ? 0 : ~LinkMask{0} >> (kMaxLink - n); }
  LinkState state(LinkMask inside) const { return states.empty() ? find_state(inside) : states[inside]; }
  LinkState find_state(LinkMask inside) const;
  /// Whether these vertices are connected by edges of the link. False for none.
  bool is_connected(LinkMask part) const;
};

/// The link topologies of a tiling, one per vertex type.
/// \throw std::invalid_argument for a link of more than kMaxLink vertices
std::vector<LinkTopology> link_topology(const Tiling& tiling, const TilingTables& tables);

/// The link topologies of a15(), computed once.
const std::vector<LinkTopology>& a15_links();

}  // namespace umtet
