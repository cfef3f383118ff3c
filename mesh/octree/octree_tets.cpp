#include "mesh/octree/octree_tets.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>

#include "mesh/octree/tet_slots.h"

namespace umtet {
namespace {

constexpr int kTetsPerSample = 16;  ///< about those of a leaf, so that a search is a step or two

std::uint64_t transition_slots(const OctreeCell& leaf) {
  const std::uint64_t between = leaf.slots & tet_slots::of_faces(leaf.coarse);
  const std::uint64_t halves = leaf.slots & ~between & tet_slots::kOdd;
  return between | halves | halves >> 1;
}

}  // namespace

OctreeTets::OctreeTets(const std::vector<std::uint64_t>& cubes)
    : octree_(cubes), n_leaves_(static_cast<std::int64_t>(cubes.size())), first_vertices_(octree_.n_vertices() + 1) {
  tbb::parallel_for(0, octree_.n_cells(), [&](int c) {
    if (octree_.cell(c).is_leaf()) find_slots(c);
  });
  for (int c = 0; c < octree_.n_cells(); ++c) {
    OctreeCell& cell = octree_.cell(c);
    first_vertices_.insert(cell.first_vertex);
    cell.first_tet = n_tets_;
    n_tets_ += std::popcount(cell.slots);
    while (static_cast<std::int64_t>(tet_cell_.size()) * kTetsPerSample < n_tets_) tet_cell_.push_back(c);
    if (!cell.is_leaf()) continue;
    const GridPoint low = octree_.point(c, {0, 0, 0});
    for (int a = 0; a < 3; ++a) {
      lowest_[a] = std::min(lowest_[a], low[a]);
      highest_[a] = std::max(highest_[a], low[a] + width(cell.level));
    }
  }
  first_vertices_.index();
}

void OctreeTets::find_slots(int leaf) {
  OctreeCell& cell = octree_.cell(leaf);
  for (int f = 0; f < 6; ++f) {
    const int behind = cell.neighbor[f];
    std::uint64_t slots = 0;
    if (cell.coarse >> f & 1) {
      slots = 0xf;
    } else if (behind < 0 || (f % 2 == 1 && octree_.cell(behind).level == cell.level)) {
      for (int e = 0; e < 4; ++e) {
        const bool split = octree_.is_edge_split(leaf, f, tet_slots::on_other_face(f, e).face);
        slots |= std::uint64_t{split ? 3u : 1u} << 2 * e;
      }
    }
    cell.slots |= slots << (tet_slots::kPerFace * f);
  }
}

int OctreeTets::cell_of_vertex(std::int64_t vertex) const { return first_vertices_.rank(vertex + 1) - 1; }

int OctreeTets::cell_of_tet(std::int64_t tet) const {
  int c = tet_cell_[static_cast<std::size_t>(tet / kTetsPerSample)];
  while (c + 1 < octree_.n_cells() && octree_.cell(c + 1).first_tet <= tet) ++c;
  return c;
}

std::int64_t OctreeTets::vertex_id(const LinearOctree::VertexPlace& place) const {
  const OctreeCell& cell = octree_.cell(place.cell);
  return std::int64_t{cell.first_vertex} + std::popcount(cell.vertices & ((1u << place.bit) - 1));
}

std::int64_t OctreeTets::tet_id(int leaf, int slot) const {
  const OctreeCell& cell = octree_.cell(leaf);
  return cell.first_tet + tet_slots::rank(cell.slots, slot);
}

std::uint64_t OctreeTets::key(std::int64_t vertex) const {
  const int c = cell_of_vertex(vertex);
  const OctreeCell& cell = octree_.cell(c);
  if (!cell.is_leaf()) return octree_.corner_key(c);
  const auto bit = static_cast<std::uint64_t>(
      tet_slots::select(cell.vertices, static_cast<int>(vertex - std::int64_t{cell.first_vertex})));
  return octree_.corner_key(c) | bit << half_width_shift(cell.level);
}

std::int64_t OctreeTets::vertex_of(std::uint64_t key) const {
  const auto place = octree_.place(key);
  return place.cell < 0 ? -1 : vertex_id(place);
}

std::uint64_t OctreeTets::tet_key(std::int64_t tet) const {
  const int leaf = cell_of_tet(tet);
  const OctreeCell& cell = octree_.cell(leaf);
  const int slot = tet_slots::select(cell.slots, static_cast<int>(tet - cell.first_tet));
  return cube_key(octree_.corner_key(leaf), cell.level) << 6 | static_cast<std::uint64_t>(slot);
}

bool OctreeTets::is_transition(std::int64_t tet) const {
  const OctreeCell& cell = octree_.cell(cell_of_tet(tet));
  return (transition_slots(cell) >> tet_slots::select(cell.slots, static_cast<int>(tet - cell.first_tet)) & 1) != 0;
}

template <class VertexAt>
std::array<std::int64_t, 4> OctreeTets::corners_among(int leaf, int slot, const VertexAt& vertex) const {
  const OctreeCell& cell = octree_.cell(leaf);
  const int f = slot / tet_slots::kPerFace, rest = slot % tet_slots::kPerFace, behind = cell.neighbor[f];
  if (cell.coarse >> f & 1) {
    const bool large = (rest & 2) != 0;
    const int i = tet_slots::parent_centre(f, cell.octant), first = i + 1 + rest % 2;
    const std::int64_t p = vertex(tet_slots::corner(f, i)), q = vertex(tet_slots::corner(f, first & 3)),
                       r = vertex(tet_slots::corner(f, (first + 1) & 3));
    const bool below = large == (f % 2 == 0);  // the apex, as seen along the axis
    return {centre_id(large ? behind : leaf), p, below ? q : r, below ? r : q};
  }
  const int e = rest / 2;
  std::array<std::int64_t, 2> ends;
  if (rest % 2 == 1) {
    ends = {vertex(tet_slots::mid_point(f, e)), vertex(tet_slots::corner(f, (e + 1) & 3))};
  } else {
    const bool split = (cell.slots >> (slot + 1) & 1) != 0;
    ends = {vertex(tet_slots::corner(f, e)),
            vertex(split ? tet_slots::mid_point(f, e) : tet_slots::corner(f, (e + 1) & 3))};
  }
  const std::int64_t own = centre_id(leaf), other = behind < 0 ? vertex(tet_slots::centre(f)) : centre_id(behind);
  if (f % 2 == 0) return {other, own, ends[0], ends[1]};
  return {own, other, ends[0], ends[1]};
}

std::array<std::int64_t, 4> OctreeTets::corners(int leaf, int slot) const {
  return corners_among(leaf, slot, [&](const CubeCode& code) { return vertex_id(octree_.place(leaf, code)); });
}

IdSet OctreeTets::transition_vertices() const {
  IdSet vertices(n_vertices());
  tbb::parallel_for(0, octree_.n_cells(), [&](int leaf) {
    for (std::uint64_t slots = octree_.cell(leaf).slots & tet_slots::of_faces(octree_.cell(leaf).coarse); slots != 0;
         slots &= slots - 1) {
      for (const std::int64_t v : corners(leaf, std::countr_zero(slots))) vertices.insert_shared(v);
    }
  });
  return vertices;
}

std::array<std::int64_t, 4> OctreeTets::tet(std::int64_t tet) const {
  const int leaf = cell_of_tet(tet);
  const OctreeCell& cell = octree_.cell(leaf);
  return corners(leaf, tet_slots::select(cell.slots, static_cast<int>(tet - cell.first_tet)));
}

std::array<std::int64_t, 4> OctreeTets::Reader::tet(std::int64_t tet) {
  const LinearOctree& octree = tets_->octree_;
  const auto has = [&](int c) {
    const OctreeCell& cell = octree.cell(c);
    return cell.first_tet <= tet && tet < cell.first_tet + std::popcount(cell.slots);
  };
  if (last_ < 0 || !has(last_)) last_ = tets_->cell_of_tet(tet);
  Leaf& leaf = leaves_[static_cast<std::size_t>(last_) % kLeaves];
  if (leaf.cell != last_) {
    leaf.cell = last_;
    leaf.vertex.fill(kUnknown);
  }
  const OctreeCell& cell = octree.cell(last_);
  const int slot = tet_slots::select(cell.slots, static_cast<int>(tet - cell.first_tet));
  return tets_->corners_among(last_, slot, [&](const CubeCode& code) {
    std::int64_t& v = leaf.vertex[static_cast<std::size_t>(code_index(code))];
    if (v == kUnknown) v = tets_->vertex_id(octree.place(last_, code));
    return v;
  });
}

/// The tet with the centre of a leaf and (that half of) an edge of one of its faces, at this face.
std::int64_t OctreeTets::tet_at_edge(int leaf, int face, int e, int half) const {
  const OctreeCell& cell = octree_.cell(leaf);
  const int behind = cell.neighbor[face];
  if (cell.coarse >> face & 1) {
    const int tri = ((e - tet_slots::parent_centre(face, cell.octant)) & 3) / 2;
    return tet_id(leaf, tet_slots::kPerFace * face + tri);
  }
  if (behind < 0) return tet_id(leaf, tet_slots::kPerFace * face + 2 * e + half);
  if (octree_.cell(behind).level == cell.level) {
    return tet_id(face % 2 == 1 ? leaf : behind, tet_slots::kPerFace * (face | 1) + 2 * e + half);
  }
  const CubeCode& corner = tet_slots::corner(face, (e + half) & 3);
  const int a = face / 2;
  const int small = octree_.small_leaf(leaf, face, corner[(a + 1) % 3] == 2, corner[(a + 2) % 3] == 2);
  return tet_id(small, tet_slots::kPerFace * (face ^ 1) + 2 + (half == 0 ? 1 : 0));
}

/// The same at the other face that the edge is on.
std::int64_t OctreeTets::tet_around_edge(int leaf, int face, int e, int half, bool split) const {
  const auto& [other, edge, reversed] = tet_slots::on_other_face(face, e);
  return tet_at_edge(leaf, other, edge, split && reversed ? 1 - half : half);
}

std::int64_t OctreeTets::neighbor(std::int64_t tet, int face) const {
  const int leaf = cell_of_tet(tet);
  const OctreeCell& cell = octree_.cell(leaf);
  const int slot = tet_slots::select(cell.slots, static_cast<int>(tet - cell.first_tet));
  const int f = slot / tet_slots::kPerFace, rest = slot % tet_slots::kPerFace, behind = cell.neighbor[f];
  if (cell.coarse >> f & 1) {
    const int tri = rest % 2, i = tet_slots::parent_centre(f, cell.octant);
    const bool large = (rest & 2) != 0, below = large == (f % 2 == 0);
    const int base = tet_slots::kPerFace * f;
    if (face == 0) return tet_id(leaf, base + (rest ^ 2));
    // Opposite to the mid-point of the large leaf's edge: across the diagonal.
    const bool is_mid = face == (below == (tri == 0) ? 2 : 3);
    if (is_mid) return tet_id(leaf, base + (rest ^ 1));
    const int corner = (i + 2) & 3;  // of the large face, and of the small one
    if (face == 1) {
      if (!large) return tet_around_edge(leaf, f, tri == 0 ? (i + 1) & 3 : corner, 0, false);
      return tet_around_edge(behind, f ^ 1, tri == 0 ? (i + 1) & 3 : corner, tri == 0 ? 1 : 0, true);
    }
    if (!large) return tet_around_edge(leaf, f, tri == 0 ? i : (i + 3) & 3, 0, false);
    // The large centre, the centre of the face and the mid-point: the next small leaf at the large face.
    const CubeCode &from = tet_slots::corner(f, corner),
                   &to = tet_slots::corner(f, (tri == 0 ? corner + 3 : corner + 1) & 3);
    int next = -1;
    for (int a = 0; a < 3; ++a) {
      if (from[a] != to[a]) next = cell.neighbor[2 * a + (to[a] == 2 ? 1 : 0)];
    }
    return tet_id(next, base + 2 + (tri == 0 ? 1 : 0));
  }
  const int e = rest / 2, half = rest % 2, base = tet_slots::kPerFace * f;
  const auto is_split = [&](int edge) { return (cell.slots >> (base + 2 * edge + 1) & 1) != 0; };
  const bool split = is_split(e);
  if (face == 2) return tet_id(leaf, split && half == 0 ? slot + 1 : base + 2 * ((e + 1) & 3));
  if (face == 3) {
    const int before = (e + 3) & 3;
    return tet_id(leaf, half == 1 ? slot - 1 : base + 2 * before + (is_split(before) ? 1 : 0));
  }
  // Without the upper centre (1), at the lower leaf; without the lower (0), at the upper one.
  const int lower = f % 2 == 1 ? leaf : behind, upper = f % 2 == 1 ? behind : leaf, at = face == 1 ? lower : upper;
  return at < 0 ? -1 : tet_around_edge(at, face == 1 ? f | 1 : f & ~1, e, half, split);
}

std::int64_t OctreeTets::tet_near(const GridPoint& p) const {
  const int leaf = octree_.locate(p);
  if (leaf < 0 || !octree_.cell(leaf).is_leaf()) return -1;
  Star star;
  add_star_of_centre(leaf, star);
  return tet_id(star.parts[0].first, std::countr_zero(star.parts[0].second));
}

std::size_t OctreeTets::n_bytes() const {
  constexpr std::size_t kSetWord = sizeof(std::uint64_t) + sizeof(std::uint32_t);  // 64 ids and their rank
  return static_cast<std::size_t>(octree_.n_cells()) * (sizeof(OctreeCell) + sizeof(std::uint64_t)) +
         first_vertices_.n_words() * kSetWord + tet_cell_.size() * sizeof(tet_cell_[0]);
}

}  // namespace umtet
