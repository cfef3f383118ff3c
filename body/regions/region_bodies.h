#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/piecewise_domain.h"
#include "mesh/regions/region_certificate.h"
#include "mesh/regions/region_mesh.h"

namespace umtet {

/// A body {psi < 0} of a mesh of several regions.
struct RegionBody {
  std::string name;
  PatchFunction psi;
  std::optional<Box> box = {};     ///< contains the body; empty: not known
  std::vector<Vec3> samples = {};  ///< on its boundary, from which psi was fitted
};

struct RegionBodyOptions {
  double h = 0;                 ///< edge length, model units; 0: from tets
  std::int64_t tets = 0;        ///< approximate number of tets; 0: 100,000
  std::optional<Box> box = {};  ///< what the mesh fills; empty: the known boxes of bodies, and kRoom edges around them
  bool has_outside = true;      ///< whether the mesh fills the box
  Context context = {};
};

/// Samples of one body that the mesh does not show.
struct MissedBodySamples {
  int region = 0;
  std::size_t n_visible = 0;  ///< samples that no later body covers
  std::size_t n_missed = 0;   ///< of them: farther than h from the nearest interface vertex of the region
  double farthest = 0;        ///< model units
  Vec3 where = Vec3::Zero();  ///< the farthest sample
};

/// A mesh of several bodies with its verdict.
struct RegionBodyMesh {
  RegionMesh mesh;
  RegionCertificate certificate;
  double h = 0;
  std::vector<std::string> names;         ///< per region; "outside" first
  std::vector<MissedBodySamples> missed;  ///< per body with samples
  /// Why the mesh is not right; empty if it is: failures() of the certificate, and bodies whose samples the mesh
  /// misses.
  std::vector<std::string> reasons;
};

/// Edges between the bodies and the boundary of the box, where the box is not given.
inline constexpr double kRoom = 4;

/// Makes one mesh of several bodies, of which later ones cover earlier ones (RegionDomain::of_bodies()). A box with
/// `has_outside` has flat walls.
///
/// A body is missed where more than ten of its visible samples, and more than one in a thousand, are farther than 1.5 h
/// from the vertices of its interfaces: the vertices of a face are within .6 h of its points.
/// \throw UsageError  no body, names that repeat (case aside), or no box of a body and no options.box
/// \throw MeshingImpossible  a body reaches the boundary of the box, or none is in it
/// \throw Cancelled
RegionBodyMesh mesh_region_bodies(const std::vector<RegionBody>& bodies, const RegionBodyOptions& options);

}  // namespace umtet
