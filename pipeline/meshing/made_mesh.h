#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "body/body.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/universal_mesh.h"
#include "pipeline/meshing/part_mesher.h"

namespace umtet {

/// Point data of a mesh with walls: 1 at their vertices, else 0. psi = 0 stays two edges away: a face is of a wall if
/// its corners are.
inline constexpr const char* kAtWall = "wall";

/// What the file of omega_h with its vertices at V holds: model coordinates, ids of the background, walls.
MeshFile mesh_content(const Domain& domain, const UmResult& result, const std::vector<Vec3>& V);

/// The same of the chosen mesh, which takes tets, places and ids out of the result.
MeshFile taken_content(const Domain& domain, UmResult& result);

/// The same mesh at another stage, its vertices at V. \pre as many as it has, and no support yet
void move_to(const Domain& domain, const std::vector<Vec3>& V, MeshFile& content);

/// Distances of some vertices to their nearest samples, into their places of `support`. \throw Cancelled
void set_support(const Domain& domain, const std::vector<Vec3>& V, const std::vector<int>& vertices,
                 std::vector<double>& support);

/// Of a cloud's final mesh the distance of each boundary vertex to the nearest sample, -1 inside and at walls, as point
/// data `support`: where it is large, no data back the surface. And what else the samples carry, by
/// set_sample_fields(). Nothing without a cloud. \throw Cancelled
void add_support(const Domain& domain, const UmResult& result, MeshFile& content);

/// What add_support() adds, of a mesh that several processes have, and of mid-sides on its boundary.
/// @param result  of its boundary alone
BoundaryData boundary_data(const Domain& domain, const UmResult& result, const std::vector<Vec3>& mid_sides = {});

/// The final mesh, with support. \throw Cancelled
MeshFile final_content(const Domain& domain, const UmResult& result);

/// Complete or not at all. \throw std::system_error naming the file
void write_mesh(const std::filesystem::path& file, const MeshFile& content);

/// Why there is no mesh, where, and what may help; some lines. \pre result.status != UmStatus::Success
std::string failure_text(const UmResult& result, double h, const Vec3& shift);

}  // namespace umtet
