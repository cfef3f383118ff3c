#pragma once

#include <cstdint>
#include <random>

#include "data/shapes.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Uniform doubles in [0, 1), the same everywhere: the standard fixes the generator, not its distributions.
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : generator_(seed) {}
  double operator()() { return static_cast<double>(generator_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 generator_;
};

/// Points per area at x, up to a factor; in (0, 1].
using Density = double (*)(const Vec3& x);
inline double uniform_density(const Vec3&) { return 1; }

/// n points of {f = 0} within 1e-12, evenly spread like Poisson discs, with unit outward normals.
///
/// Many random surface points, then elimination of the most crowded ones [Yuksel2015].
/// @param low, high  a box that contains the surface
/// \throw std::runtime_error  grad f vanishes near the surface, or the surface is not within the box
OrientedPointCloud sample_surface(ShapeFunction f, const Vec3& low, const Vec3& high, std::size_t n, std::uint64_t seed,
                                  Density density = uniform_density);

}  // namespace umtet
