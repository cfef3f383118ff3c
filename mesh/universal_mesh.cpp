#include "mesh/universal_mesh.h"

#include <stdexcept>
#include <utility>

#include "mesh/fast/fast_mesh.h"

namespace umtet {
namespace {

constexpr double kSearchShare = .1;  // share of the time of a mesh, about

/// \throw std::invalid_argument naming every broken constraint. @param seeds  null: not used
void check(const UmParams& params, const std::vector<Vec3>* seeds) {
  std::string all;
  for (const std::string& problem : problems(params)) all += (all.empty() ? "" : "; ") + problem;
  if (seeds && params.submesh.search == SubmeshSearch::Crawl && seeds->empty()) {
    all += (all.empty() ? "" : "; ") + std::string("seeds: Crawl needs at least one");
  }
  if (!all.empty()) throw std::invalid_argument(all);
}

}  // namespace

std::vector<std::string> problems(const UmParams& params) {
  std::vector<std::string> list;
  for (const std::string& problem : problems(params.paper)) list.push_back("paper." + problem);
  for (const std::string& problem : problems(params.fast)) list.push_back("fast." + problem);
  return list;
}

ChosenSubmesh choose_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const UmParams& params,
                             const Context& context, const std::vector<Vec3>& seeds) {
  check(params, &seeds);
  if (params.mode == UmMode::Fast) {
    return classified_submesh(background, psi, params.submesh, params.fast, context, seeds);
  }
  return submesh_by_sign(background, psi, params.submesh, context, seeds);
}

ChosenSubmesh choose_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const UmParams& params,
                             const FormerMesh& former, const Context& context) {
  check(params, nullptr);
  if (params.mode != UmMode::Fast) throw std::invalid_argument("mode = Paper: a former mesh is for Fast");
  return classified_submesh(background, psi, params.submesh, params.fast, former, context);
}

UmResult fit_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const UmParams& params,
                     ChosenSubmesh chosen, const Context& context) {
  check(params, nullptr);
  if (params.mode == UmMode::Fast) {
    return fast_mesh(background, psi, params.submesh, params.fast, std::move(chosen), context);
  }
  return algorithm_1(background, psi, params.submesh, params.paper, std::move(chosen), context);
}

UmResult universal_mesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const UmParams& params,
                        const Context& context, const std::vector<Vec3>& seeds) {
  return fit_submesh(background, psi, params,
                     choose_submesh(background, psi, params, context.part(0, kSearchShare), seeds),
                     context.part(kSearchShare, 1));
}

}  // namespace umtet
