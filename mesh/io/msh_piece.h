#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mesh/io/solver_mesh.h"
#include "mesh/io/tet_mesh_io.h"

namespace umtet {

/// What one of several files of a mesh holds, as Gmsh divides it (Mesh.PartitionSplitMeshFiles). Numbers are those in
/// the whole mesh, from 0.
struct MshPiece {
  int part = 0, n_parts = 1;
  MeshPart body{"body", 1};
  std::vector<MeshPart> patches;  ///< of the whole mesh
  std::size_t n_faces = 0;        ///< of the whole mesh: their numbers come before those of tets
  std::vector<Vec3> nodes;        ///< of tets, then those that ghosts alone have
  std::vector<std::int64_t> node_number;
  std::vector<Tet> tets;
  std::vector<std::int64_t> tet_number;
  std::vector<Triangle> faces;  ///< of own tets on the boundary, outward
  std::vector<std::int64_t> face_number;
  std::vector<int> face_patch;  ///< indices into patches
  std::vector<Tet> ghosts;      ///< tets of other parts that have a node with own ones in common
  std::vector<std::int64_t> ghost_number;
  std::vector<int> ghost_part;
  std::map<std::string, FieldValues> boundary_data;  ///< of nodes of tets, as in SolverMesh
};

/// Gmsh 4.1, binary: the entities of write_msh41(), for each of them one of this part in $PartitionedEntities,
/// $GhostElements, and boundary data as $NodeData of this part. All files together are the mesh.
/// \throw std::system_error naming the path; std::invalid_argument where a node with boundary data is beyond the 2^31 -
/// 1 that $NodeData has numbers for
void write_msh41_piece(const std::filesystem::path& path, const MshPiece& piece);

}  // namespace umtet
