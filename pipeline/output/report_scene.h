#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mesh/io/solver_mesh.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/json_values.h"
#include "body/body.h"

namespace umtet {

/// So much of a mesh fits into a report of some megabytes.
struct ReportCaps {
  std::size_t faces = 150'000;
  std::size_t tets = 150'000;  ///< 1.3 MB; a mesh with more is shown behind the middle planes of its box only
  std::size_t points = 30'000;
  std::size_t worst = 500;  ///< tets that come first, ascending in quality, whatever else is left out
};

/// What the arrays of a scene mean, and how much of the mesh is in them.
struct SceneHead {
  Vec3 box_min = Vec3::Zero(), box_size = Vec3::Zero();  ///< of mesh and samples, model coordinates
  struct Patch {
    std::string name;
    int number = 0;
    std::size_t n_faces = 0;  ///< in the whole mesh
    double area = 0;          ///< model units^2
  };
  std::vector<Patch> patches;
  std::size_t n_faces = 0, n_faces_shown = 0;
  std::size_t n_tets = 0, n_tets_shown = 0;
  std::size_t n_worst = 0;  ///< so many tets come first, ascending in quality
  double layer = 0;         ///< a tet is drawn at a cut that is no farther from its centroid, model units
  std::optional<std::vector<int>> planes;  ///< axes across which tets are there to be cut; none: any plane will do
  int index_bytes = 0;                     ///< of an index: 2 or 4
  struct Range {
    double least = 0, most = 0;
  };
  Range quality, deviation;          ///< of the colours; deviation in model units
  std::optional<Range> edge_length;  ///< at vertices, model units; none of a mesh with one h
  std::optional<Range> support;      ///< distances to samples, model units; none for a formula
  double support_radius = 0;         ///< farther than this from every sample the surface is a guess
  struct Field {
    std::string name;  ///< in the mesh
    Range range;       ///< of the values that are known; of colours 0 and 1
    bool of_colours = false;
  };
  std::vector<Field> fields;  ///< at vertices, what the samples carry
  std::size_t n_points = 0, n_points_shown = 0;
};

/// As the viewer reads it.
Json to_json(const SceneHead& head);

/// What the viewer of a report draws. Little-endian arrays in base64, by name:
///   positions    uint16 x 3 a vertex, in 65535ths of the box
///   faces        4 indices each, uint16 or uint32 (head.index_bytes): a boundary face, and the vertex behind it
///   tets         4 indices each: the worst ones first
///   tet_quality, face_quality, face_deviation, vertex_support, vertex_edge_length   a byte each, in 255ths of
///   head.ranges face_patch   a byte each, where there are several: index into head.patches, modulo 256 points uint16 x
///   3 a sample, in 65535ths of the box
///   vertex_field_N   of head.fields[N] a byte each, or three of colours, in 254ths of the range; 255: no value
struct ReportScene {
  SceneHead head;
  std::vector<std::pair<std::string, std::string>> blocks;
};

/// @param mesh      as in mesh.vtu: model coordinates, with `mean_ratio` and, of a cloud, `support`, of a graded mesh
/// `edge_length`
/// @param domain    psi as it was meshed: deviations are |psi| / |grad psi| at the centres of faces
/// @param divided   solver_mesh() of it, its boundary in patches
/// \throw Cancelled, std::invalid_argument without tets, or with another number of them in `divided`
ReportScene report_scene(const MeshFile& mesh, const Domain& domain, const SolverMesh& divided,
                         const ReportCaps& caps = {});

}  // namespace umtet
