#include "mesh/sizes/size_function.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "common/polled_loops.h"

namespace umtet {
namespace {

constexpr int kCubes = 64;
// Differences along edges and diagonals see at least this share of a gradient: the directions of two of them are at
// most 35 degrees apart.
constexpr double kSeen = .8;
// How far off the end of a steep place is, in h there: the field is wrong by sqrt(3) / 2 grade times that.
constexpr double kWidest = .5;
// Of h at a corner: with more it is far from all cones, with less it is limited by another one; a tree answers to 5 %.
constexpr double kSame = 1 + 1e-9, kLimited = .95;

/// A cube with the values at its corners; corner k is at the low end of axis a where bit a of k is 0.
struct SizeCube {
  Vec3 low;
  double width;
  std::array<double, 8> h;
  Vec3 corner(int k) const { return low + width * Vec3(k & 1, (k >> 1) & 1, (k >> 2) & 1); }
};

class Sampling {
 public:
  Sampling(const SizeFunction& f, double grade, double h_min, double h_max, const Context& context)
      : f_(f), grade_(grade), h_min_(h_min), h_max_(h_max), context_(context) {}

  std::vector<SizeSource> ends() {
    for (std::vector<SizeCube> cubes = coarse(); !cubes.empty(); cubes = halved(at_ends(cubes))) add_lower_ends(cubes);
    return tree_.sources();
  }

 private:
  double value(const Vec3& x) const {
    const double h = f_.h(x);
    return std::isnan(h) ? h_max_ : std::clamp(h, h_min_, h_max_);
  }

  std::vector<SizeCube> coarse() const {
    const double width = f_.box.sizes().maxCoeff() / kCubes;
    const Eigen::Array3i n = (f_.box.sizes().array() / width - 1e-9).ceil().cast<int>().max(1);
    const Eigen::Array3i m = n + 1;
    std::vector<double> values(static_cast<std::size_t>(m.prod()));
    const auto at = [&](int i, int j, int k) {
      return static_cast<std::size_t>(i) + m.x() * (j + m.y() * static_cast<std::size_t>(k));
    };
    polled_parallel_for(static_cast<std::size_t>(m.z()), 1, context_, [&](std::size_t k) {
      const int z = static_cast<int>(k);
      tbb::parallel_for(0, m.y(), [&](int j) {
        for (int i = 0; i < m.x(); ++i) values[at(i, j, z)] = value(f_.box.min() + width * Vec3(i, j, z));
      });
    });
    std::vector<SizeCube> cubes;
    cubes.reserve(static_cast<std::size_t>(n.prod()));
    for (int k = 0; k < n.z(); ++k) {
      for (int j = 0; j < n.y(); ++j) {
        for (int i = 0; i < n.x(); ++i) {
          SizeCube& c = cubes.emplace_back(SizeCube{f_.box.min() + width * Vec3(i, j, k), width, {}});
          for (int v = 0; v < 8; ++v) c.h[v] = values[at(i + (v & 1), j + ((v >> 1) & 1), k + (v >> 2))];
        }
      }
    }
    return cubes;
  }

  /// Corners from which f rises too steeply to another one, into the tree.
  void add_lower_ends(const std::vector<SizeCube>& cubes) {
    std::vector<SizeSource> ends = tree_.sources();
    for (const SizeCube& c : cubes) {
      const auto [least, most] = std::minmax_element(c.h.begin(), c.h.end());
      if (*most - *least <= kSeen * grade_ * c.width) continue;
      for (int a = 0; a < 8; ++a) {
        bool is_low = true, is_steep = false;  // none of the others limits it; it limits one of them
        for (int b = 0; b < 8; ++b) {
          const double grown = grade_ * (c.corner(b) - c.corner(a)).norm();
          is_steep |= c.h[b] - c.h[a] > kSeen * grown;
          is_low &= c.h[a] - c.h[b] <= grown;
        }
        if (is_steep && is_low) ends.push_back({c.corner(a), c.h[a]});
      }
    }
    tree_ = SourceTree(undominated(std::move(ends), grade_, context_), grade_);
  }

  /// Those with a corner that limits what is around it, if they are not small enough.
  std::vector<SizeCube> at_ends(const std::vector<SizeCube>& cubes) const {
    std::vector<std::uint8_t> is_end(cubes.size());
    polled_parallel_for(cubes.size(), kValuesPerPoll, context_, [&](std::size_t i) {
      const SizeCube& c = cubes[i];
      if (c.width <= kWidest * *std::min_element(c.h.begin(), c.h.end())) return;
      for (int v = 0; v < 8 && is_end[i] == 0; ++v) {
        const double at = tree_.at(c.corner(v), h_min_, kSame * c.h[v]);
        is_end[i] = at >= kLimited * c.h[v] && at <= c.h[v] ? 1 : 0;
      }
    });
    std::vector<SizeCube> ends;
    for (std::size_t i = 0; i < cubes.size(); ++i) {
      if (is_end[i]) ends.push_back(cubes[i]);
    }
    return ends;
  }

  std::vector<SizeCube> halved(const std::vector<SizeCube>& cubes) const {
    std::vector<SizeCube> halves(8 * cubes.size());
    polled_parallel_for(cubes.size(), kValuesPerPoll / 27, context_, [&](std::size_t i) {
      const double width = cubes[i].width / 2;
      std::array<double, 27> h{};
      for (int k = 0; k < 27; ++k) h[k] = value(cubes[i].low + width * Vec3(k % 3, (k / 3) % 3, k / 9));
      for (int c = 0; c < 8; ++c) {
        SizeCube& half = halves[8 * i + c];
        half = {cubes[i].low + width * Vec3(c & 1, (c >> 1) & 1, c >> 2), width, {}};
        for (int v = 0; v < 8; ++v) {
          half.h[v] = h[(c & 1) + (v & 1) + 3 * (((c >> 1) & 1) + ((v >> 1) & 1)) + 9 * ((c >> 2) + (v >> 2))];
        }
      }
    });
    return halves;
  }

  const SizeFunction& f_;
  const double grade_, h_min_, h_max_;
  const Context& context_;
  SourceTree tree_;
};

}  // namespace

std::vector<SizeSource> steep_ends(const SizeFunction& f, double grade, double h_min, double h_max,
                                   const Context& context) {
  if (f.box.isEmpty() || !f.box.sizes().allFinite()) throw std::invalid_argument("box: must be finite and not empty");
  return Sampling(f, grade, h_min, h_max, context).ends();
}

}  // namespace umtet
