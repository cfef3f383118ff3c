#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "body/label_report.h"
#include "common/context.h"
#include "common/vec3.h"
#include "mesh/background/background_mesh.h"
#include "mesh/regions/periodic_mesh.h"
#include "mesh/regions/region_certificate.h"
#include "mesh/regions/region_domain.h"
#include "mesh/regions/region_mesh.h"

namespace umtet {

struct RegionBodyOptions {
  double h = 0;                 ///< edge length, model units; 0: from tets
  std::int64_t tets = 0;        ///< approximate number of tets; 0: 100,000, and more for the labels of a volume
  std::optional<Box> box = {};  ///< the box of the mesh; empty: the known boxes of bodies, and kRoom edges around them
  bool has_outside = true;      ///< whether the mesh fills the box
  bool is_periodic = false;     ///< the box is one period of the domain along each axis
  Context context = {};
};

/// Samples of one body that the mesh does not show.
struct MissedBodySamples {
  int region = 0;
  std::size_t n_visible = 0;  ///< samples that no later body covers
  std::size_t n_missed = 0;   ///< visible samples farther than h from the nearest interface vertex of the region
  double farthest = 0;        ///< model units
  Vec3 where = Vec3::Zero();  ///< the farthest sample
};

/// Comparison of one region of a mesh with the voxels of its label.
struct RegionVoxels {
  int region = 0;
  double label = 0;             ///< the number of the voxels
  std::size_t n_voxels = 0;     ///< voxels with this label
  double volume_of_voxels = 0;  ///< model units^3
  double volume = 0;            ///< volume of the tets
  PieceCount pieces;            ///< pieces of the voxels
  double thickness = 0;         ///< thickness of the thinnest places, model units: PartShape::thickness_p01
};

/// A mesh of several regions with its verdict.
struct RegionBodyMesh {
  RegionMesh mesh;
  RegionCertificate certificate;
  double h = 0;
  std::vector<std::string> names;         ///< per region; "outside" first
  std::vector<MissedBodySamples> missed;  ///< per body with samples
  std::vector<RegionVoxels> voxels;       ///< per label of a volume
  Vec3 sides = Vec3::Zero();              ///< sides of a period; 0 if the mesh is not periodic
  std::vector<PeriodicPair> pairs;        ///< vertices of a periodic mesh on opposite sides
  std::optional<PeriodicMatch> match;     ///< how the sides of a periodic mesh fit together
  /// Why the mesh is not right; empty if it is: failures() of the certificate, bodies whose samples the mesh misses,
  /// and labels whose voxels it does not show.
  std::vector<std::string> reasons;
};

/// Edges between the bodies and the boundary of the box, where the box is not given.
inline constexpr double kRoom = 4;

/// Makes the mesh of a domain, and certifies it. A box with `has_outside` has flat walls, unless the mesh is periodic.
/// @param names   one name per region
/// @param bodies  the box around them, if options.box is empty
/// \throw UsageError         names that repeat, or a domain that does not repeat in the box of a periodic mesh
/// \throw MeshingImpossible  a body reaches the boundary of the box, or none is in it
/// \throw Cancelled
RegionBodyMesh mesh_region_domain(const RegionDomain& domain, std::vector<std::string> names, const Box& bodies,
                                  const RegionBodyOptions& options);

/// The edge length with which the A15 tets of a volume have this number.
double edge_length_of(double volume, double n_tets);

}  // namespace umtet
