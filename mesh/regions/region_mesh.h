#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/context.h"
#include "common/vec3.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/boundary_strata.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/fast/flips/local_flips.h"
#include "mesh/fast/smoothing/p_norm_smoothing.h"
#include "mesh/features/stratified_projection.h"
#include "mesh/regions/region_domain.h"
#include "mesh/regions/region_labels.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// Parameters of make_region_mesh().
struct RegionMeshParams {
  RegionLabelParams labels = {};
  int layers = 3;  ///< layers of vertices on either side of the interfaces that move; >= 1
  /// A vertex that has not arrived after ten rounds does not arrive later.
  StratifiedProjectionParams projection = {.max_rounds = 10, .smoothing = {.max_sweeps = 4}};
  /// Few sweeps: smoothing carries one bad place at a curve to all tets around it, which flips then find harder to
  /// mend. Least Q of 12 positions of the ball cut in two of tools/regions/region_meshes.py, by sweeps: 3: .76,
  /// 5: .76, 10: .75, 60: .36.
  SmoothingParams smoothing = {.max_sweeps = 3};
  LocalFlipParams flips = {};
  bool has_outside = true;  ///< whether the tets of region 0 are part of the mesh
};

/// Something that an interface does not have as its domain asks for. The mesh is valid all the same.
struct RegionDefect {
  enum class Kind : std::uint8_t {
    Connectivity,  ///< the tets around a vertex did not lie as at a sheet, curve or corner, and flips have left a poor
                   ///< one: the interface is thin or under-resolved there
    NotOnStratum,  ///< a vertex is not on its sheet, curve or corner
    Lost           ///< a region without a tet
  };
  Kind kind;
  Vec3 where;
  std::vector<int> regions;  ///< regions that meet there, ascending
};

/// A face between two regions, or between a region and what is not part of the mesh.
struct InterfaceFace {
  Triangle face;  ///< outward from the greater region
  int region;     ///< the greater one
  int other;      ///< the lesser one
  int tet;        ///< the tet in the greater region
  int other_tet;  ///< the tet in the lesser region; -1: it is not part of the mesh
};

/// A mesh with tets of several regions that share their interfaces.
struct RegionMesh {
  UmStatus status = UmStatus::Success;
  UmEvidence evidence;  ///< set when status != Success
  TetMesh mesh;
  std::vector<int> region;                      ///< per tet
  std::vector<std::int64_t> background_vertex;  ///< id in the background of each vertex, ascending
  std::vector<std::int64_t> background_tet;     ///< id in the background of each tet; -1 for those that flips have made
  std::vector<double> h;                        ///< edge length of the background at each vertex
  std::vector<RegionSet> regions_at;            ///< M(v): the regions of the tets around each vertex, region 0 included
  std::vector<InterfaceFace> interfaces;        ///< by tet
  std::vector<RegionDefect> defects;
  RegionLabels labels;  ///< without of_vertex
  LocalFlipReport flips;
};

/// Mesh of all regions of a domain, each of which fits its sheets. Tets on both sides of a sheet share its faces.
///
/// 1. Labels: each background vertex gets a region (region_labels.h), and each tet the greatest one of its vertices.
/// 2. Strata: a vertex with tets of two regions belongs to their sheet, with three to a curve, with four to a corner.
/// 3. Interface vertices move onto their strata (stratified_projection.h), and the layers around are smoothed with the
///    tets of all sides (p_norm_smoothing.h).
/// 4. Local flips raise the worst tets of all regions (local_flips.h).
///
/// The bytes are the same for any number of threads.
/// \throw std::invalid_argument naming every broken constraint; Cancelled
RegionMesh make_region_mesh(const RegionDomain& domain, const BackgroundMesh& background,
                            const RegionMeshParams& params = {}, const Context& context = {});

}  // namespace umtet
