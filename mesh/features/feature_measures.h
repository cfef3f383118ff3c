#pragma once

#include <cstddef>

#include "mesh/core/piecewise_domain.h"
#include "mesh/features/piecewise_mesh.h"

namespace umtet {

/// How well a mesh has the sharp curves and the corners of its domain.
struct FeatureMeasures {
  std::size_t n_corners = 0, n_curves = 0;                ///< numbers of corners and curves of the domain
  std::size_t n_missed_corners = 0, n_missed_curves = 0;  ///< numbers of those that the mesh lacks
  double length = 0, missed_length = 0;                   ///< length of curves of the domain, model units
  double farthest_vertex = 0;  ///< distance of a vertex of a chain or corner from its zero sets, in h
  double farthest_point = 0;   ///< distance of a curve from its chain, in h: the sagitta of edges
  double worst_angle_deg = 0;  ///< greatest difference of the dihedral angle at an edge of a chain from the domain's
  double least_cosine = 1;     ///< cosine between a face's normal and the gradient of its own patch at the centroid
  std::size_t n_faces_without_patch = 0;
};

/// Measures the features of a mesh against its domain, from the faces and chains of the mesh alone. Distances are in
/// the edge length of the background at the vertex.
FeatureMeasures measure_features(const PiecewiseDomain& domain, const PiecewiseMesh& mesh);

}  // namespace umtet
