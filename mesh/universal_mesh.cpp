#include "mesh/universal_mesh.h"

#include <stdexcept>

#include "mesh/fast/fast_mesh.h"

namespace umtet {

std::vector<std::string> problems(const UmParams& params) {
  std::vector<std::string> list;
  for (const std::string& problem : problems(params.paper)) list.push_back("paper." + problem);
  for (const std::string& problem : problems(params.fast)) list.push_back("fast." + problem);
  return list;
}

UmResult universal_mesh(const BackgroundMesh& background, ImplicitFunctionRef psi, const UmParams& params,
                        const UmObserver& observer, const std::vector<Vec3>& seeds) {
  std::string all;
  for (const std::string& problem : problems(params)) all += (all.empty() ? "" : "; ") + problem;
  if (params.submesh.search == SubmeshSearch::Crawl && seeds.empty()) {
    all += (all.empty() ? "" : "; ") + std::string("seeds: Crawl needs at least one");
  }
  if (!all.empty()) throw std::invalid_argument(all);
  if (params.mode == UmMode::Fast) return fast_mesh(background, psi, params.submesh, params.fast, observer, seeds);
  return algorithm_1(background, psi, params.submesh, params.paper, observer, seeds);
}

}  // namespace umtet
