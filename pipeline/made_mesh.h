#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh/tet_mesh_io.h"
#include "mesh/universal_mesh.h"
#include "pipeline/domain.h"

namespace umtet {

/// Makes the vertices those that a file will hold, in working coordinates: it stores x + shift, rounded, and taking the
/// shift off again is exact (far_origin_shift). From here on that is the mesh: it is this one that is measured.
void round_to_file(UmResult& result, const Vec3& shift);

/// Point data of a mesh with walls: 1 at their vertices, else 0. psi = 0 stays two edges away: a face is of a wall if
/// its corners are.
inline constexpr const char* kAtWall = "wall";

/// What is in the file of write_mesh(), below. \throw MeshCancelled
MeshFile mesh_content(const Domain& domain, const UmResult& result, const std::vector<Vec3>& V);

/// Distances of some vertices to their nearest samples, into their places of `support`. \throw MeshCancelled
void set_support(const Domain& domain, const std::vector<Vec3>& V, const std::vector<int>& vertices,
                 std::vector<double>& support);

/// omega_h with its vertices at V, in model coordinates, with ids of the background; of a cloud's final mesh also the
/// distance of each boundary vertex to the nearest sample (`support`, -1 inside and at walls): what is data and what is
/// a guess. Complete or not at all.
/// @return what the file holds. \throw MeshCancelled, std::system_error naming the file
MeshFile write_mesh(const std::filesystem::path& file, const Domain& domain, const UmResult& result,
                    const std::vector<Vec3>& V);

/// Why there is no mesh, where, and what may help; some lines. \pre result.status != UmStatus::Success
std::string failure_text(const UmResult& result, double h, const Vec3& shift);

}  // namespace umtet
