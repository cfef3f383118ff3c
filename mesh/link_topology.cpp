#include "mesh/link_topology.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "mesh/tet_mesh.h"

namespace umtet {
namespace {

using Mask = unsigned;

/// The vertices of `part` that hang together with its lowest one.
Mask component(const LinkTopology& link, Mask part) {
  Mask reached = part & (~part + 1), fresh = reached;
  while (fresh != 0) {
    Mask next = 0;
    for (Mask bits = fresh; bits != 0; bits &= bits - 1) next |= link.adjacent[std::countr_zero(bits)];
    fresh = next & part & ~reached;
    reached |= fresh;
  }
  return reached;
}

bool is_connected(const LinkTopology& link, Mask part) { return part != 0 && component(link, part) == part; }

LinkState state(const LinkTopology& link, Mask inside) {
  LinkState s;
  const Mask outside = link.full() & ~inside;
  std::array<std::uint8_t, kMaxLink> degree{};     // of outside vertices, along edges of positive triangles
  std::array<std::uint16_t, kMaxLink> neighbor{};  // across those edges
  bool twice = false;                              // an edge is that of two positive triangles
  for (const auto& triangle : link.triangles) {
    Mask out = 0;
    for (const int k : triangle) out |= (1u << k) & outside;
    s.n_tets += std::popcount(out) < 3;
    if (std::popcount(out) != 2) continue;
    ++s.n_positive_faces;
    const int a = std::countr_zero(out), b = std::countr_zero(out & (out - 1));
    twice |= (neighbor[a] >> b & 1) != 0;
    neighbor[a] = static_cast<std::uint16_t>(neighbor[a] | 1u << b);
    neighbor[b] = static_cast<std::uint16_t>(neighbor[b] | 1u << a);
    ++degree[a];
    ++degree[b];
  }
  s.simple = is_connected(link, inside) && is_connected(link, outside);
  if (!s.simple || twice || s.n_positive_faces == 0) return s;
  // The positive edges around the inside part must be one cycle. Outside vertices off it are deeper outside, because
  // the outside part hangs together.
  Mask cycle = 0;
  bool good = true;
  for (int k = 0; k < link.n; ++k) {
    if (degree[k] == 0) continue;
    good &= degree[k] == 2;
    cycle |= 1u << k;
  }
  if (!good) return s;
  Mask reached = cycle & (~cycle + 1);
  for (Mask before = 0; before != reached;) {
    before = reached;
    for (Mask bits = before; bits != 0; bits &= bits - 1) reached |= neighbor[std::countr_zero(bits)];
  }
  s.manifold = reached == cycle;
  return s;
}

LinkTopology topology(const Tiling& tiling, const TilingTables& tables, int type) {
  LinkTopology link;
  const auto& vertices = tables.link[type];
  if (vertices.size() > kMaxLink) {
    throw std::invalid_argument("tiling " + tiling.name + ": a vertex with more than 16 neighbours");
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
  for (const auto& t : link.triangles) {
    for (int a = 0; a < 3; ++a) {
      link.adjacent[t[a]] =
          static_cast<std::uint16_t>(link.adjacent[t[a]] | 1u << t[(a + 1) % 3] | 1u << t[(a + 2) % 3]);
    }
  }
  link.states.resize(std::size_t{1} << link.n);
  tbb::parallel_for(std::size_t{0}, link.states.size(),
                    [&](std::size_t m) { link.states[m] = state(link, static_cast<Mask>(m)); });
  return link;
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
  return links;
}

const std::vector<LinkTopology>& a15_links() {
  static const std::vector<LinkTopology> links = link_topology(a15(), tables(a15()));
  return links;
}

}  // namespace umtet
