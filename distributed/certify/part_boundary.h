#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/mesh/distributed_mesh.h"
#include "distributed/mesh/vertex_owners.h"

namespace umtet {

/// Local boundary faces: those of boundary_faces() of the whole mesh that belong to local tets.
struct PartBoundary {
  std::vector<std::int64_t> id;                 ///< 4 tet of the background + local face, ascending
  std::vector<Triangle> triangles;              ///< vertices of the local mesh; oriented outwards
  std::size_t n_overused = 0, n_same_side = 0;  ///< numbers of faults on all ranks
};

/// Returns the id of a face of a local tet: 4 tet of the background + local face.
std::int64_t face_id(const DistributedMesh& mesh, std::size_t tet, const Triangle& face);

/// Finds the boundary faces without trust in how the mesh was made. Faces under a vertex that several ranks share are
/// counted by its owner. Collective.
PartBoundary boundary_of_parts(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners);

/// A connected component of the boundary; pieces that touch in a vertex form one component.
struct BoundaryPiece {
  std::int64_t label;  ///< background id of its least vertex
  std::int64_t n_vertices = 0, n_edges = 0, n_faces = 0;
  std::int64_t first_face;  ///< least id of its faces
  double corner[3];         ///< position of the first corner of that face
};

/// Distributed version of surface_topology(). Members describe the whole boundary unless they refer to local faces or
/// owned vertices.
struct BoundaryTopology {
  std::vector<BoundaryPiece> pieces;  ///< in ascending order of labels
  std::vector<int> piece;             ///< index into `pieces` for each local face
  std::vector<char> is_on_boundary;   ///< flag for each owned vertex, in the order of VertexOwners::ids()
  std::size_t n_nonmanifold_edges = 0, n_misoriented_edges = 0, n_nonmanifold_vertices = 0;
  long euler_characteristic = 0, genus = 0;
};

/// Computes the topology. Faces at a vertex are examined by its owner; labels of components are passed from rank to
/// rank until none changes. Collective.
BoundaryTopology topology_of_parts(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners,
                                   const PartBoundary& boundary);

}  // namespace umtet
