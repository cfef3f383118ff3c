#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/implicit/zero_set.h"
#include "reconstruct/level_set/sign_cells.h"

namespace umtet {

/// A map of the regions that contain no zero of psi, by the sign cells. It stores one byte for each cube of a regular
/// grid over a box; the edge of a cube is at least `reach`.
class ZeroFreeMap {
 public:
  /// @param box    region of the map, within psi's domain; points outside count as near a zero
  /// @param reach  model units
  ZeroFreeMap(const SignCells& cells, const Eigen::AlignedBox3d& box, double reach);
  /// True only if psi has no zero within `reach` of x along every axis. Thread-safe.
  bool operator()(const Vec3& x) const;

 private:
  std::size_t index(const Eigen::Array3i& cube) const {
    return cube[0] + static_cast<std::size_t>(n_[0]) * (cube[1] + static_cast<std::size_t>(n_[1]) * cube[2]);
  }
  Eigen::AlignedBox3d inner_;  ///< the points whose distance to the sides of the box is at least `reach`
  Vec3 origin_;
  double size_;
  Eigen::Array3i first_, n_;  ///< first cube and number of cubes, per axis
  std::vector<std::uint8_t> near_;
};

/// Result of a check, by sign bounds, of the pieces of a level set that were counted on a grid.
struct ComponentProof {
  /// A point near each piece of psi = 0 that the count missed, because the piece is smaller than the grid.
  std::vector<Vec3> unseen;
  /// Number of groups of cells for which the bounds do not decide whether psi has a zero; 0: `unseen` is complete.
  std::size_t n_open = 0;
};

/// Searches for pieces of psi = 0 that a count missed. Every zero lies in one of sign_cells(). A group of touching
/// cells without a point of a counted piece either contains another piece or no zero; finer cells decide.
/// @param box    box in which the pieces were counted
/// @param cells  sign cells of psi; an edge of h / 2 is cheap. A piece that touches the cells of a counted piece is
///               considered part of that piece.
ComponentProof prove_components(const LevelSet& psi, const Eigen::AlignedBox3d& box, const ZeroSetTopology& counted,
                                const SignCells& cells);

}  // namespace umtet
