#include "body/pieces/zero_free_blocks.h"

#include <cmath>

#include "common/polled_loops.h"

namespace umtet {
namespace {

// Edge of a block, in reaches: a count on a grid evaluates f at most once in 512 nodes far from the surface, and near
// it at the nodes within two blocks.
constexpr double kEdge = 8;
constexpr std::size_t kBlocksPerPoll = 256;

}  // namespace

ZeroFreeBlocks::ZeroFreeBlocks(ImplicitFunctionRef f, const Box& box, double reach, const Context& context)
    : origin_(box.min()), edge_(kEdge * reach), n_((box.sizes().array() / edge_).ceil().cast<int>().max(1)) {
  const std::size_t row = static_cast<std::size_t>(n_[0]), layer = row * static_cast<std::size_t>(n_[1]);
  is_free_.resize(layer * static_cast<std::size_t>(n_[2]));
  const double needed = std::sqrt(3.) * (edge_ / 2 + reach);
  polled_parallel_for(is_free_.size(), kBlocksPerPoll, context, [&](std::size_t b) {
    const std::size_t in_layer = b % layer, i = in_layer % row, j = in_layer / row, k = b / layer;
    const Eigen::Array3d at(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
    is_free_[b] = std::abs(f.value(origin_ + (edge_ * (at + .5)).matrix())) > needed ? 1 : 0;
  });
}

bool ZeroFreeBlocks::operator()(const Vec3& x) const {
  const Eigen::Array3d at = ((x - origin_) / edge_).array().floor();
  if (!((at >= 0).all() && (at < n_.cast<double>()).all())) return false;
  const Eigen::Array3i b = at.cast<int>();
  return is_free_[static_cast<std::size_t>(b[0]) +
                  static_cast<std::size_t>(n_[0]) *
                      (static_cast<std::size_t>(b[1]) +
                       static_cast<std::size_t>(n_[1]) * static_cast<std::size_t>(b[2]))] != 0;
}

}  // namespace umtet
