#include "mesh/sizes/graded_size.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"

namespace umtet {
namespace {

// BCC tets: of a cube.
constexpr double kTetsPerLeaf = 12;
// Balance and the layer outside add this share to what leaves inside have, for bodies of 40,000 to 600,000 tets.
constexpr double kMore = 1.25;

struct Cube {
  Vec3 centre;
  double half;
};

}  // namespace

double cube_size(const SizeField& sizes, const Vec3& centre, double half_width) {
  const double middle = sizes.at(centre);
  // Where the cube is split anyway the least in it does not matter.
  if (kBccMeanEdge * 2 * half_width > kSizeTolerance * middle) return middle;
  return std::min(middle, kMostAboveLeast * sizes.least_in(centre, half_width));
}

double expected_graded_tets(const SizeField& sizes, double finest, ImplicitFunctionRef psi, const Box& box,
                            double steepest, const Context& context) {
  if (box.isEmpty() || !box.sizes().allFinite()) throw std::invalid_argument("box: must be finite and not empty");
  if (!(finest > 0)) throw std::invalid_argument("finest = " + std::to_string(finest) + ": must be > 0");
  double width = finest / kBccMeanEdge;
  while (width < box.sizes().maxCoeff()) width *= 2;
  const double least = 1.5 * finest / kBccMeanEdge;  // wider cubes may be split
  std::vector<Cube> cubes = {{box.center(), width / 2}};
  std::size_t n_inside = 0;
  for (; !cubes.empty(); width /= 2) {
    enum : std::uint8_t { Out, Leaf, Split };
    std::vector<std::uint8_t> what(cubes.size(), Out);
    for_each_asking(psi, cubes.size(), kValuesPerPoll, context, [&](std::size_t i) {
      const auto& [x, half] = cubes[i];
      const double value = psi.value(x);
      const bool meets_box = ((x - box.center()).cwiseAbs() - .5 * box.sizes()).maxCoeff() < half;
      if (!meets_box || value > steepest * std::sqrt(3.) * half) return;
      if (width > least && kBccMeanEdge * width > kSizeTolerance * cube_size(sizes, x, half)) {
        what[i] = Split;
      } else if (value < 0) {
        what[i] = Leaf;
      }
    });
    std::vector<Cube> next;
    for (std::size_t i = 0; i < cubes.size(); ++i) {
      n_inside += what[i] == Leaf;
      if (what[i] != Split) continue;
      const double half = cubes[i].half / 2;
      for (int k = 0; k < 8; ++k) {
        next.push_back({cubes[i].centre + half * Vec3((k & 1) ? 1 : -1, (k & 2) ? 1 : -1, (k & 4) ? 1 : -1), half});
      }
    }
    cubes = std::move(next);
  }
  return kMore * kTetsPerLeaf * static_cast<double>(n_inside);
}

}  // namespace umtet
