#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/implicit/zero_set.h"
#include "reconstruct/level_set/sign_cells.h"

namespace umtet {

/// Where sign cells leave no room for a zero: one byte for each cube of a box whose edge is the reach or more.
class ZeroFreeMap {
 public:
  /// @param box    places outside count as near a zero; within psi's domain
  /// @param reach  model units
  ZeroFreeMap(const SignCells& cells, const Eigen::AlignedBox3d& box, double reach);
  /// True only if psi has no zero within `reach` of x along every axis. Thread-safe.
  bool operator()(const Vec3& x) const;

 private:
  std::size_t index(const Eigen::Array3i& cube) const {
    return cube[0] + static_cast<std::size_t>(n_[0]) * (cube[1] + static_cast<std::size_t>(n_[1]) * cube[2]);
  }
  Eigen::AlignedBox3d inner_;  ///< whose places have all their reach in the box
  Vec3 origin_;
  double size_;
  Eigen::Array3i first_, n_;  ///< of the cubes that cover the box
  std::vector<std::uint8_t> near_;
};

/// What the sign bounds of a level set say about a count of its pieces on a grid.
struct ComponentProof {
  std::vector<Vec3> unseen;  ///< a point near each piece of psi = 0 that the count has missed: smaller than its grid
  std::size_t n_open = 0;    ///< places where the bounds leave open whether psi is zero; 0: the list is complete
};

/// Looks for pieces of psi = 0 that a count does not know. Every zero lies in one of sign_cells(); a group of touching
/// cells without a point of a counted piece either holds a piece of its own, or none: then finer cells say so.
/// @param box    of the count
/// @param cells  of psi; an edge of h / 2 is cheap. A piece that touches the cells of a counted one is taken for part
///               of it.
ComponentProof prove_components(const LevelSet& psi, const Eigen::AlignedBox3d& box, const ZeroSetTopology& counted,
                                const SignCells& cells);

}  // namespace umtet
