#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace umtet {

/// Acute tiling of space by tets, periodic along the three axes. It has its own unit of length; a background mesh
/// scales it by the mean edge length.
struct Tiling {
  struct Corner {
    int type;                   ///< index of a point of the cell
    std::array<int, 3> offset;  ///< cell of the corner, relative to the tet's cell
  };
  std::string name;
  std::vector<std::array<double, 3>> points;  ///< one per vertex type, in 0 .. period
  std::vector<std::array<Corner, 4>> tets;    ///< positively oriented; offsets in -1 .. 1
  double mean_edge = 0;                       ///< mean edge length
  /// Every vertex is at the position of greatest worst quality of its ring along any line, so relaxation does not move
  /// it. In A15 the symmetry of the sites proves it (m-3 and -42m fix no other point, and the optimum is unique).
  bool rings_are_optimal = false;
  std::array<double, 3> period = {1, 1, 1};  ///< edges of the cell
  /// Thickness of the layer by which omega_h exceeds Omega, because its tets need only one vertex inside. It is given
  /// in cell edges of an A15 of the same h, for classification by the sign of psi. Measured on eq. (9) at 20k and 100k
  /// tets.
  double excess_layer = .27;
};

/// Stencil 1 of the paper: A15 (Pm-3n), 8 vertices and 46 tets per cell, dihedral angles 53.13-78.46 degrees. It
/// consists of sites 2a + 6c of the A15 structure with their periodic Delaunay tets [Sullivan1998; Eppstein2004]. A tet
/// belongs to the cell that contains its barycentre, so the tets of a block of cells have pits and bumps of a quarter
/// cell at its walls.
const Tiling& a15();

/// Stencil 2: Z, 14 vertices and 80 tets in a rectangular cell 4 x 4 sqrt(3) x 4 (two hexagonal cells), dihedral angles
/// 53.13-77.08 degrees, Q >= .960.                             [Rangarajan2018, Fig. 11]
const Tiling& z_phase();

/// Stencil 3: slabs of thickness 9 in a cell 8 x 4 sqrt(3) x 9 with 40 vertices and 224 tets, dihedral angles
/// 49.58-77.91 degrees, Q >= .905. The planes between stacked cells are planes of the mesh.
const Tiling& acute_slab();

/// Stencil 4: cubes of edge 1 in blocks of 2^3, 1744 vertices and 9608 tets per block, dihedral angles 43.39-87.19
/// degrees, Q >= .626, edges of .08 to .54. The faces of the cubes are planes of the mesh.
const Tiling& acute_cube();

/// The names that tiling_named() accepts: "a15", "z", "slab", "cube".
std::span<const std::string_view> tiling_names();
/// The tiling with a given name. \throw std::invalid_argument for another name
const Tiling& tiling_named(std::string_view name);

/// Adjacency tables of a tiling, per vertex type and per tet of the cell. Lists are sorted by (z, y, x) of the cell,
/// then by type or tet. With x-fastest numbering of the cells, the resulting ids ascend for any size of the lattice.
struct TilingTables {
  struct TetCorner {
    int tet;                    ///< tet of the cell
    std::array<int, 3> offset;  ///< cell of the tet, relative to the vertex's cell
  };
  struct TetFace {
    int tet;
    std::array<int, 3> offset;  ///< cell of the tet, relative to the first tet's cell
  };
  std::vector<std::vector<TetCorner>> star;       ///< per vertex type: the tets with this corner
  std::vector<std::vector<Tiling::Corner>> link;  ///< per vertex type: the vertices that share an edge with it
  std::vector<std::array<TetFace, 4>> neighbor;   ///< per tet: the tet behind the face opposite to each corner
};

/// Computes the adjacency tables. \throw std::invalid_argument if some face does not have exactly two tets (the tets do
/// not tile space)
TilingTables tables(const Tiling&);

/// Mean edge length, over all edges of a period.
double mean_edge(const Tiling&, const TilingTables&);

/// Distance by which the tets of a cell reach beyond its walls, the greater of both sides along each axis. A block of
/// cells has bumps of this height and pits of this depth at its walls; its walls are flat where it is 0.
std::array<double, 3> overhang(const Tiling&);

}  // namespace umtet
