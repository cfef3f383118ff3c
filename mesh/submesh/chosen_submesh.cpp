#include "mesh/submesh/chosen_submesh.h"

#include <utility>

#include "mesh/base/violations.h"
#include "mesh/submesh/crawl.h"
#include "mesh/submesh/nothing_inside.h"
#include "mesh/submesh/walls.h"

namespace umtet {
namespace {

/// The set triangulated by the background must strictly contain the closure of Omega (Section 2.1), unless its
/// background boundary is a wall.
void look_at_background_boundary(const BackgroundMesh& background, const SubmeshParams& params, ChosenSubmesh& chosen) {
  const Submesh& submesh = chosen.submesh;
  if (params.background_boundary == BackgroundBoundary::Wall) {
    chosen.walls = wall_faces(background, submesh);
    chosen.evidence = boundary_near_walls(background, submesh);
    if (chosen.evidence.count > 0) chosen.status = UmStatus::BoundaryNearWall;
    return;
  }
  // A vertex that is not positive is inside, and a vertex on the background boundary has lost tets of omega_h.
  std::vector<bool> positive(submesh.mesh.V.size(), false);
  for (const int i : submesh.positive_vertices) positive[i] = true;
  const Violations found = find_violations(positive.size(), [&](std::size_t i) {
    return !positive[i] && background.on_boundary(submesh.background_vertex[i]);
  });
  if (found.count == 0) return;
  chosen.status = UmStatus::DomainLeavesBackground;
  chosen.evidence = {.background_vertex = submesh.background_vertex[found.first],
                     .where = submesh.mesh.V[found.first],
                     .count = found.count,
                     .what = "the domain reaches the boundary of the background mesh"};
}

}  // namespace

UmResult result_of(ChosenSubmesh&& chosen) {
  UmResult result;
  result.status = chosen.status;
  result.evidence = std::move(chosen.evidence);
  result.submesh = std::move(chosen.submesh);
  result.walls = std::move(chosen.walls);
  result.manifold_flips = std::move(chosen.manifold_flips);
  result.n_psi_evaluations = chosen.n_psi_evaluations;
  return result;
}

std::string text_of_lost_seeds(std::size_t n_lost, std::size_t n_seeds) {
  return "; " + std::to_string(n_lost) + " of " + std::to_string(n_seeds) + " seeds led to no positively cut tet";
}

ChosenSubmesh submesh_by_sign(const BackgroundMesh& background, ImplicitFunctionRef psi, const SubmeshParams& params,
                              const Context& context, const std::vector<Vec3>& seeds) {
  ChosenSubmesh chosen;
  chosen.is_whole = true;
  std::string lost;
  context.report("search", 0);
  if (params.search == SubmeshSearch::FullLoop) {
    chosen.submesh = find_submesh(background, psi, &chosen.n_psi_evaluations, context, params.known);
  } else {
    Crawl found = crawl(background, psi, seeds, context);
    chosen.submesh = std::move(found.submesh);
    chosen.n_psi_evaluations = found.n_psi_evaluations;
    lost = text_of_lost_seeds(found.lost_seeds.size(), seeds.size());
  }
  if (chosen.submesh.mesh.C.empty()) {
    const NothingInside why = nothing_inside(background, psi, context, lost);
    chosen.status = why.status;
    chosen.evidence = why.evidence;
    return chosen;
  }
  look_at_background_boundary(background, params, chosen);
  if (chosen.status == UmStatus::Success) chosen.n_tets = chosen.submesh.mesh.C.size();
  context.report("submesh", 1);
  return chosen;
}

}  // namespace umtet
