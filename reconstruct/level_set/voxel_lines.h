#pragma once

#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace umtet {

/// A line of values through a grid, with stride.
template <class T>
struct VoxelLine {
  T* at;
  std::ptrdiff_t stride;
  int n;
  T& operator[](int i) const { return at[i * stride]; }
};

/// Calls f(line) for all lines along an axis of a grid of n values, first axis fastest. Threads work on different
/// lines.
template <class T, class F>
void for_each_line(std::vector<T>& values, const Eigen::Vector3i& n, int axis, const F& f) {
  const std::ptrdiff_t nx = n[0], nxy = nx * n[1];
  const std::ptrdiff_t stride = axis == 0 ? 1 : axis == 1 ? nx : nxy;
  const std::ptrdiff_t fast = axis == 0 ? nx : 1, slow = axis == 2 ? nx : nxy;
  const int n_fast = axis == 0 ? n[1] : n[0], n_slow = axis == 2 ? n[1] : n[2];
  tbb::parallel_for(0, n_slow, [&](int s) {
    for (int k = 0; k < n_fast; ++k) f(VoxelLine<T>{values.data() + s * slow + k * fast, stride, n[axis]});
  });
}

}  // namespace umtet
