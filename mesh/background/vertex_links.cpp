#include "mesh/background/vertex_links.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <numeric>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>

#include "mesh/background/tet_reader.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {
namespace {

// Link vertices are put in an order by their places around the vertex, to within this part of its edge length: the
// same order wherever the mesh looks the same, whatever rounding or optimisation has done to the places.
constexpr double kOrderParts = 8;
// Edge lengths of one type differ by a 64th of an octave at most, one percent.
constexpr float kStepsPerOctave = 64;
// A type with so many vertices for each state that its masks may have gets a table of them: then few of them are
// computed in vain.
constexpr std::size_t kStatesPerVertex = 4;
constexpr int kMostTabulated = 16;
constexpr std::int64_t kVerticesPerTask = 1 << 10;  // of a microsecond or two each

using TriangleOfLink = std::array<std::uint8_t, 3>;

std::uint8_t number_of(std::span<const int> link, std::int64_t w) {
  return static_cast<std::uint8_t>(std::find(link.begin(), link.end(), w) - link.begin());
}

/// Those of a BccLink, as Links puts them in order.
std::vector<TriangleOfLink> bcc_triangles() {
  const auto number = [](int octant) { return static_cast<std::uint8_t>(octant + (octant < 4 ? 1 : 5)); };
  constexpr std::array<std::uint8_t, 6> kOnAxis = {6, 7, 5, 8, 0, 13};
  std::vector<TriangleOfLink> triangles;
  for (int f = 0; f < 6; ++f) {
    const int a = f / 2, u = 1 << (a + 1) % 3, v = 1 << (a + 2) % 3, at = f % 2 << a;
    // Around the face, counter-clockwise as seen from the upper side of the axis.
    const std::array<int, 4> corners = {at, at | u, at | u | v, at | v};
    for (std::size_t e = 0; e < 4; ++e) {
      const std::uint8_t p = number(corners[e]), q = number(corners[(e + 1) % 4]);
      TriangleOfLink made = {kOnAxis[static_cast<std::size_t>(f)], f % 2 == 1 ? p : q, f % 2 == 1 ? q : p};
      while (made[0] > made[1] || made[0] > made[2]) made = {made[1], made[2], made[0]};
      triangles.push_back(made);
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

float rounded(float unit) { return std::exp2(std::round(std::log2(unit) * kStepsPerOctave) / kStepsPerOctave); }

/// As a key: the bytes of what makes a type.
std::string key_of(const LinkTopology& link) {
  std::string key(sizeof(float), '\0');
  std::memcpy(key.data(), &link.unit, sizeof(float));
  key.append(link.back.begin(), link.back.begin() + link.n);
  for (const TriangleOfLink& t : link.triangles) key.append(t.begin(), t.end());
  return key;
}

/// Whole numbers z, y and x as one that sorts in this order. Of more than a million edges all are alike.
std::uint64_t place_in_order(const Vec3& x) {
  constexpr double kMost = 1 << 20;
  std::uint64_t place = 0;
  for (int a = 2; a >= 0; --a) {
    place = place << 21 | static_cast<std::uint64_t>(std::llround(std::clamp(x[a], -kMost, kMost - 1) + kMost));
  }
  return place;
}

/// Link and triangles of one vertex after the other, in their order; keeps its memory.
class Links {
 public:
  explicit Links(const BackgroundMesh& background) : background_(background), tets_(background) {}

  void read(std::int64_t v);
  std::size_t n() const { return ordered_.size(); }
  std::int64_t vertex(std::size_t k) const { return ids_[ordered_[k].among_ids]; }
  const std::vector<TriangleOfLink>& triangles() const { return triangles_; }
  double mean_edge() const { return mean_edge_; }

 private:
  struct Neighbour {
    std::uint64_t place;  ///< z, y, x
    std::uint32_t among_ids;
    auto operator<=>(const Neighbour&) const = default;
  };
  const BackgroundMesh& background_;
  TetReader tets_;
  std::vector<std::int64_t> star_;
  std::vector<std::array<std::int64_t, 3>> opposite_;
  std::vector<std::int64_t> ids_;  ///< ascending
  std::vector<Vec3> edges_;
  double mean_edge_ = 0;
  std::vector<Neighbour> ordered_;
  std::vector<std::uint8_t> number_;  ///< of each of ids_ in this order
  std::vector<TriangleOfLink> triangles_;
};

void Links::read(std::int64_t v) {
  star_.clear();
  opposite_.clear();
  ids_.clear();
  ordered_.clear();
  triangles_.clear();
  background_.star(v, star_);
  for (const std::int64_t t : star_) {
    const auto tet = tets_.tet(t);
    const auto& f = kTetFace[static_cast<std::size_t>(std::find(tet.begin(), tet.end(), v) - tet.begin())];
    opposite_.push_back({tet[f[0]], tet[f[1]], tet[f[2]]});
    ids_.insert(ids_.end(), opposite_.back().begin(), opposite_.back().end());
  }
  std::sort(ids_.begin(), ids_.end());
  ids_.erase(std::unique(ids_.begin(), ids_.end()), ids_.end());
  const Vec3 x = background_.position(v);
  edges_.clear();
  double sum = 0;
  for (const std::int64_t w : ids_) {
    edges_.push_back(background_.position(w) - x);
    sum += edges_.back().norm();
  }
  mean_edge_ = ids_.empty() ? 0 : sum / static_cast<double>(ids_.size());
  for (std::size_t k = 0; k < ids_.size(); ++k) {
    const Vec3 d = edges_[k] * (kOrderParts / mean_edge_);
    ordered_.push_back({place_in_order(d), static_cast<std::uint32_t>(k)});
  }
  std::sort(ordered_.begin(), ordered_.end());
  if (ordered_.size() > kMaxLink) return;
  number_.resize(ids_.size());
  for (std::size_t k = 0; k < ordered_.size(); ++k) number_[ordered_[k].among_ids] = static_cast<std::uint8_t>(k);
  const auto number = [&](std::int64_t w) {
    return number_[static_cast<std::size_t>(std::lower_bound(ids_.begin(), ids_.end(), w) - ids_.begin())];
  };
  for (const auto& o : opposite_) {
    // In a cycle from the least: tets are listed by their ids, which says nothing of the shape of a link.
    TriangleOfLink made = {number(o[0]), number(o[1]), number(o[2])};
    while (made[0] > made[1] || made[0] > made[2]) made = {made[1], made[2], made[0]};
    triangles_.push_back(made);
  }
  // Not by operator<, which calls memcmp() for three bytes.
  const auto as_number = [](const TriangleOfLink& t) { return t[0] << 16 | t[1] << 8 | t[2]; };
  std::sort(triangles_.begin(), triangles_.end(),
            [&](const TriangleOfLink& a, const TriangleOfLink& b) { return as_number(a) < as_number(b); });
}

class Lister {
 public:
  explicit Lister(const BackgroundMesh& background)
      : background_(background),
        n_(background.n_vertices()),
        is_bcc_(static_cast<std::size_t>(n_), 0),
        parts_(static_cast<std::size_t>((n_ + kVerticesPerTask - 1) / kVerticesPerTask)) {}

  /// Returns false where a link is too large.
  bool list_vertices(std::vector<std::size_t>& begin, std::vector<int>& vertices);
  void find_types(const std::vector<std::size_t>& begin, const std::vector<int>& vertices, std::vector<int>& type,
                  std::vector<LinkTopology>& topologies);

 private:
  /// What one task has found of its vertices.
  struct Part {
    std::vector<int> vertices;
    std::vector<TriangleOfLink> triangles;   ///< but for those of BccLinks
    std::vector<std::uint16_t> n_triangles;  ///< of each vertex
    std::vector<float> unit;                 ///< of each vertex
    std::unordered_map<std::string, int> number;
    std::vector<std::pair<float, int>> number_of_bcc;  ///< by unit, of those among their like
    std::vector<const std::string*> keys;              ///< of the types that it met
    std::vector<LinkTopology> topologies;
    std::vector<std::size_t> uses;
    std::vector<int> renumbered;
  };
  template <class F>
  void for_each_part(const F& f) {
    tbb::parallel_for(std::size_t{0}, parts_.size(), [&](std::size_t k) {
      const std::int64_t first = static_cast<std::int64_t>(k) * kVerticesPerTask;
      f(parts_[k], first, std::min(n_, first + kVerticesPerTask));
    });
  }
  void number_types(std::vector<LinkTopology>& topologies, std::vector<std::size_t>& uses);
  bool list_bcc(std::int64_t v, Part& part);
  static int type_number(const LinkTopology& link, Part& part);

  const BackgroundMesh& background_;
  const std::int64_t n_;
  std::vector<std::uint8_t> is_bcc_;  ///< whether the link of a vertex is a BccLink
  const std::vector<TriangleOfLink> bcc_triangles_ = bcc_triangles();
  std::vector<Part> parts_;
};

/// Returns false where the link of the vertex is none.
bool Lister::list_bcc(std::int64_t v, Part& part) {
  BccLink link;
  if (!background_.bcc_link(v, link)) return false;
  is_bcc_[static_cast<std::size_t>(v)] = 1;
  part.vertices.insert(part.vertices.end(), link.begin(), link.end());
  const double width = (background_.position(link.back()) - background_.position(v)).norm();
  part.unit.push_back(rounded(static_cast<float>(kBccMeanEdge * width / background_.h())));
  part.n_triangles.push_back(0);
  return true;
}

bool Lister::list_vertices(std::vector<std::size_t>& begin, std::vector<int>& vertices) {
  begin.assign(static_cast<std::size_t>(n_) + 1, 0);
  std::atomic<bool> fits = true;
  for_each_part([&](Part& part, std::int64_t first, std::int64_t last) {
    Links links(background_);
    for (std::int64_t v = first; v < last; ++v) {
      if (list_bcc(v, part)) {
        begin[static_cast<std::size_t>(v) + 1] = std::tuple_size_v<BccLink>;
        continue;
      }
      links.read(v);
      if (links.n() > kMaxLink) fits = false;
      for (std::size_t k = 0; k < links.n(); ++k) part.vertices.push_back(static_cast<int>(links.vertex(k)));
      part.triangles.insert(part.triangles.end(), links.triangles().begin(), links.triangles().end());
      part.n_triangles.push_back(static_cast<std::uint16_t>(links.triangles().size()));
      part.unit.push_back(links.n() == 0 ? 1.F : rounded(static_cast<float>(links.mean_edge() / background_.h())));
      begin[static_cast<std::size_t>(v) + 1] = links.n();
    }
  });
  if (!fits) return false;
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  vertices.resize(begin.back());
  for_each_part([&](Part& part, std::int64_t first, std::int64_t) {
    std::copy(part.vertices.begin(), part.vertices.end(),
              vertices.begin() + static_cast<std::ptrdiff_t>(begin[static_cast<std::size_t>(first)]));
  });
  return true;
}

/// Part by part, so that threads do not matter.
void Lister::number_types(std::vector<LinkTopology>& topologies, std::vector<std::size_t>& uses) {
  std::unordered_map<std::string, int> number;
  for (Part& part : parts_) {
    for (std::size_t k = 0; k < part.topologies.size(); ++k) {
      const auto [at, is_new] = number.try_emplace(*part.keys[k], static_cast<int>(topologies.size()));
      if (is_new) {
        topologies.push_back(std::move(part.topologies[k]));
        uses.push_back(0);
      }
      uses[static_cast<std::size_t>(at->second)] += part.uses[k];
      part.renumbered.push_back(at->second);
    }
  }
}

int Lister::type_number(const LinkTopology& link, Part& part) {
  const auto [at, is_new] = part.number.try_emplace(key_of(link), static_cast<int>(part.topologies.size()));
  if (is_new) {
    part.keys.push_back(&at->first);
    part.topologies.push_back(link);
    part.uses.push_back(0);
  }
  return at->second;
}

void Lister::find_types(const std::vector<std::size_t>& begin, const std::vector<int>& vertices, std::vector<int>& type,
                        std::vector<LinkTopology>& topologies) {
  const auto link_of = [&](std::int64_t v) {
    const auto at = static_cast<std::size_t>(v);
    return std::span(vertices.data() + begin[at], begin[at + 1] - begin[at]);
  };
  type.resize(static_cast<std::size_t>(n_));
  for_each_part([&](Part& part, std::int64_t first, std::int64_t last) {
    LinkTopology link;
    auto triangle = part.triangles.begin();
    for (std::int64_t v = first; v < last; ++v) {
      const std::span<const int> ring = link_of(v);
      const auto at = static_cast<std::size_t>(v - first);
      const bool is_bcc = is_bcc_[static_cast<std::size_t>(v)] != 0;
      const bool among_bcc = is_bcc && std::all_of(ring.begin(), ring.end(), [&](int w) { return is_bcc_[w] != 0; });
      int& own = type[static_cast<std::size_t>(v)];
      if (among_bcc) {
        const auto known = std::find_if(part.number_of_bcc.begin(), part.number_of_bcc.end(),
                                        [&](const auto& n) { return n.first == part.unit[at]; });
        if (known != part.number_of_bcc.end()) {
          own = known->second;
          ++part.uses[static_cast<std::size_t>(own)];
          continue;
        }
      }
      link.n = static_cast<int>(ring.size());
      if (is_bcc) {
        link.triangles = bcc_triangles_;
      } else {
        link.triangles.assign(triangle, triangle + part.n_triangles[at]);
        triangle += part.n_triangles[at];
      }
      link.back = {};
      for (int k = 0; k < link.n; ++k) link.back[k] = number_of(link_of(ring[k]), v);
      link.unit = part.unit[at];
      own = type_number(link, part);
      if (among_bcc) part.number_of_bcc.emplace_back(link.unit, own);
      ++part.uses[static_cast<std::size_t>(own)];
    }
  });
  std::vector<std::size_t> uses;
  number_types(topologies, uses);
  for_each_part([&](Part& part, std::int64_t first, std::int64_t last) {
    for (std::int64_t v = first; v < last; ++v) {
      int& own = type[static_cast<std::size_t>(v)];
      own = part.renumbered[static_cast<std::size_t>(own)];
    }
  });
  tbb::parallel_for(std::size_t{0}, topologies.size(), [&](std::size_t k) {
    LinkTopology& link = topologies[k];
    link.site = link.n;
    link.adjacent.assign(static_cast<std::size_t>(link.n), 0);
    for (const TriangleOfLink& t : link.triangles) {
      for (int a = 0; a < 3; ++a) link.adjacent[t[a]] |= LinkMask{1} << t[(a + 1) % 3] | LinkMask{1} << t[(a + 2) % 3];
    }
    if (link.n > kMostTabulated || link.n == 0 || uses[k] * kStatesPerVertex < std::size_t{1} << link.n) return;
    link.states.resize(std::size_t{1} << link.n);
    tbb::parallel_for(std::size_t{0}, link.states.size(), [&](std::size_t m) { link.states[m] = link.find_state(m); });
  });
}

}  // namespace

VertexLinks::VertexLinks(const BackgroundMesh& lattice, const std::vector<LinkTopology>& of_types)
    : steps_(lattice), topologies_(&of_types) {}

std::shared_ptr<const VertexLinks> VertexLinks::listed(const BackgroundMesh& background) {
  Listed made;
  Lister lister(background);
  if (!lister.list_vertices(made.begin, made.vertices)) return nullptr;
  lister.find_types(made.begin, made.vertices, made.type, made.topologies);
  return std::shared_ptr<const VertexLinks>(new VertexLinks(std::move(made)));
}

}  // namespace umtet
