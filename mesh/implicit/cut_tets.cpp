#include "mesh/implicit/cut_tets.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "common/disjoint_sets.h"
#include "mesh/implicit/cut_edges.h"

namespace umtet {
namespace {

/// The cut edges of a tet, those next to each other in the polygon next to each other; by names (lower end, upper end).
struct Ring {
  std::array<std::uint64_t, 4> edge{};
  int n = 0;
};

std::uint64_t edge_name(int a, int b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint32_t>(std::max(a, b));
}
int low_end(std::uint64_t edge) { return static_cast<int>(edge >> 32); }
int high_end(std::uint64_t edge) { return static_cast<int>(edge & 0xffffffff); }

bool is_inside(double psi) { return psi < 0; }

/// A cut tet carries a triangle (one vertex apart from three) or a quadrilateral (two and two).
Ring ring_of(const CutTets& cut, const Tet& tet) {
  std::array<int, 4> in{}, out{};
  int n_in = 0, n_out = 0;
  for (const int v : tet) (is_inside(cut.psi[v]) ? in[n_in++] : out[n_out++]) = v;
  Ring ring;
  if (n_in == 2) {
    for (const auto& [a, b] : {std::pair{0, 0}, {0, 1}, {1, 1}, {1, 0}}) ring.edge[ring.n++] = edge_name(in[a], out[b]);
  } else {
    for (int a = 0; a < n_in; ++a) {
      for (int b = 0; b < n_out; ++b) ring.edge[ring.n++] = edge_name(in[a], out[b]);
    }
  }
  return ring;
}

std::vector<std::uint64_t> edges_of(const CutTets& cut) {
  std::vector<std::uint64_t> edges;
  edges.reserve(4 * cut.tets.size());
  for (const Tet& tet : cut.tets) {
    const Ring ring = ring_of(cut, tet);
    edges.insert(edges.end(), ring.edge.begin(), ring.edge.begin() + ring.n);
  }
  tbb::parallel_sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  if (edges.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw std::length_error("the zero set has more than 2^31 cut edges");
  }
  return edges;
}

/// Where psi = 0 on an edge, linear. What is not finite is as far as can be.
Vec3 point_on(const CutTets& cut, std::uint64_t edge) {
  const auto value = [&](int v) { return std::isfinite(cut.psi[v]) ? cut.psi[v] : std::numeric_limits<double>::max(); };
  const int a = low_end(edge), b = high_end(edge);
  const double va = value(a), vb = value(b);
  return cut.x[a] + va / (va - vb) * (cut.x[b] - cut.x[a]);
}

/// Counts the polygons of the tets at their edges.
class Counter {
 public:
  explicit Counter(const CutTets& cut)
      : cut_(cut), names_(edges_of(cut)), edges_(names_.size()), surface_(names_.size()) {
    tbb::parallel_for(std::size_t{0}, names_.size(), [&](std::size_t e) {
      edges_[e].point = point_on(cut, names_[e]);
      edges_[e].on_wall = on_boundary(names_[e]);
    });
  }
  ZeroSetTopology run();

 private:
  bool on_boundary(std::uint64_t edge) const {
    return cut_.on_boundary[low_end(edge)] != 0 && cut_.on_boundary[high_end(edge)] != 0;
  }
  void add(const Tet& tet);

  const CutTets& cut_;
  const std::vector<std::uint64_t> names_;
  std::vector<CutEdge> edges_;
  DisjointSets surface_;
};

void Counter::add(const Tet& tet) {
  const Ring ring = ring_of(cut_, tet);
  std::array<int, 4> e{};
  for (int k = 0; k < ring.n; ++k) {
    e[k] = static_cast<int>(std::lower_bound(names_.begin(), names_.end(), ring.edge[k]) - names_.begin());
  }
  const Vec3& origin = edges_[e[0]].point;
  double area = 0;
  for (int k = 1; k + 1 < ring.n; ++k) {
    area += .5 * (edges_[e[k]].point - origin).cross(edges_[e[k + 1]].point - origin).norm();
  }
  std::int32_t& faces_minus_edges2 = edges_[e[0]].faces_minus_edges2;
  faces_minus_edges2 += 2 - ring.n;  // each of its cut triangles belongs to another tet, too
  for (int k = 0; k < ring.n; ++k) {
    edges_[e[k]].area += area / ring.n;
    surface_.unite(e[0], e[k]);
    if (edges_[e[k]].on_wall && edges_[e[(k + 1) % ring.n]].on_wall) --faces_minus_edges2;  // or to none
  }
}

ZeroSetTopology Counter::run() {
  for (const Tet& tet : cut_.tets) add(tet);
  ZeroSetTopology result = topology_of(edges_, surface_);
  double longest2 = 0;
  for (const std::uint64_t e : names_) {
    longest2 = std::max(longest2, (cut_.x[high_end(e)] - cut_.x[low_end(e)]).squaredNorm());
  }
  result.spacing = std::sqrt(longest2 / 3);
  result.n_not_finite = static_cast<std::size_t>(
      std::count_if(cut_.psi.begin(), cut_.psi.end(), [](double v) { return !std::isfinite(v); }));
  return result;
}

}  // namespace

ZeroSetTopology zero_set_topology(const CutTets& cut) { return Counter(cut).run(); }

}  // namespace umtet
