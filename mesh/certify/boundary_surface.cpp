#include "mesh/certify/boundary_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <numeric>

#include "common/disjoint_sets.h"
#include "mesh/base/check_indices.h"

namespace umtet {
namespace {

/// One use of an edge by a face, under its least vertex.
struct EdgeUse {
  int other;            ///< the greater vertex
  std::int64_t source;  ///< 3 face + edge
  bool reversed;        ///< runs from the greater vertex to the least
};

/// Groups uses by their least vertex in O(n): a counting sort, then tiny sorts in each group.
class EdgeTable {
 public:
  explicit EdgeTable(std::size_t n_vertices) : begin_(n_vertices + 2, 0) {}
  void count(int least) { ++begin_[least + 2]; }
  void allocate() {
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    uses_.resize(begin_.back());
  }
  void place(int least, const EdgeUse& use) { uses_[begin_[least + 1]++] = use; }
  /// Calls f(first, last, least) for every set of uses of the same edge; within one they ascend in `source`.
  template <typename F>
  void for_each(F&& f) {
    for (std::size_t v = 0; v + 2 < begin_.size(); ++v) {
      const auto first = uses_.begin() + begin_[v], last = uses_.begin() + begin_[v + 1];
      std::sort(first, last, [](const EdgeUse& x, const EdgeUse& y) {
        return x.other != y.other ? x.other < y.other : x.source < y.source;
      });
      for (auto i = first; i != last;) {
        auto j = i;
        while (j != last && j->other == i->other) ++j;
        f(i, j, static_cast<int>(v));
        i = j;
      }
    }
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<EdgeUse> uses_;
};

/// A face at a vertex: from the next of its vertices to the last one, around the link.
struct FanStep {
  int from, to;
};
// Fans beyond this are left to the count that sorts: what is done here is quadratic in their faces.
constexpr std::size_t kMostInFan = 64;

/// Whether these steps are one closed path that meets no vertex twice. Changes their order.
bool is_cycle(FanStep* first, FanStep* end) {
  if (static_cast<std::size_t>(end - first) > kMostInFan) return false;
  for (FanStep* at = first; at + 1 < end; ++at) {
    FanStep* const next = std::find_if(at + 1, end, [&](const FanStep& s) { return s.from == at->to; });
    if (next == end) return false;
    std::swap(at[1], *next);
    for (const FanStep* s = first; s <= at; ++s) {
      if (s->from == at->to) return false;
    }
  }
  return first == end || end[-1].to == first->from;
}

/// Whether the faces at every vertex are one closed fan. Every edge then has two faces, one on either side.
bool has_closed_fans(const std::vector<Triangle>& faces, std::size_t n_vertices) {
  std::vector<std::size_t> end(n_vertices + 1, 0);
  for (const Triangle& f : faces)
    for (const int v : f) ++end[static_cast<std::size_t>(v) + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<FanStep> steps(3 * faces.size());
  for (const Triangle& f : faces)
    for (int k = 0; k < 3; ++k) steps[end[f[k]]++] = {f[(k + 1) % 3], f[(k + 2) % 3]};
  for (std::size_t v = 0, first = 0; v < n_vertices; first = end[v++]) {
    if (!is_cycle(steps.data() + first, steps.data() + end[v])) return false;
  }
  return true;
}

/// Edges: how many there are and which are bad; per component counts; the fans at each vertex through shared edges.
void count_edges(const std::vector<Triangle>& faces, std::size_t n_vertices, SurfaceTopology& s, DisjointSets& fan_of) {
  EdgeTable table(n_vertices);
  for (const Triangle& f : faces)
    for (int k = 0; k < 3; ++k) table.count(std::min(f[k], f[(k + 1) % 3]));
  table.allocate();
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const int a = faces[i][k], b = faces[i][(k + 1) % 3];
      table.place(std::min(a, b), {std::max(a, b), static_cast<std::int64_t>(3 * i + k), a > b});
    }
  }
  // Corner 3 i + k is face i at its vertex k; corners of one vertex in one fan are united through shared edges.
  const auto corner_of = [&](std::int64_t source, int v) {
    const std::int64_t i = source / 3;
    return static_cast<int>(3 * i + (faces[i][0] == v ? 0 : faces[i][1] == v ? 1 : 2));
  };
  table.for_each([&](auto first, auto last, int v) {
    ++s.n_edges;
    ++s.components[s.component[first->source / 3]].n_edges;
    if (last - first != 2) {
      ++s.n_nonmanifold_edges;
    } else if (first->reversed == (first + 1)->reversed) {
      ++s.n_misoriented_edges;
    }
    for (auto u = first + 1; u != last; ++u) {
      for (const int w : {v, first->other}) fan_of.unite(corner_of(first->source, w), corner_of(u->source, w));
    }
  });
}

void count_components(const std::vector<Vec3>& V, const std::vector<Triangle>& faces, SurfaceTopology& s) {
  DisjointSets pieces(V.size());
  std::vector<char> used(V.size(), 0);
  for (const Triangle& f : faces) {
    for (const int v : f) used[v] = 1;
    pieces.unite(f[0], f[1]);
    pieces.unite(f[0], f[2]);
  }
  std::vector<int> number(V.size(), -1);
  for (std::size_t v = 0; v < V.size(); ++v) {
    if (!used[v]) continue;
    s.vertices.push_back(static_cast<int>(v));
    int& n = number[pieces.find(static_cast<int>(v))];
    if (n < 0) {
      n = static_cast<int>(s.components.size());
      s.components.emplace_back();
    }
    ++s.components[n].n_vertices;
  }
  s.component.resize(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Triangle& f = faces[i];
    const Vec3 &a = V[f[0]], &b = V[f[1]], &c = V[f[2]];
    SurfaceComponent& part = s.components[s.component[i] = number[pieces.find(f[0])]];
    ++part.n_faces;
    part.area += face_area(a, b, c);
    part.volume += (a - V[0]).dot((b - V[0]).cross(c - V[0])) / 6.0;  // from V[0]: no cancellation far from the origin
  }
}

}  // namespace

double face_area(const Vec3& a, const Vec3& b, const Vec3& c) { return 0.5 * (b - a).cross(c - a).norm(); }

SurfaceTopology surface_topology(const std::vector<Vec3>& V, const std::vector<Triangle>& faces) {
  check_indices(faces, V.size(), "face");
  SurfaceTopology s;
  if (faces.empty()) return s;
  count_components(V, faces, s);
  const bool is_clean = has_closed_fans(faces, V.size());
  if (is_clean) {
    for (SurfaceComponent& part : s.components) s.n_edges += part.n_edges = 3 * part.n_faces / 2;
  } else {
    DisjointSets fan_of(3 * faces.size());  // of corners
    count_edges(faces, V.size(), s, fan_of);
    std::vector<int> fans(V.size(), 0);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const int corner = static_cast<int>(3 * i) + k;
        fans[faces[i][k]] += fan_of.find(corner) == corner;
      }
    }
    for (const int v : s.vertices) s.n_nonmanifold_vertices += fans[v] > 1;
  }

  for (SurfaceComponent& part : s.components) {
    part.euler_characteristic = static_cast<long>(part.n_vertices + part.n_faces) - static_cast<long>(part.n_edges);
    part.genus = (2 - part.euler_characteristic) / 2;
    s.euler_characteristic += part.euler_characteristic;
    s.genus += part.genus;
    s.area += part.area;
  }
  s.closed_manifold = s.n_nonmanifold_edges == 0 && s.n_misoriented_edges == 0 && s.n_nonmanifold_vertices == 0;
  return s;
}

}  // namespace umtet
