#pragma once

#include <cstddef>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"

namespace umtet {

/// A map of the blocks of a box that contain no zero of a function with |grad f| <= 1. A block is free of zeros if |f|
/// at its centre is greater than the distance to its corners. The map costs one value of f for each block.
class ZeroFreeBlocks {
 public:
  /// @param box    region of the map; points outside count as near a zero
  /// @param reach  model units
  /// \throw Cancelled
  ZeroFreeBlocks(ImplicitFunctionRef f, const Box& box, double reach, const Context& context = {});
  /// True only if f has no zero within `reach` of x along every axis. Thread-safe.
  bool operator()(const Vec3& x) const;

 private:
  Vec3 origin_;
  double edge_;
  Eigen::Array3i n_;  ///< blocks per axis
  std::vector<char> is_free_;
};

}  // namespace umtet
