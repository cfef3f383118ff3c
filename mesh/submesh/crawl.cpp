#include "mesh/submesh/crawl.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <deque>
#include <limits>
#include <unordered_set>
#include <utility>
#include <vector>

#include "common/polled_loops.h"
#include "mesh/background/link_steps.h"
#include "mesh/base/id_set.h"
#include "mesh/submesh/assemble_submesh.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {
namespace {

// Edges of a walk from a seed. One within a few h of the boundary needs a handful; a longer walk does not arrive.
constexpr int kMaxWalk = 200;
// Cut tets that are looked at from a cut edge on: a positively cut one is among the next few dozen.
constexpr std::size_t kMaxCutTets = 2000;
// Of the flood: a vertex takes some ten nanoseconds.
constexpr std::size_t kVerticesPerPoll = 1 << 16;

class Crawler {
 public:
  Crawler(const BackgroundMesh& background, ImplicitFunctionRef psi, const Context& context)
      : background_(background),
        psi_(psi),
        context_(context),
        known_(background.n_vertices()),
        inside_(background.n_vertices()),
        positive_(background.n_tets()) {}

  /// Gathers the positive faces that are connected with the one nearest to the seed.
  bool gather(const Vec3& seed) {
    const std::int64_t start = nearest_vertex(seed);
    if (start < 0) return false;
    if (touches_gathered(start)) return true;
    const std::int64_t cut = positively_cut_near(start);
    if (cut < 0) return false;
    aggregate(cut);
    return true;
  }

  IdSet flood_inside();
  std::size_t n_evaluations() const { return n_evaluations_; }

 private:
  double value(std::int64_t v) {
    if (n_evaluations_++ % kValuesPerPoll == 0) context_.poll();
    const double psi = psi_.value(background_.position(v));
    known_.insert(v);
    if (psi < 0) inside_.insert(v);
    return psi;
  }
  bool inside(std::int64_t v) {
    if (!known_.test(v)) value(v);
    return inside_.test(v);
  }
  unsigned mask(const std::array<std::int64_t, 4>& tet) {
    unsigned bits = 0;
    for (unsigned k = 0; k < 4; ++k) bits |= static_cast<unsigned>(inside(tet[k])) << k;
    return bits;
  }
  std::int64_t nearest_vertex(const Vec3& seed) const;
  bool touches_gathered(std::int64_t vertex);
  std::int64_t positively_cut_near(std::int64_t start);
  std::int64_t cut_tet_near(std::int64_t start);
  void aggregate(std::int64_t first);
  std::int64_t across_edge(std::int64_t tet, const std::array<std::int64_t, 4>& vertices, int inside_corner,
                           int edge_opposite);

