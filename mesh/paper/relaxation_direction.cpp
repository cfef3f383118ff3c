#include "mesh/paper/relaxation_direction.h"

#include <cmath>

namespace umtet {
namespace {

// splitmix64's finaliser: every input bit reaches every output bit        [Steele2014]
std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

constexpr std::uint64_t kGoldenGamma = 0x9e3779b97f4a7c15ULL;  // splitmix64's increment

}  // namespace

Vec3 random_unit_vector(std::uint64_t seed, std::uint64_t iteration, std::int64_t vertex) {
  std::uint64_t state = mixed(seed + kGoldenGamma);
  state = mixed(state ^ (iteration + kGoldenGamma));
  state = mixed(state ^ (static_cast<std::uint64_t>(vertex) + kGoldenGamma));
  const auto next = [&] {
    state += kGoldenGamma;
    return static_cast<double>(mixed(state) >> 11) * 0x1p-52 - 1;  // [-1, 1)
  };
  for (;;) {  // rejection from the cube: half of the draws are in the ball
    const double x = next(), y = next(), z = next();
    const double r2 = x * x + y * y + z * z;
    if (r2 < 1 && r2 > 1e-4) return Vec3(x, y, z) / std::sqrt(r2);
  }
}

Vec3 relaxation_direction(DirectionRule rule, std::uint64_t seed, int iteration, std::int64_t vertex) {
  if (rule == DirectionRule::AxesInTurn) return Vec3::Unit(iteration % 3);
  return random_unit_vector(seed, static_cast<std::uint64_t>(iteration), vertex);
}

}  // namespace umtet
