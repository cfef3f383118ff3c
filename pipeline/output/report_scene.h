#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/body.h"
#include "mesh/io/solver_mesh.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/json_values.h"

namespace umtet {

/// Maximum amount of a mesh in a report of some megabytes.
struct ReportCaps {
  std::size_t faces = 150'000;
  std::size_t tets = 150'000;   ///< 1.3 MB; of a larger mesh, only tets at the middle planes of its box are shown
  std::size_t points = 30'000;  ///< 0: none
  std::size_t worst = 500;      ///< worst tets, ascending in quality; they come first and are never left out
};

/// The meaning of the arrays of a scene, and the amount of the mesh in them.
struct SceneHead {
  Vec3 box_min = Vec3::Zero(), box_size = Vec3::Zero();  ///< box of mesh and samples, model coordinates
  struct Patch {
    std::string name;
    int number = 0;
    std::size_t n_faces = 0;  ///< number of faces in the whole mesh
    double area = 0;          ///< model units^2
  };
  std::vector<Patch> patches;
  std::size_t n_faces = 0, n_faces_shown = 0;
  std::size_t n_tets = 0, n_tets_shown = 0;
  std::size_t n_worst = 0;  ///< number of worst tets, which come first, ascending in quality
  double layer = 0;         ///< a tet is drawn if the cut is within this distance of its centroid, model units
  std::optional<std::vector<int>> planes;   ///< axes along which tets can be cut; none: any plane is possible
  std::optional<std::array<int, 3>> cells;  ///< numbers of cells along the axes of the box, if not all tets are shown
  int index_bytes = 0;                      ///< bytes of an index: 2 or 4
  struct Range {
    double least = 0, most = 0;
  };
  Range quality, deviation;          ///< ranges of the colours; deviation in model units
  std::optional<Range> edge_length;  ///< range at vertices, model units; empty for a mesh with a single h
  std::optional<Range> support;      ///< distances to samples, model units; none for a formula
  double support_radius = 0;         ///< beyond this distance from every sample, the surface is a guess
  struct Field {
    std::string name;  ///< name in the mesh
    Range range;       ///< range of the known values; 0 and 1 for colours
    bool of_colours = false;
  };
  std::vector<Field> fields;  ///< data of the samples, at vertices
  std::size_t n_points = 0, n_points_shown = 0;
};

/// Returns the head in the form that the viewer reads.
Json to_json(const SceneHead& head);

/// The data that the viewer of a report draws. Little-endian arrays in base64, by name:
///   positions    3 x uint16 per vertex, in 65535ths of the box
///   faces        4 indices each, uint16 or uint32 (head.index_bytes): a boundary face, and the vertex behind it
///   tets         4 indices each: the worst ones first
///   tet_quality, face_quality, face_deviation, vertex_support, vertex_edge_length   one byte each, in 255ths of
///   head.ranges
///   face_patch   one byte each, if there are several patches: index into head.patches, modulo 256
///   tet_ids      uint32: ids in mesh.vtu of the worst tets; the others ascend if all are shown, else of all tets
///   face_ids     uint32: id in mesh.vtu of the tet of each face
///   cells        if not all tets are shown: one byte per cell of a grid of the box, x first; 0: no tet; else 1 plus
///   the
///                least Q in the cell, in 254ths of head.ranges
///   points       3 x uint16 per sample, in 65535ths of the box
///   curves       6 x uint16 per edge of a curve, if there are any: its ends, in 65535ths of the box
///   vertex_field_N   one byte each, or three for colours, of head.fields[N], in 254ths of the range; 255: no value
struct ReportScene {
  SceneHead head;
  std::vector<std::pair<std::string, std::string>> blocks;
};

/// @param mesh      as in mesh.vtu: model coordinates, with `mean_ratio`, `support` for a cloud, and `edge_length` for
///   a graded mesh
/// @param domain    psi as it was meshed: deviations are |psi| / |grad psi| at the centres of faces
/// @param divided   solver_mesh() of the mesh, with its boundary in patches
/// \throw Cancelled, std::invalid_argument  there are no tets, or `divided` has another number of them
ReportScene report_scene(const MeshFile& mesh, const Domain& domain, const SolverMesh& divided,
                         const ReportCaps& caps = {});

}  // namespace umtet