  const BackgroundMesh& background_;
  ImplicitFunctionRef psi_;
  const Context& context_;
  IdSet known_, inside_;  ///< vertices where psi was evaluated, and where it was negative
  IdSet positive_;        ///< positively cut tets gathered so far
  std::vector<std::int64_t> positive_list_;
  std::vector<std::int64_t> scratch_;
  std::size_t n_evaluations_ = 0;
};

std::int64_t Crawler::nearest_vertex(const Vec3& seed) const {
  const std::int64_t tet = background_.tet_near(seed);
  if (tet < 0) return -1;
  std::int64_t best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (const std::int64_t v : background_.tet(tet)) {
    const double d2 = (background_.position(v) - seed).squaredNorm();
    if (d2 < least) least = d2, best = v;
  }
  // The tet is only in the right cell: walk down the distance.
  for (std::int64_t v = -1; v != best;) {
    v = best;
    std::vector<std::int64_t> link;
    background_.link(v, link);
    for (const std::int64_t w : link) {
      const double d2 = (background_.position(w) - seed).squaredNorm();
      if (d2 < least) least = d2, best = w;
    }
  }
  return best;
}

bool Crawler::touches_gathered(std::int64_t vertex) {
  scratch_.clear();
  background_.star(vertex, scratch_);
  return std::any_of(scratch_.begin(), scratch_.end(), [&](std::int64_t t) { return positive_.test(t); });
}

/// A tet with vertices on both sides: from vertex to vertex along the link, psi going down outside and up inside.
std::int64_t Crawler::cut_tet_near(std::int64_t start) {
  double psi_here = value(start);
  for (int step = 0; step < kMaxWalk; ++step) {
    scratch_.clear();
    background_.star(start, scratch_);
    std::int64_t next = -1;
    double best = psi_here;
    for (const std::int64_t t : scratch_) {
      for (const std::int64_t w : background_.tet(t)) {
        if (w == start) continue;
        const double psi = value(w);
        if ((psi < 0) != (psi_here < 0)) return t;
        if (psi_here < 0 ? psi > best : psi < best) best = psi, next = w;
      }
    }
    if (next < 0) return -1;  // a local extremum of psi away from the boundary
    start = next, psi_here = best;
  }
  return -1;
}

std::int64_t Crawler::positively_cut_near(std::int64_t start) {
  const std::int64_t first = cut_tet_near(start);
  if (first < 0) return -1;
  std::deque<std::int64_t> queue = {first};
  std::unordered_set<std::int64_t> seen = {first};
  while (!queue.empty() && seen.size() < kMaxCutTets) {
    const std::int64_t t = queue.front();
    queue.pop_front();
    const unsigned bits = mask(background_.tet(t));
    if (is_positively_cut(bits)) return t;
    for (int k = 0; k < 4; ++k) {
      const std::int64_t next = background_.neighbor(t, k);
      if (next < 0 || seen.count(next)) continue;
      const unsigned other = mask(background_.tet(next));
      if (other == 0 || other == 15) continue;
      seen.insert(next);
      queue.push_back(next);
    }
  }
  return -1;
}

/// The positively cut tet whose positive face meets that of `tet` at the edge opposite to `edge_opposite` in the face:
/// turning about the edge, from the side of the inside vertex, until a tet has its fourth vertex outside again.
/// -1 if the turn leaves the background mesh.
std::int64_t Crawler::across_edge(std::int64_t tet, const std::array<std::int64_t, 4>& vertices, int inside_corner,
                                  int edge_opposite) {
  std::array<std::int64_t, 2> edge;
  for (int k = 0, m = 0; k < 4; ++k) {
    if (k != inside_corner && k != edge_opposite) edge[m++] = vertices[k];
  }
  std::int64_t pivot = vertices[inside_corner];  // the vertex of the face just crossed that is not on the edge
  std::int64_t here = background_.neighbor(tet, edge_opposite);
  while (here >= 0) {
    const auto corners = background_.tet(here);
    int fresh = 0, old = 0;
    for (int k = 0; k < 4; ++k) {
      if (corners[k] == pivot) old = k;
      if (corners[k] != pivot && corners[k] != edge[0] && corners[k] != edge[1]) fresh = k;
    }
    if (!inside(corners[fresh])) return here;
    pivot = corners[fresh];
    here = background_.neighbor(here, old);
  }
  return -1;
}

void Crawler::aggregate(std::int64_t first) {
  std::vector<std::int64_t> stack = {first};
  positive_.insert(first);
  positive_list_.push_back(first);
  while (!stack.empty()) {
    const std::int64_t t = stack.back();
    stack.pop_back();
    const auto vertices = background_.tet(t);
    const int inside_corner = std::countr_zero(mask(vertices));
    for (int k = 0; k < 4; ++k) {
      if (k == inside_corner) continue;
      const std::int64_t next = across_edge(t, vertices, inside_corner, k);
      if (next < 0 || positive_.test(next)) continue;
      positive_.insert(next);
      positive_list_.push_back(next);
      stack.push_back(next);
    }
  }
}

/// The vertices inside, from those of the positively cut tets along edges.
IdSet Crawler::flood_inside() {
  const LinkSteps steps(background_);
  IdSet visited(background_.n_vertices());
  std::vector<std::int64_t> stack;
  const auto visit = [&](std::int64_t v) {
    if (visited.test(v) || (known_.test(v) && !inside_.test(v))) return;
    visited.insert(v);
    stack.push_back(v);
  };
  for (const std::int64_t t : positive_list_) {
    for (const std::int64_t v : background_.tet(t)) visit(v);
  }
  for (std::size_t n = 0; !stack.empty(); ++n) {
    if (n % kVerticesPerPoll == 0) context_.poll();
    const std::int64_t v = stack.back();
    stack.pop_back();
    if (!background_.is_lattice() || background_.on_boundary(v)) {
      scratch_.clear();
      background_.link(v, scratch_);
      for (const std::int64_t w : scratch_) visit(w);
      continue;
    }
    for (const std::int64_t step : steps.at(v)) visit(v + step);
  }
  return visited;
}

}  // namespace

CrawledVertices crawl_inside(const BackgroundMesh& background, ImplicitFunctionRef psi, const std::vector<Vec3>& seeds,
                             const Context& context) {
  Crawler crawler(background, psi, context);
  std::vector<std::size_t> lost;
  for (std::size_t s = 0; s < seeds.size(); ++s) {
    if (!crawler.gather(seeds[s])) lost.push_back(s);
  }
  IdSet inside = crawler.flood_inside();
  return {std::move(inside), std::move(lost), crawler.n_evaluations()};
}

Crawl crawl(const BackgroundMesh& background, ImplicitFunctionRef psi, const std::vector<Vec3>& seeds,
            const Context& context) {
  CrawledVertices found = crawl_inside(background, psi, seeds, context);
  return {emit_submesh(background, found.inside), std::move(found.lost_seeds), found.n_psi_evaluations};
}

}  // namespace umtet
