#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/core/boundary_strata.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Parameters of flip_locally().
struct LocalFlipParams {
  double target = .78;  ///< mean ratio: tets below it are mended; in (0, 1)
  /// Tets are mended only where their mean ratio is also below this one, and then up to the target; > 0.
  double mend_below = 1;
  double mend_below_at_last = 1;  ///< the same in the last pass
  /// Range of edge lengths, relative to the mean edge length around their ends in the mesh that is given. Edges that
  /// are outside of it already may stay so.
  double shortest = .5, longest = 1.7;
  int most_candidates = 4;  ///< operations that are tried for one tet, those with the best worst tet first; >= 0
  /// The worst new tet of an operation needs this share of the mean ratio of the tet, before its vertices move; >= 0.
  /// From .4 to .8 a quarter of the tries goes, and the least Q stays (`graded_bench --benchmark_filter=flips`).
  double promising = .6;
  double promising_at_last = .4;  ///< the same in the last pass
  /// Where a body is thinner than its tets, no operation helps, and each operation that is kept nearby would have all
  /// of them tried again. A tet is left as it is once this many trials at each of its vertices have not helped; 1 to
  /// 255.
  int most_failures = 6;
  int most_failures_at_last = 6;  ///< the same in the last pass, which counts anew
};

/// Every broken constraint, not just the first.
std::vector<std::string> problems(const LocalFlipParams&);

/// Counts of the changes by flip_locally().
struct LocalFlipReport {
  std::size_t tries = 0;            ///< patches that were optimised
  std::size_t n_removed_edges = 0;  ///< edge removals that were kept
  std::size_t n_collapsed = 0;      ///< edge collapses that were kept
  std::size_t n_smoothed = 0;       ///< patches that were only optimised, and kept
  std::size_t n_below = 0;          ///< tets below the target at the end
  std::size_t psi_evaluations = 0;
};

/// How a vertex may move.
enum class VertexStratum : std::uint8_t {
  Fixed,    ///< not at all
  Inner,    ///< moves freely
  Boundary  ///< stays on psi = 0
};

/// The vertices of a mesh on the strata of a piecewise smooth boundary.
struct StratifiedVertices {
  const BoundaryStrata* strata = nullptr;
  std::vector<int> of;  ///< per vertex; read for Boundary vertices
  /// The patch of the faces between two regions; empty: the strata of its corners decide on the patch of a face.
  std::function<int(int, int)> between = {};
};

/// A tet mesh whose connectivity changes.
struct FlippedMesh {
  std::vector<Vec3> V;  ///< vertices that are in no tet stay where they were
  std::vector<Tet> C;   ///< positively oriented
  /// Per tet: its number in the mesh that was given, or -1 for a tet that an operation made. Numbers ascend, and tets
  /// with -1 come last.
  std::vector<std::int64_t> origin;
  std::vector<int> region;  ///< per tet; empty: one region
};

/// Raises tets below a target by local changes of connectivity.
///
/// For each tet below the target, the worst first, these operations are tried on a copy of the patch around it:
///   - removal of one of its edges: the ring of up to eight tets around the edge becomes the best triangulation of the
///     ring's polygon, by dynamic programming [Klincsek1980, Shewchuk2002];
///   - collapse of one of its edges: an inner vertex into any other, a boundary vertex into a neighbour on the
///   boundary;
///   - where neither helps, no change of connectivity.
/// After each, the vertices of the patch are moved by Newton's method on the p-norm of 1/Q of their rings, those of the
/// boundary in their tangent planes and back to psi = 0. The first operation is kept with which
///   - the sum of (target / Q)^18 over the patch falls by 2 % or more, misaligned boundary faces counted like bad tets;
///   - the least Q of the patch falls by no more than .003;
///   - the edges stay within the range of the parameters, boundary faces within 60 degrees of psi = 0 or nearer to it
///     than before, and their centroids near psi = 0.
///
/// Tets that are still below the target are tried once more, with more candidates, and with all vertices of a patch
/// moved at once (all_vertex_smoothing.h). There it is enough that the worst tet of the patch reaches the target, or
/// rises by 5e-4 while the sum does not.
///
/// Operations change neither the topology of the body nor of its boundary. One thread; the same bytes on every run.
///
/// With strata, vertices move on their own patch or curve, and faces are compared with their own patch. An edge on the
/// boundary is removed where its two faces and the two new ones lie on one patch. A vertex of a patch collapses into
/// one of the patch or of its border, a vertex of a curve into its neighbour on the curve, a corner into none; every
/// face stays on its patch. The edges of curves are never removed.
///
/// @param V, C      a valid mesh: every tet positive; moved in
/// @param stratum   per vertex; Boundary ones lie on psi = 0 and on the boundary of the mesh
/// In a mesh of several regions, faces between two regions take the place of the boundary. They are removed together
/// on both sides: the two parts of the ring around an edge become triangulations that share the new edge. Boundary
/// vertices lie between two regions, and psi is negative in the greater one. The boundary of the mesh stays as it is:
/// its vertices are Fixed.
///
/// @param strata    null for a smooth boundary; must outlive the call
/// @param region    per tet; empty: one region
/// \throw std::invalid_argument naming every broken constraint, Cancelled
FlippedMesh flip_locally(std::vector<Vec3> V, std::vector<Tet> C, const std::vector<VertexStratum>& stratum,
                         ImplicitFunctionRef psi, const LocalFlipParams& params, LocalFlipReport& report,
                         const Context& context = {}, const StratifiedVertices* strata = nullptr,
                         std::vector<int> region = {});

}  // namespace umtet
