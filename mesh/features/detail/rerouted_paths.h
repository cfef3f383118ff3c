#pragma once

#include <vector>

#include "common/context.h"
#include "mesh/core/piecewise_domain.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/features/detail/boundary_graph.h"
#include "mesh/features/feature_graph.h"

namespace umtet::detail {

/// Corners as vertices and curves as paths of boundary edges: steps 1 and 2 of embed_features().
struct ReroutedPaths {
  std::vector<int> corner_vertex;        ///< per corner; -1 where there is none
  std::vector<std::vector<int>> chains;  ///< per curve, as in FeatureEmbedding; empty where there is no path
  std::vector<FeatureDefect> defects;    ///< a corner without a vertex, a curve without a path
};

/// Lays the path of each curve, the shortest curve first. A path that loses a vertex to another one is laid again, and
/// the price of the vertex rises.
/// @param boundary  of the mesh with the vertices V
/// @param h         edge length at each vertex
/// \throw Cancelled
ReroutedPaths lay_paths(const PiecewiseDomain& domain, const FeatureGraph& graph, const BoundaryGraph& boundary,
                        const std::vector<Vec3>& V, const std::vector<double>& h, const Context& context);

}  // namespace umtet::detail
