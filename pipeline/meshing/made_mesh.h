#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "body/body.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/universal_mesh.h"
#include "pipeline/meshing/part_mesher.h"

namespace umtet {

/// Point data of a mesh with walls: 1 at vertices of walls, 0 elsewhere. psi = 0 stays two edges away from walls, so a
/// face belongs to a wall if its corners do.
inline constexpr const char* kAtWall = "wall";

/// Returns the contents of the file of omega_h with its vertices at V: model coordinates, ids of the background, walls.
MeshFile mesh_content(const Domain& domain, const UmResult& result, const std::vector<Vec3>& V);

/// Returns the chosen mesh; moves tets, positions and ids out of the result.
MeshFile taken_content(const Domain& domain, UmResult& result);

/// Moves the vertices of the mesh to V, for another stage. \pre V has as many vertices as the mesh, and no support has
/// been added
void move_to(const Domain& domain, const std::vector<Vec3>& V, MeshFile& content);

/// Stores the distances of some vertices to their nearest samples in `support`, indexed by vertex. \throw Cancelled
void set_support(const Domain& domain, const std::vector<Vec3>& V, const std::vector<int>& vertices,
                 std::vector<double>& support);

/// Adds point data to the final mesh of a cloud: `support`, the distance of each boundary vertex to the nearest sample,
/// -1 inside and at walls (where it is large, no data support the surface), and the data that the samples carry, by
/// set_sample_fields(). Adds nothing without a cloud. \throw Cancelled
void add_support(const Domain& domain, const UmResult& result, MeshFile& content);

/// Returns the data that add_support() adds, for a distributed mesh and for mid-sides on its boundary.
/// @param result  contains the boundary alone
BoundaryData boundary_data(const Domain& domain, const UmResult& result, const std::vector<Vec3>& mid_sides = {});

/// Returns the final mesh with support. \throw Cancelled
MeshFile final_content(const Domain& domain, const UmResult& result);

/// Writes the mesh atomically. \throw std::system_error  names the file
void write_mesh(const std::filesystem::path& file, const MeshFile& content);

/// Returns some lines that explain why there is no mesh, the location, and a remedy. \pre result.status !=
/// UmStatus::Success
std::string failure_text(const UmResult& result, double h, const Vec3& shift);

}  // namespace umtet
