#include "body/search/piecewise_fit.h"

#include <algorithm>
#include <utility>

#include "body/errors.h"
#include "body/option_names.h"
#include "body/sizing/background_choice.h"
#include "body/sizing/graded_sizes.h"

namespace umtet {
namespace {

/// omega_h as the flips leave it: vertices with their positions in the background, tets with their ids in it.
Submesh flipped(const Submesh& chosen, PiecewiseMesh& made) {
  Submesh now;
  now.background_vertex = std::move(made.background_vertex);
  now.mesh.C = std::move(made.mesh.C);
  for (std::size_t v = 0, at = 0; v < now.background_vertex.size(); ++v, ++at) {
    while (chosen.background_vertex[at] != now.background_vertex[v]) ++at;  // both ascend
    now.mesh.V.push_back(chosen.mesh.V[at]);
  }
  for (const std::int64_t t : made.tet_of_chosen)
    now.background_tet.push_back(t < 0 ? -1 : chosen.background_tet[static_cast<std::size_t>(t)]);
  now.positive_faces = made.faces;
  now.positive_tets = std::move(made.face_tet);
  for (std::size_t v = 0; v < made.stratum.size(); ++v)
    if (made.stratum[v] >= 0) now.positive_vertices.push_back(static_cast<int>(v));
  return now;
}

/// The values of `of_chosen` at the vertices that the flips leave.
std::vector<Vec3> left_of(const std::vector<Vec3>& of_chosen, const Submesh& chosen, const Submesh& now) {
  std::vector<Vec3> left;
  for (std::size_t v = 0, at = 0; v < now.background_vertex.size(); ++v, ++at) {
    while (chosen.background_vertex[at] != now.background_vertex[v]) ++at;
    left.push_back(of_chosen[at]);
  }
  return left;
}

}  // namespace

void require_piecewise(const BodyOptions& options) {
  const MeshOptions& mesh = options.mesh;
  if (has_own_background(options))
    throw UsageError({Setting(option::background, mesh.background),
                      ": the body has sharp edges, and such a mesh is made in a lattice or a graded mesh"});
  if (mesh.box_walls || mesh.complement)
    throw UsageError({Option{option::box_walls}, ": the body has sharp edges, and walls are for smooth bodies"});
  if (mesh.mode == UmMode::Paper)
    throw UsageError("mode paper: psi has to be smooth there, and this body has sharp edges");
  if (mesh.order > 1) throw UsageError("order 2: only the faces of smooth bodies are curved, this one has sharp edges");
}

PiecewiseMeshParams piecewise_params(const MeshOptions& options) {
  PiecewiseMeshParams params;
  if (options.target_quality != MeshOptions().target_quality) {  // it has been given
    params.smoothing.target = options.target_quality;
    params.local_flips.target = options.target_quality;
  }
  params.flips = options.flips;
  return params;
}

PiecewiseFit fit_piecewise(const PiecewiseBody& body, const BackgroundMesh& background, ChosenSubmesh chosen,
                           const MeshOptions& options, double within_reach, const Context& context) {
  PiecewiseMeshParams params = piecewise_params(options);
  params.local_flips.mend_below = std::min(params.local_flips.mend_below, within_reach);
  params.local_flips.mend_below_at_last = std::min(params.local_flips.mend_below_at_last, within_reach);
  UmResult before;
  before.manifold_flips = chosen.manifold_flips;
  before.n_psi_evaluations = chosen.n_psi_evaluations;
  auto made = std::make_shared<PiecewiseMesh>(fit_piecewise_mesh(body.domain, background, std::move(chosen),
                                                                 body.graph ? &*body.graph : nullptr, params, context));
  before.status = made->status;
  before.evidence = made->evidence;
  before.submesh = std::move(made->chosen);
  before.projected = std::move(made->projected);
  before.final = std::move(made->smoothed);
  if (made->status != UmStatus::Success) return {std::move(before), nullptr};
  before.n_psi_evaluations += made->flips.psi_evaluations;
  if (made->flips.n_collapsed + made->flips.n_removed_edges == 0) {
    before.final = made->mesh.V;
    return {std::move(before), std::move(made)};
  }
  UmResult after;
  after.manifold_flips = before.manifold_flips;
  after.n_psi_evaluations = before.n_psi_evaluations;
  after.final = made->mesh.V;
  after.submesh = flipped(before.submesh, *made);
  after.projected = left_of(before.projected, before.submesh, after.submesh);
  after.of_background = std::make_shared<const UmResult>(std::move(before));
  return {std::move(after), std::move(made)};
}

}  // namespace umtet
