#include "body/search/best_mesh.h"

#include "body/search/mesh_maker.h"
#include "body/sizing/background_choice.h"
#include "body/sizing/edge_length.h"

namespace umtet {
namespace {

// Foretelling the number of tets takes a million values of psi, whatever h is: some ten seconds of one of Python.
// Where h is given it is left out, and memory is asked for as many as are allowed.
EdgeLength edge_length(Domain& domain, BackgroundChoice& background, const BodyOptions& options,
                       const Context& context) {
  const double h = options.mesh.h;
  const bool is_given = h >= least_h_in_file(domain) && h > 0 && !is_graded(options) && !background.own_h();
  if (domain.function && is_given) return {h, h};
  return background.edge_length(domain, {.cancelled = context.cancelled});
}

}  // namespace

MeshAttempt best_mesh(Domain& domain, const BodyOptions& options, double allowed, const Context& context,
                      PartMaker* ranks) {
  context.report("size", 0);
  domain.complement = options.mesh.complement;
  BackgroundChoice background(options, domain);
  MeshMaker maker(domain, options, context, {}, ranks);
  const std::int64_t n_tets = domain.function ? options.mesh.max_tets : options.mesh.tets;
  const auto make = [&](double h) { return background.make(domain, h, n_tets, allowed); };
  return maker.best(background, edge_length(domain, background, options, context), make);
}

}  // namespace umtet
