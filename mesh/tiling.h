#pragma once

#include <array>
#include <string>
#include <vector>

namespace umtet {

/// An acute, periodic tiling of space by tets as exact data: cell edge 1, all coordinates dyadic or given.
struct Tiling {
  struct Corner {
    int type;                   ///< which of the points of the cell
    std::array<int, 3> offset;  ///< in which cell, relative to the tet's
  };
  std::string name;
  std::vector<std::array<double, 3>> points;  ///< one per vertex type, in cell units
  std::vector<std::array<Corner, 4>> tets;    ///< positively oriented; offsets in -1 .. 1
  double mean_edge = 0;                       ///< mean edge length in cell units
  /// Every vertex is where the worst quality of its ring is greatest, along any line: relaxing it moves nothing. In A15
  /// the symmetry of the sites says so (m-3 and -42m fix no other point, and the optimum is unique).
  bool rings_are_optimal = false;
};

/// Stencil 1 of the paper: A15 (Pm-3n), 8 vertices and 46 tets a cell, dihedral angles 53.13-78.46 degrees.
/// Sites 2a + 6c of the A15 structure with their periodic Delaunay tets [Sullivan1998; Eppstein2004].
/// A tet belongs to the cell that holds its barycentre, so the tets of a block of cells leave pits and bumps of a
/// quarter cell at its walls.
const Tiling& a15();

/// Who meets whom in a tiling, per vertex type and per tet of the cell. Lists are sorted by (z, y, x) of the cell, then
/// by type or tet: with x-fastest numbering of the cells, ids read off them ascend whatever the size of the lattice.
struct TilingTables {
  struct TetCorner {
    int tet;                    ///< tet of the cell
    std::array<int, 3> offset;  ///< of its cell, relative to the vertex's
  };
  struct TetFace {
    int tet;
    std::array<int, 3> offset;  ///< of its cell, relative to the first tet's
  };
  std::vector<std::vector<TetCorner>> star;       ///< per vertex type: the tets that have it as a corner
  std::vector<std::vector<Tiling::Corner>> link;  ///< per vertex type: the vertices it shares an edge with
  std::vector<std::array<TetFace, 4>> neighbor;   ///< per tet: the tet behind the face opposite to each corner
};

/// \throw std::invalid_argument if some face does not have exactly two tets (not a tiling of space).
TilingTables tables(const Tiling&);

}  // namespace umtet
