#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace umtet {

/// An acute tiling of space by tets, periodic along the three axes. Its unit of length is its own: a background mesh
/// scales it by the mean edge.
struct Tiling {
  struct Corner {
    int type;                   ///< which of the points of the cell
    std::array<int, 3> offset;  ///< in which cell, relative to the tet's
  };
  std::string name;
  std::vector<std::array<double, 3>> points;  ///< one per vertex type, in 0 .. period
  std::vector<std::array<Corner, 4>> tets;    ///< positively oriented; offsets in -1 .. 1
  double mean_edge = 0;                       ///< mean edge length
  /// Every vertex is where the worst quality of its ring is greatest, along any line: relaxing it moves nothing. In A15
  /// the symmetry of the sites says so (m-3 and -42m fix no other point, and the optimum is unique).
  bool rings_are_optimal = false;
  std::array<double, 3> period = {1, 1, 1};  ///< edges of the cell
  /// omega_h exceeds Omega by a layer, because its tets need only one vertex inside: about this many cell edges of an
  /// A15 of the same h where the sign of psi classifies. Measured on eq. (9) at 20k and 100k tets.
  double excess_layer = .27;
};

/// Stencil 1 of the paper: A15 (Pm-3n), 8 vertices and 46 tets a cell, dihedral angles 53.13-78.46 degrees.
/// Sites 2a + 6c of the A15 structure with their periodic Delaunay tets [Sullivan1998; Eppstein2004].
/// A tet belongs to the cell that holds its barycentre, so the tets of a block of cells leave pits and bumps of a
/// quarter cell at its walls.
const Tiling& a15();

/// Stencil 2: Z, 14 vertices and 80 tets in a rectangular cell 4 x 4 sqrt(3) x 4 (two of the hexagonal ones), dihedral
/// angles 53.13-77.08 degrees, Q >= .960.                                             [Rangarajan2018, Fig. 11]
const Tiling& z_phase();

/// Stencil 3: slabs of thickness 9 in a cell 8 x 4 sqrt(3) x 9 with 40 vertices and 224 tets, dihedral angles
/// 49.58-77.91 degrees, Q >= .905. The planes between cells above each other are planes of the mesh.
const Tiling& acute_slab();

/// Stencil 4: cubes of edge 1 in blocks of 2^3, 1744 vertices and 9608 tets a block, dihedral angles 43.39-87.19
/// degrees, Q >= .626, edges of .08 to .54. The faces of the cubes are planes of the mesh.
const Tiling& acute_cube();

/// "a15", "z", "slab", "cube": the names that tiling_named() knows.
std::span<const std::string_view> tiling_names();
/// \throw std::invalid_argument for another name
const Tiling& tiling_named(std::string_view name);

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

/// The mean over all edges of a period.
double mean_edge(const Tiling&, const TilingTables&);

/// How far the tets of a cell reach beyond its walls, the greatest of both sides along each axis: a block of cells has
/// bumps of that height and pits of that depth there, and flat walls where it is 0.
std::array<double, 3> overhang(const Tiling&);

}  // namespace umtet
