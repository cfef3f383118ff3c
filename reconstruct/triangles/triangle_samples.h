#pragma once

#include <cstdint>
#include <vector>

#include "common/context.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

struct TriangleSamples {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> faces;  ///< the triangle of each
};

/// Samples that are evenly spread and nowhere in a row: darts thrown at the triangles in proportion to their area stay
/// where no earlier one is nearer than a radius [Cook1986]. Sheets that look away from each other do not see each
/// other's darts, so that both sides of a thin wall are sampled alike.
///
/// @param spacing  of samples: their number is about area / spacing^2
/// @param seed     of the darts; the same bytes at every call
/// \throw std::invalid_argument  no area, spacing not > 0, or more than 2^31 darts; Cancelled
/// Cost: some darts a sample, a microsecond a dart.
TriangleSamples sample_triangles(const TriangleMesh& mesh, double spacing, std::uint64_t seed = 0,
                                 const Context& context = {});

}  // namespace umtet
