#include "mesh/background/link_topology.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "mesh/core/tet_mesh.h"

namespace umtet {
namespace {

// Bound of the states in the tables of all links, which are made once. The cube would have 9 million of them, 35 MB:
// there they are computed at every look-up.
constexpr std::size_t kMostStates = std::size_t{1} << 19;
constexpr int kMostInTable = 16;

constexpr LinkMask bit(int k) { return LinkMask{1} << k; }

/// The vertices of `part` that are connected with its lowest one.
LinkMask component(const LinkTopology& link, LinkMask part) {
  LinkMask reached = part & (~part + 1), fresh = reached;
  while (fresh != 0) {
    LinkMask next = 0;
    for (LinkMask bits = fresh; bits != 0; bits &= bits - 1) next |= link.adjacent[std::countr_zero(bits)];
    fresh = next & part & ~reached;
    reached |= fresh;
  }
  return reached;
}

}  // namespace

bool LinkTopology::is_connected(LinkMask part) const { return part != 0 && component(*this, part) == part; }

LinkState LinkTopology::find_state(LinkMask inside) const {
  LinkState s;
  const LinkMask outside = full() & ~inside;
  std::array<std::uint8_t, kMaxLink> degree{};  // of outside vertices, along edges of positive triangles
  std::array<LinkMask, kMaxLink> neighbor{};    // across those edges
  bool twice = false;                           // an edge is that of two positive triangles
  for (const auto& triangle : triangles) {
    LinkMask out = 0;
    for (const int k : triangle) out |= bit(k) & outside;
    s.n_tets += std::popcount(out) < 3;
    if (std::popcount(out) != 2) continue;
    ++s.n_positive_faces;
    const int a = std::countr_zero(out), b = std::countr_zero(out & (out - 1));
    twice |= (neighbor[a] >> b & 1) != 0;
    neighbor[a] |= bit(b);
    neighbor[b] |= bit(a);
    ++degree[a];
    ++degree[b];
  }
  s.simple = is_connected(inside) && is_connected(outside);
  if (!s.simple || twice || s.n_positive_faces == 0) return s;
  // The positive edges around the inside part must be one cycle. Outside vertices off it are deeper outside, because
  // the outside part is connected.
  LinkMask cycle = 0;
  bool good = true;
  for (int k = 0; k < n; ++k) {
    if (degree[k] == 0) continue;
    good &= degree[k] == 2;
    cycle |= bit(k);
  }
  if (!good) return s;
  LinkMask reached = cycle & (~cycle + 1);
  for (LinkMask before = 0; before != reached;) {
    before = reached;
    for (LinkMask bits = before; bits != 0; bits &= bits - 1) reached |= neighbor[std::countr_zero(bits)];
  }
  s.manifold = reached == cycle;
  return s;
}

namespace {

LinkTopology topology(const Tiling& tiling, const TilingTables& tables, int type) {
  LinkTopology link;
  const auto& vertices = tables.link[type];
  if (vertices.size() > kMaxLink) {
    throw std::invalid_argument("tiling " + tiling.name + ": a vertex with more than " + std::to_string(kMaxLink) +
                                " neighbours");
  }
  link.n = static_cast<int>(vertices.size());
  const auto number = [](const std::vector<Tiling::Corner>& list, int wanted, const std::array<int, 3>& offset) {
    const auto at = std::find_if(list.begin(), list.end(),
                                 [&](const Tiling::Corner& c) { return c.type == wanted && c.offset == offset; });
    return static_cast<std::uint8_t>(at - list.begin());
  };
  for (int k = 0; k < link.n; ++k) {
    const auto& o = vertices[k].offset;
    link.back[k] = number(tables.link[vertices[k].type], type, {-o[0], -o[1], -o[2]});
  }
  for (const auto& [tet, offset] : tables.star[type]) {
    std::array<std::uint8_t, 4> corners{};
    int own = 0;
    for (int c = 0; c < 4; ++c) {
      const Tiling::Corner& corner = tiling.tets[tet][c];
      const std::array<int, 3> o = {offset[0] + corner.offset[0], offset[1] + corner.offset[1],
                                    offset[2] + corner.offset[2]};
      if (corner.type == type && o == std::array<int, 3>{0, 0, 0}) {
        own = c;
      } else {
        corners[c] = number(vertices, corner.type, o);
      }
    }
    const auto& f = kTetFace[own];
    link.triangles.push_back({corners[f[0]], corners[f[1]], corners[f[2]]});
  }
  link.adjacent.assign(static_cast<std::size_t>(link.n), 0);
  for (const auto& t : link.triangles) {
    for (int a = 0; a < 3; ++a) link.adjacent[t[a]] |= bit(t[(a + 1) % 3]) | bit(t[(a + 2) % 3]);
  }
  return link;
}

void make_tables(std::vector<LinkTopology>& links) {
  const auto n_states = [](const LinkTopology& l) { return l.n <= kMostInTable ? std::size_t{1} << l.n : 0; };
  std::size_t sum = 0;
  for (const LinkTopology& link : links) sum += n_states(link);
  if (sum > kMostStates) return;
  for (LinkTopology& link : links) {
    link.states.resize(n_states(link));
    tbb::parallel_for(std::size_t{0}, link.states.size(), [&](std::size_t m) { link.states[m] = link.find_state(m); });
  }
}

}  // namespace

std::vector<LinkTopology> link_topology(const Tiling& tiling, const TilingTables& tables) {
  std::vector<LinkTopology> links;
  std::map<std::pair<int, std::size_t>, int> sites;
  for (int type = 0; type < static_cast<int>(tiling.points.size()); ++type) {
    links.push_back(topology(tiling, tables, type));
    sites.emplace(std::pair(links.back().n, links.back().triangles.size()), 0);
  }
  int site = 0;
  for (auto& entry : sites) entry.second = site++;
  for (LinkTopology& link : links) link.site = sites.at({link.n, link.triangles.size()});
  make_tables(links);
  return links;
}

const std::vector<LinkTopology>& a15_links() {
  static const std::vector<LinkTopology> links = link_topology(a15(), tables(a15()));
  return links;
}

}  // namespace umtet
