#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/tiling.h"

namespace umtet {

/// A link has at most this many vertices, so that a labelling of it fits a 16-bit mask.
inline constexpr int kMaxLink = 16;

/// What the inside labels of a vertex's link say about the vertex; bit k of a mask belongs to link vertex k.
struct LinkState {
  /// Inside and outside part of the link are connected and not empty: the label of the vertex may change and neither
  /// {inside} nor {outside} changes its homotopy type.
  bool simple = false;
  /// For an outside vertex: the tets with an inside vertex fill a half-ball around it, whose boundary is a disc of
  /// positive faces and nothing else; no face there is positive from both sides.
  bool manifold = false;
  std::uint8_t n_positive_faces = 0;  ///< bv: link triangles with exactly one inside vertex
  std::uint8_t n_tets = 0;            ///< nt: link triangles with an inside vertex
};

/// The link of a vertex type of a tiling, a triangulated sphere, as bit masks, and the state of all its labellings.
struct LinkTopology {
  int n = 0;                                           ///< vertices; in the order of TilingTables::link
  std::array<std::uint16_t, kMaxLink> adjacent{};      ///< link vertices that share an edge of the link with k
  std::array<std::uint8_t, kMaxLink> back{};           ///< the number of the vertex itself in the link of k
  std::vector<std::array<std::uint8_t, 3>> triangles;  ///< with the vertex in front: positively oriented tets
  std::vector<LinkState> states;                       ///< one per mask
  /// Vertex types with the same table of states up to the order of the link share this number: sites of one symmetry
  /// have the same number of link vertices and of triangles.
  int site = 0;

  std::uint16_t full() const { return static_cast<std::uint16_t>((1u << n) - 1); }
};

/// One per vertex type.
/// \throw std::invalid_argument for a link of more than kMaxLink vertices
std::vector<LinkTopology> link_topology(const Tiling& tiling, const TilingTables& tables);

/// That of a15(), made once.
const std::vector<LinkTopology>& a15_links();

}  // namespace umtet
