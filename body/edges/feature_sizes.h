#pragma once

#include <vector>

#include "common/context.h"
#include "mesh/features/feature_graph.h"
#include "mesh/sizes/source_tree.h"
#include "reconstruct/triangles/sharp_edges.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Parameters of feature_sizes(); lengths in model units.
struct FeatureSizeParams {
  double h;      ///< maximum
  double h_min;  ///< minimum
  /// Number of edges across the body, across a gap outside, and between two curves.
  double edges_across = 1.7;
  double max_turn = .9;       ///< angle between the normals at the ends of an edge, radians
  double deviation;           ///< largest distance of a flat face from a curved patch
  double constant_layer = 1;  ///< radius of the sources, in multiples of their h
};

/// Size sources on a triangulated surface with sharp edges. The size of each is the least of
///
///     h,   t / edges_across,   d / edges_across,   l / edges_across,   max_turn / k,   sqrt(8 deviation / k)
///
/// but at least h_min, with t the distance along the normal to the other side of the body or of a gap
/// (body_thickness.h), d the distance of a curve from the nearest curve that has no corner in common with it, or from
/// itself at a neck, l the length of a curve, or a seventh of the length of a closed one, and k the turn of the triangles
/// a length. Turns of a radius below the deviation do not count.
/// @param edges  sharp edges of the mesh, and `graph` its curves
/// \pre the mesh is closed, and triangles face outward. The result does not depend on threads. \throw Cancelled
std::vector<SizeSource> feature_sizes(const TriangleMesh& mesh, const SharpEdges& edges, const FeatureGraph& graph,
                                      const FeatureSizeParams& params, const Context& context = {});

}  // namespace umtet
