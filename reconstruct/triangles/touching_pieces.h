#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/context.h"
#include "common/vec3.h"
#include "reconstruct/triangles/face_patches.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// What becomes of pieces of a surface that meet along an edge or at a corner, where no level set has a gap or a neck.
enum class Touching {
  Apart,  ///< a gap
  Fuse    ///< a neck
};

struct TouchingReport {
  std::size_t n_contacts = 0;  ///< places that were looked at, one in half a width along an edge
  std::size_t n_pieces = 0;    ///< that meet others, or themselves
  double width = 0;            ///< by which samples beside a contact have moved, at most; model units
};

/// Points along the edges at which more than two triangles of closed patches meet, of several or of one, and corners
/// that several share: at most `step` from each other along an edge.
std::vector<Vec3> contact_points(const TriangleMesh& mesh, const FacePatches& patches, double step,
                                 TouchingReport& report);

/// Samples near a contact, moved: at the distance s < 2 w from it by w (1 - s / (2 w)), along the inward normal for a
/// gap and the outward one for a neck; normals turn with the surface. Samples that thereby come beyond the moved
/// surface of the other side are marked.
/// @param w  the most that one moves
/// @return which are to go, one flag a sample
std::vector<std::uint8_t> move_from_contacts(const std::vector<Vec3>& contacts, double w, Touching touching,
                                             std::vector<Vec3>& points, std::vector<Vec3>& normals);

}  // namespace umtet
