#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/background/tiling.h"

namespace umtet {

/// Which vertices of a link are inside: bit k belongs to link vertex k.
using LinkMask = std::uint64_t;
inline constexpr int kMaxLink = 64;

/// What the classification of a vertex's link says about the vertex.
struct LinkState {
  /// Inside and outside part of the link are connected and not empty: the vertex may be flipped, and neither {inside}
  /// nor {outside} changes its homotopy type [KongRosenfeld1989; Bertrand1994].
  bool simple = false;
  /// For an outside vertex: the tets with an inside vertex fill a half-ball around it, whose boundary is a disc of
  /// positive faces and nothing else; no face there is positive from both sides.
  bool manifold = false;
  std::uint8_t n_positive_faces = 0;  ///< bv: link triangles with exactly one inside vertex
  std::uint8_t n_tets = 0;            ///< nt: link triangles with an inside vertex
};

/// The link of a vertex, a triangulated sphere (on the background boundary a disc), as bit masks: that of all vertices
/// of a type.
struct LinkTopology {
  int n = 0;                                  ///< vertices; in a tiling in the order of TilingTables::link
  std::vector<LinkMask> adjacent;             ///< per link vertex: those that share an edge of the link with it
  std::array<std::uint8_t, kMaxLink> back{};  ///< the number of the vertex itself in the link of k
  std::vector<std::array<std::uint8_t, 3>> triangles;  ///< with the vertex in front: positively oriented tets
  std::vector<LinkState> states;                       ///< one per mask; empty where they would be too many
  /// Vertex types with the same table of states up to the order of the link share this number: sites of one symmetry
  /// have the same number of link vertices and of triangles. Outside of lattices it is the number of link vertices.
  int site = 0;

  /// Unit of the lengths in ClassificationParams at such a vertex, in h of the background.
  float unit = 1;

  LinkMask full() const { return n == 0 ? 0 : ~LinkMask{0} >> (kMaxLink - n); }
  LinkState state(LinkMask inside) const { return states.empty() ? find_state(inside) : states[inside]; }
  LinkState find_state(LinkMask inside) const;
};

/// One per vertex type.
/// \throw std::invalid_argument for a link of more than kMaxLink vertices
std::vector<LinkTopology> link_topology(const Tiling& tiling, const TilingTables& tables);

/// That of a15(), made once.
const std::vector<LinkTopology>& a15_links();

}  // namespace umtet
