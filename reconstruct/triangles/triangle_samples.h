#pragma once

#include <cstdint>
#include <vector>

#include "common/context.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Samples of triangles.
struct TriangleSamples {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> faces;  ///< the triangle of each point
};

/// Poisson-disc sampling of triangles: evenly spread samples without rows. Darts are thrown at the triangles in
/// proportion to their area, and are kept if no earlier one is within a radius [Cook1986]. Darts on sheets that face
/// away from each other do not interact, so that both sides of a thin wall are sampled alike.
///
/// @param spacing  spacing of the samples: their number is about area / spacing^2
/// @param seed     seed of the darts; every call gives the same bytes
/// \throw std::invalid_argument for no area, a spacing that is not > 0, or more than 2^31 darts; Cancelled
/// Cost: some darts per sample, a microsecond per dart.
TriangleSamples sample_triangles(const TriangleMesh& mesh, double spacing, std::uint64_t seed = 0,
                                 const Context& context = {});

}  // namespace umtet
