#include "mesh/submesh/inside_walk.h"

#include <algorithm>

#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"
#include "mesh/submesh/assemble_submesh.h"

namespace umtet {

InsideWalk::InsideWalk(const BackgroundMesh& background)
    : background_(background), inside_(background.n_vertices()), seen_(background.n_vertices()) {
  if (!background.is_lattice()) return;
  steps_.resize(background.n_types());
  for (int type = 0; type < background.n_types(); ++type) {
    for (const Tiling::Corner& c : background.tiling_tables().link[type]) {
      steps_[type].push_back(background.id_step(type, c));
    }
  }
}

template <class F>
void InsideWalk::for_each_neighbour(std::int64_t v, const F& f) const {
  if (background_.is_lattice() && !background_.on_boundary(v)) {
    for (const std::int64_t step : steps_[background_.type(v)]) f(v + step);
    return;
  }
  std::vector<std::int64_t> link;
  background_.link(v, link);
  for (const std::int64_t w : link) f(w);
}

bool InsideWalk::is_at_boundary(std::int64_t v) const {
  const bool side = inside_.test(v);
  bool other = false;
  for_each_neighbour(v, [&](std::int64_t w) { other |= inside_.test(w) != side; });
  return other;
}

std::size_t InsideWalk::restart(ImplicitFunctionRef psi, const Context& context) {
  std::size_t n = 0;
  inside_ = inside_vertices(background_, psi, n, context);
  boundary_.clear();
  values_.clear();
  inside_.for_each([&](std::int64_t v) {
    bool cut = false;
    for_each_neighbour(v, [&](std::int64_t w) {
      if (inside_.test(w)) return;
      cut = true;
      boundary_.push_back(w);
    });
    if (cut) boundary_.push_back(v);
  });
  std::sort(boundary_.begin(), boundary_.end());
  boundary_.erase(std::unique(boundary_.begin(), boundary_.end()), boundary_.end());
  return n;
}

std::size_t InsideWalk::update(ImplicitFunctionRef psi, const std::vector<std::int64_t>& more, const Context& context) {
  std::vector<std::int64_t> changed, front;
  PsiValues evaluated;
  const auto add = [&](std::int64_t v) {
    if (seen_.test(v)) return;
    seen_.insert(v);
    front.push_back(v);
  };
  for (const std::int64_t v : boundary_) add(v);
  for (const std::int64_t v : more) add(v);
  const auto forget = [&] {
    for (const PsiValue& at : evaluated) seen_.erase(at.vertex);
    for (const std::int64_t v : front) seen_.erase(v);
  };
  try {
    while (!front.empty()) {
      const std::size_t first = evaluated.size(), n = front.size();
      for (const std::int64_t v : front) evaluated.push_back({v, 0, Vec3::Zero()});
      for_each_asking(psi, n, kValuesPerPoll, context, [&](std::size_t k) {
        PsiValue& at = evaluated[first + k];
        at.value = psi.value(background_.position(at.vertex), at.gradient);
      });
      front.clear();
      for (std::size_t k = first; k < first + n; ++k) {
        const std::int64_t v = evaluated[k].vertex;
        if ((evaluated[k].value < 0) == inside_.test(v)) continue;
        changed.push_back(v);
        for_each_neighbour(v, add);
      }
    }
  } catch (...) {
    forget();
    throw;
  }
  for (const std::int64_t v : changed) inside_.test(v) ? inside_.erase(v) : inside_.insert(v);
  // A vertex at the boundary now was there before, or has changed sides, or has a neighbour that has: psi was evaluated
  // at all of these.
  forget();
  values_.clear();
  for (const PsiValue& at : evaluated) {
    if (is_at_boundary(at.vertex)) values_.push_back(at);
  }
  std::sort(values_.begin(), values_.end(), [](const PsiValue& a, const PsiValue& b) { return a.vertex < b.vertex; });
  boundary_.clear();
  for (const PsiValue& at : values_) boundary_.push_back(at.vertex);
  return evaluated.size();
}

}  // namespace umtet
