#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/context.h"
#include "common/vec3.h"
#include "reconstruct/triangles/face_patches.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Treatment of pieces of a surface that meet along an edge or at a corner, where a level set has neither a gap nor a
/// neck.
enum class Touching {
  Apart,  ///< make a gap
  Fuse    ///< make a neck
};

/// Report on the contacts of a surface.
struct TouchingReport {
  std::size_t n_contacts = 0;  ///< contact points examined, one in half a width along an edge
  std::size_t n_pieces = 0;    ///< pieces that meet others, or themselves
  double width = 0;            ///< maximum displacement of samples at a contact; model units
};

/// Contact points: points along the edges at which more than two triangles of closed patches meet, of one or several
/// patches, and corners shared by several. They are at most `step` apart along an edge.
std::vector<Vec3> contact_points(const TriangleMesh& mesh, const FacePatches& patches, double step,
                                 TouchingReport& report);

/// Moves samples near a contact. At the distance s < 2 w from it they move by w (1 - s / (2 w)), along the inward
/// normal for a gap and the outward one for a neck; normals turn with the surface. Samples that pass the moved surface
/// of the other side are marked.
/// @param w  maximum displacement
/// @return samples to be dropped, one flag per sample
std::vector<std::uint8_t> move_from_contacts(const std::vector<Vec3>& contacts, double w, Touching touching,
                                             std::vector<Vec3>& points, std::vector<Vec3>& normals);

}  // namespace umtet
