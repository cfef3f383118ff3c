#pragma once

#include <string>
#include <utility>
#include <vector>

#include "mesh/tet_mesh_io.h"
#include "pipeline/domain.h"
#include "pipeline/record.h"

namespace umtet {

/// So much of a mesh fits into a report of some megabytes.
struct ReportCaps {
  std::size_t faces = 150'000;
  std::size_t tets = 150'000;  ///< 1.3 MB; a mesh with more is shown behind the middle planes of its box only
  std::size_t points = 30'000;
  std::size_t worst = 500;  ///< tets that come first, ascending in quality, whatever else is left out
};

/// What the viewer of a report draws. Little-endian arrays in base64, by name:
///   positions    uint16 x 3 a vertex, in 65535ths of the box
///   faces        4 indices each, uint16 or uint32 (head.index_bytes): a boundary face, and the vertex behind it
///   tets         4 indices each: the worst ones first
///   tet_quality, face_quality, face_deviation, face_piece, vertex_support   a byte each, in 255ths of head.ranges
///                (pieces by number, modulo 256)
///   points       uint16 x 3 a sample, in 65535ths of the box
struct ReportScene {
  Json head;  ///< box, counts of what is there and of what is shown, ranges, planes
  std::vector<std::pair<std::string, std::string>> blocks;
};

/// @param mesh      as in mesh.vtu: model coordinates, with `mean_ratio` and, of a cloud, `support`
/// @param domain    psi as it was meshed: deviations are |psi| / |grad psi| at the centres of faces
/// @param n_pieces  of the boundary; they have numbers if there are several
/// \throw MeshCancelled, std::invalid_argument without tets
ReportScene report_scene(const MeshFile& mesh, const Domain& domain, int n_pieces, const ReportCaps& caps = {});

/// RFC 4648, with padding.
std::string base64(const void* data, std::size_t size);

}  // namespace umtet
