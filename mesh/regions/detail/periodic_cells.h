#pragma once

#include <array>
#include <cstdint>

#include "mesh/background/background_mesh.h"

namespace umtet::detail {

/// Cells of a lattice whose opposite sides are one: a torus. The lattice has a layer of further cells around them,
/// where each vertex is the copy of one in the cells.
class PeriodicCells {
 public:
  /// Layers of cells around the periodic ones: the tets at a vertex reach into the next cell.
  static constexpr int kLayers = 2;

  /// @param lattice  must outlive this
  /// @param n        periodic cells along each axis, lattice.n_cells() - 2 kLayers
  PeriodicCells(const BackgroundMesh& lattice, const BackgroundMesh::Cell& n) : lattice_(&lattice), n_(n) {}

  /// The vertex in the periodic cells of which v is a copy.
  std::int64_t representative(std::int64_t v) const;
  bool is_representative(std::int64_t v) const { return representative(v) == v; }
  /// How many periods v is away from its representative, along each axis.
  std::array<int, 3> copy(std::int64_t v) const;

 private:
  const BackgroundMesh* lattice_;
  BackgroundMesh::Cell n_;
};

}  // namespace umtet::detail
