#pragma once

#include <array>
#include <vector>

#include "common/context.h"
#include "mesh/core/boundary_strata.h"
#include "mesh/core/piecewise_domain.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/features/feature_graph.h"

namespace umtet {

/// The features of a domain in the boundary of a mesh: each corner is a vertex, each curve a path of edges, each patch
/// the faces between paths.
struct FeatureEmbedding {
  /// Numbers of the strata: the patches 0 .. n_patches - 1, then psi as a whole, the curves, the corners.
  std::vector<Stratum> strata;
  std::vector<int> stratum;              ///< per vertex; -1 for those not on the boundary
  std::vector<int> face_patch;           ///< per boundary face; -1: no single patch, where curves could not be embedded
  std::vector<int> corner_vertex;        ///< per corner; -1 where there is none
  std::vector<std::vector<int>> chains;  ///< per curve: its vertices in order, of a closed one with the first at the
                                         ///< end again; empty where it could not be embedded
  std::vector<std::vector<double>> chain_arc;  ///< the arc lengths that the vertices of the chains are to take
  std::vector<FeatureDefect> defects;

  static int whole(const PiecewiseDomain& domain) { return domain.n_patches(); }
};

/// The strata of a feature graph, in the order of FeatureEmbedding::strata.
/// @param h_of_corner  edge length at each corner
std::vector<Stratum> strata_of(const PiecewiseDomain& domain, const FeatureGraph& graph,
                               const std::vector<double>& h_of_corner);

/// Greatest least mean ratio of k equal tets that share an edge and fill a wedge of this angle:
///
///     Q_max(a) = 4 (sin a / (sqrt(2) (6 - 2 cos a)))^(2/3) with a = angle / k
///
/// It is 0 for a >= 180 degrees.
double best_wedge_quality(double angle_deg, int k);

/// Embeds a feature graph in the boundary of omega_h.
///
/// 1. Corners take the nearest boundary vertices, the nearest pairs first. A vertex counts as two edges farther, here
///    and below, if the corner or curve is not on the patch that decides psi at the vertex: the other side of a thin
///    wall may be nearer than the right one.
/// 2. Each curve becomes the path of boundary edges of least cost between its corners, the sum over edges of
///
///        (distance / h)^2 + .15 length / h + 8 max(0, .95 - Q_max(angle / k))^2
///
///    for k tets at the edge, within 4 h of the curve. Paths do not meet except at corners: a path may take a vertex
///    from another, at a price that rises with every time that the vertex was taken, and the other path is laid again.
///    A closed curve is divided in three. Shortcuts by a single edge are taken.
/// 3. The faces between paths are one patch each: one that all curves around have in common, and that most of them lie
///    nearest to.
///
/// A curve without a path, or with a wrong patch on one of its sides, is reported and left out; the patches on its
/// sides may then be one, on psi as a whole.
/// @param V, C   vertices and tets of omega_h, in the background
/// @param faces  its boundary, a closed manifold
/// @param h      edge length at each vertex
/// \throw Cancelled
FeatureEmbedding embed_features(const PiecewiseDomain& domain, const FeatureGraph& graph, const std::vector<Vec3>& V,
                                const std::vector<Tet>& C, const std::vector<Triangle>& faces,
                                const std::vector<double>& h, const Context& context = {});

}  // namespace umtet
