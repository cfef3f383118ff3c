#pragma once

#include <optional>
#include <string>
#include <vector>

#include "body/regions/region_domain_mesh.h"
#include "mesh/core/piecewise_domain.h"

namespace umtet {

/// A body {psi < 0} of a mesh of several regions.
struct RegionBody {
  std::string name;
  PatchFunction psi;
  std::optional<Box> box = {};     ///< contains the body; empty: not known
  std::vector<Vec3> samples = {};  ///< on its boundary, from which psi was fitted
};

/// The rule that assigns a point inside several bodies to one of them.
enum class Overlap {
  Later,  ///< the last of them (RegionDomain::of_bodies())
  Least   ///< the one whose psi is least (RegionDomain::of_least()); bodies meet where their functions are equal
};

/// Makes one mesh of several bodies.
///
/// A body is missed where more than ten of its visible samples, and more than one in a thousand, are farther than 1.5 h
/// from the vertices of its interfaces: the vertices of a face are within .6 h of its points.
/// \throw UsageError  no body, names that repeat (case aside), or no box of a body and no options.box
/// \throw MeshingImpossible  a body reaches the boundary of the box, or none is in it
/// \throw Cancelled
RegionBodyMesh mesh_region_bodies(const std::vector<RegionBody>& bodies, const RegionBodyOptions& options,
                                  Overlap overlap = Overlap::Later);

}  // namespace umtet
