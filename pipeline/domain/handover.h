#pragma once

#include <memory>
#include <optional>

#include "body/body.h"
#include "body/edges/edged_cloud.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/domain/edged_case.h"
#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/level_set/level_set.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

struct MeshWithBoundary;

/// Results that the stages of a run keep in memory for later stages: bit for bit the contents of their files, so the
/// files need not be read back. A field is empty if its stage was already done before the run.
struct Handover {
  std::optional<OrientedPointCloud> cloud;        ///< cloud.ply
  std::optional<TriangleMesh> triangles;          ///< triangles.ply
  NeighbourDistances near;                        ///< distances for the points of the cloud, or empty
  std::optional<LevelSet> psi;                    ///< level_set.vti
  EdgedTriangles edged;                           ///< in the place of psi, if the sharp edges of triangles are kept
  std::optional<EdgedCloud> edged_cloud;          ///< in the place of psi, if the sharp edges of a cloud are kept
  std::optional<Domain> domain;                   ///< the meshed domain, with psi cut for h
  MeshFile mesh;                                  ///< mesh.vtu; set together with the domain
  std::shared_ptr<const MeshWithBoundary> parts;  ///< a distributed mesh, in place of domain and mesh
};

}  // namespace umtet
