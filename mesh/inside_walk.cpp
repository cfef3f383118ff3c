#include "mesh/inside_walk.h"

#include <algorithm>

#include "mesh/detail/assemble_submesh.h"

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
  if (background_.is_lattice() && !background_.on_rim(v)) {
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

std::size_t InsideWalk::restart(ImplicitFunctionRef psi, const KeepGoing& keep_going) {
  std::size_t n = 0;
  inside_ = detail::inside_vertices(background_, psi, n, keep_going);
  boundary_.clear();
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

std::size_t InsideWalk::update(ImplicitFunctionRef psi, const std::vector<std::int64_t>& more,
                               const KeepGoing& keep_going) {
  std::vector<std::int64_t> asked, changed, front;
  const auto add = [&](std::int64_t v) {
    if (seen_.test(v)) return;
    seen_.insert(v);
    asked.push_back(v);
    front.push_back(v);
  };
  for (const std::int64_t v : boundary_) add(v);
  for (const std::int64_t v : more) add(v);
  std::vector<unsigned char> changes;
  try {
    while (!front.empty()) {
      changes.assign(front.size(), 0);
      polled_parallel_for(front.size(), kValuesPerPoll, keep_going, [&](std::size_t k) {
        changes[k] = (psi.value(background_.position(front[k])) < 0) != inside_.test(front[k]);
      });
      const std::vector<std::int64_t> last = std::move(front);
      front.clear();
      for (std::size_t k = 0; k < last.size(); ++k) {
        if (changes[k] == 0) continue;
        changed.push_back(last[k]);
        for_each_neighbour(last[k], add);
      }
    }
  } catch (...) {
    for (const std::int64_t v : asked) seen_.erase(v);
    throw;
  }
  for (const std::int64_t v : changed) inside_.test(v) ? inside_.erase(v) : inside_.insert(v);
  // Whoever is at the boundary now was there before, or has changed sides, or is a neighbour of one that has: asked.
  for (const std::int64_t v : asked) seen_.erase(v);
  boundary_.clear();
  for (const std::int64_t v : asked) {
    if (is_at_boundary(v)) boundary_.push_back(v);
  }
  std::sort(boundary_.begin(), boundary_.end());
  return asked.size();
}

}  // namespace umtet
