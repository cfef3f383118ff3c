#include "mesh/fast/defects/bad_tets.h"

#include <algorithm>
#include <cmath>

#include "mesh/core/asking_psi.h"
#include "mesh/core/max_min.h"
#include "mesh/core/tet_quality.h"
#include "mesh/fast/defects/patch_state.h"

namespace umtet {
namespace {

constexpr std::size_t kTetsPerTask = 1 << 10;  // of ten nanoseconds each, at the boundary of a hundred

}  // namespace

std::vector<BadTet> bad_tets(const BackgroundLayer& layer, const IdSet& inside_set, ImplicitFunctionRef psi,
                             double target, std::size_t& n_evaluations) {
  const std::vector<Vec3>& V = layer.layer.V;
  const std::vector<Tet>& C = layer.layer.C;
  const std::vector<std::uint8_t> inside = inside_of(layer, inside_set);
  std::vector<double> badness(C.size(), 1);
  // Nearly all tets are above the target, which takes no root to see.
  const double enough = (1 + 1e-12) * f_of_quality(target);
  n_evaluations += sum_asking<std::size_t>(psi, 0, C.size(), kTetsPerTask, {}, [&](std::size_t k, std::size_t& n) {
    const Tet& t = C[k];
    const Vec3 &p = V[t[0]], &q = V[t[1]], &r = V[t[2]], &s = V[t[3]];
    const double six = volume6(p, q, r, s), L = sum_of_squared_edges(p, q, r, s);
    if (!(six * std::abs(six) >= enough * (L * L * L))) badness[k] = mean_ratio(p, q, r, s);
    Triangle f;
    if (!positive_face(t, inside, f)) return;
    const double cosine = normal_cosine(psi, V[f[0]], V[f[1]], V[f[2]], layer.layer.h_at(f[0]), n);
    if (cosine < kMisalignedCosine) badness[k] = cosine - 1;
  });
  const auto& id = layer.background_vertex;
  std::vector<BadTet> bad;
  for (std::size_t k = 0; k < C.size(); ++k) {
    const Tet& t = C[k];
    if (badness[k] < target) bad.push_back({badness[k], {id[t[0]], id[t[1]], id[t[2]], id[t[3]]}});
  }
  return bad;
}

}  // namespace umtet
