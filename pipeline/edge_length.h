#pragma once

#include "pipeline/domain.h"
#include "pipeline/parameters.h"

namespace umtet {

struct EdgeLength {
  double h;      ///< model units
  double least;  ///< the h that makes about mesh.max_tets tets if the choice of h was left to us, else h
};

/// The edge length of the background mesh.
///
/// mesh.h if given; else the h that makes about mesh.tets tets; else min(.015 diagonal, t / 2.2), where t is the
/// thickness that 1 % of the samples fall below (a formula: .015 diagonal of its box). The last choice makes no more
/// than about mesh.max_tets tets. \throw ResourceLimit      mesh.h asks for more than mesh.max_tets tets \throw
/// MeshingImpossible  psi < 0 nowhere
EdgeLength choose_edge_length(const Domain& domain, const Parameters& parameters);

}  // namespace umtet
