#pragma once

#include <memory>
#include <optional>

#include "mesh/io/tet_mesh_io.h"
#include "body/body.h"
#include "reconstruct/cloud/cloud_neighbours.h"
#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/level_set/level_set.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

struct MeshWithBoundary;

/// What the stages of a run leave in memory for those after them: bit by bit what their files hold, which so need not
/// be read back. Empty where a stage had been done before.
struct Handover {
  std::optional<OrientedPointCloud> cloud;        ///< cloud.ply
  std::optional<TriangleMesh> triangles;          ///< triangles.ply
  NeighbourDistances near;                        ///< of its points, or empty
  std::optional<LevelSet> psi;                    ///< level_set.vti
  std::optional<Domain> domain;                   ///< what was meshed, psi cut for h
  MeshFile mesh;                                  ///< mesh.vtu, beside the domain
  std::shared_ptr<const MeshWithBoundary> parts;  ///< in the place of both, of a mesh that several processes have
};

}  // namespace umtet
