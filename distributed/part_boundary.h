#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/distributed_mesh.h"
#include "distributed/vertex_owners.h"

namespace umtet {

/// boundary_faces() of what all ranks have together: those of own tets.
struct PartBoundary {
  std::vector<std::int64_t> id;                 ///< 4 tet of the background + local face, ascending
  std::vector<Triangle> triangles;              ///< vertices of the own mesh, outward
  std::size_t n_overused = 0, n_same_side = 0;  ///< of all ranks
};

/// 4 tet of the background + local face, of a face of an own tet.
std::int64_t face_id(const DistributedMesh& mesh, std::size_t tet, const Triangle& face);

/// Faces are counted without trust in how the mesh was made. Those under a vertex that others have, too, are counted by
/// its owner. Collective.
PartBoundary boundary_of_parts(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners);

/// A piece of the boundary; pieces that touch in a vertex are one.
struct BoundaryPiece {
  std::int64_t label;  ///< its least vertex, by ids of the background
  std::int64_t n_vertices = 0, n_edges = 0, n_faces = 0;
  std::int64_t first_face;  ///< the least id
  double corner[3];         ///< the place of the first corner of that
};

/// surface_topology() of the boundary, of all ranks but where own faces or vertices are named.
struct BoundaryTopology {
  std::vector<BoundaryPiece> pieces;  ///< ascending
  std::vector<int> piece;             ///< of each own face
  std::vector<char> is_on_boundary;   ///< of each vertex that is owned, in the order of VertexOwners::ids()
  std::size_t n_nonmanifold_edges = 0, n_misoriented_edges = 0, n_nonmanifold_vertices = 0;
  long euler_characteristic = 0, genus = 0;
};

/// Faces at a vertex are looked at by its owner; labels of pieces are passed on from rank to rank, as long as one
/// changes. Collective.
BoundaryTopology topology_of_parts(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners,
                                   const PartBoundary& boundary);

}  // namespace umtet
