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

/// Contents of one of several files of a mesh that is partitioned as by Gmsh (Mesh.PartitionSplitMeshFiles). Numbers
/// are those of the whole mesh, from 0.
struct MshPiece {
  int part = 0, n_parts = 1;
  MeshPart body{"body", 1};
  std::vector<MeshPart> patches;  ///< patches of the whole mesh
  std::size_t n_faces = 0;        ///< number of faces of the whole mesh: their numbers precede those of tets
  std::vector<Vec3> nodes;        ///< nodes of tets, then nodes of ghosts only
  std::vector<std::int64_t> node_number;
  std::vector<Tet> tets;
  std::vector<std::int64_t> tet_number;
  std::vector<Triangle> faces;  ///< boundary faces of own tets, outward
  std::vector<std::int64_t> face_number;
  std::vector<int> face_patch;  ///< indices into patches
  std::vector<Tet> ghosts;      ///< tets of other parts that share a node with own tets
  std::vector<std::int64_t> ghost_number;
  std::vector<int> ghost_part;
  std::map<std::string, FieldValues> boundary_data;  ///< point data at nodes of tets, as in SolverMesh
};

/// Writes one file of a partitioned mesh in Gmsh 4.1, binary: the entities of write_msh41(), an entity of this part for
/// each of them in $PartitionedEntities, $GhostElements, and boundary data as $NodeData of this part. All files
/// together are the mesh.
/// \throw std::system_error naming the path; std::invalid_argument if a node with boundary data is beyond the 2^31 - 1
///        numbers of $NodeData
void write_msh41_piece(const std::filesystem::path& path, const MshPiece& piece);

}  // namespace umtet
