#include <algorithm>
#include <bit>

#include "common/vec3.h"
#include "mesh/octree/octree_tets.h"
#include "mesh/octree/tet_slots.h"

namespace umtet {

void OctreeTets::Star::sort() { std::sort(parts.begin(), parts.begin() + n); }

bool OctreeTets::is_centre(std::int64_t vertex) const {
  const OctreeCell& cell = octree_.cell(cell_of_vertex(vertex));
  return cell.is_leaf() && vertex + 1 == std::int64_t{cell.first_vertex} + std::popcount(cell.vertices);
}

OctreeTets::Around OctreeTets::around(std::int64_t vertex) const {
  Around around;
  const int c = cell_of_vertex(vertex);
  const OctreeCell& cell = octree_.cell(c);
  // Eight leaves of one size, the vertex the lower corner of the last: over faces.
  if (cell.is_leaf() && vertex == std::int64_t{cell.first_vertex}) {
    around.leaves[7] = {c, 0};
    int o = 6;
    for (; o >= 0; --o) {
      const int a = std::countr_one(static_cast<unsigned>(o));
      const int leaf = octree_.cell(around.leaves[static_cast<std::size_t>(o | 1 << a)].first).neighbor[2 * a];
      if (leaf < 0 || octree_.cell(leaf).level != cell.level) break;
      around.leaves[static_cast<std::size_t>(o)] = {leaf, code_index({o & 1 ? 0 : 2, o & 2 ? 0 : 2, o & 4 ? 0 : 2})};
    }
    if (o < 0) {
      around.n = 8;
      around.of_one_size = true;
      return around;
    }
  }
  const GridPoint p = grid_point(key(vertex));
  for (int o = 0; o < 8; ++o) {
    const int leaf = octree_.locate_from(c, {p[0] - (o & 1), p[1] - (o >> 1 & 1), p[2] - (o >> 2 & 1)});
    if (leaf < 0 || !octree_.cell(leaf).is_leaf()) {
      around.is_complete = false;
      continue;
    }
    const auto end = around.leaves.begin() + around.n;
    if (std::find_if(around.leaves.begin(), end, [&](const auto& l) { return l.first == leaf; }) != end) continue;
    const GridPoint corner = octree_.point(leaf, {0, 0, 0});
    const int half = width(octree_.cell(leaf).level) / 2;
    around.leaves[static_cast<std::size_t>(around.n++)] = {
        leaf, code_index({(p[0] - corner[0]) / half, (p[1] - corner[1]) / half, (p[2] - corner[2]) / half})};
  }
  return around;
}

void OctreeTets::add_star_of_centre(int leaf, Star& star) const {
  const OctreeCell& cell = octree_.cell(leaf);
  star.add(leaf, cell.slots & ~(tet_slots::of_faces(cell.coarse) & tet_slots::kLargeSide));
  for (int f = 0; f < 6; ++f) {
    const int behind = cell.neighbor[f];
    if (behind < 0 || (cell.coarse >> f & 1)) continue;
    const std::uint64_t opposite = tet_slots::kFace << (tet_slots::kPerFace * (f ^ 1));
    if (octree_.cell(behind).level == cell.level) {
      if (f % 2 == 0) star.add(behind, octree_.cell(behind).slots & opposite);
      continue;
    }
    for (int k = 0; k < 4; ++k) {
      const int small = octree_.small_leaf(leaf, f, (k & 1) != 0, (k & 2) != 0);
      star.add(small, octree_.cell(small).slots & opposite & tet_slots::kLargeSide);
    }
  }
}

void OctreeTets::add_star_of_point(const Around& around, Star& star) const {
  for (int k = 0; k < around.n; ++k) {
    const auto& [leaf, code] = around.leaves[static_cast<std::size_t>(k)];
    star.add(leaf, tet_slots::at(octree_.cell(leaf), code));
  }
}

OctreeTets::Star OctreeTets::star_of(std::int64_t vertex) const {
  Star star;
  if (is_centre(vertex)) {
    add_star_of_centre(cell_of_vertex(vertex), star);
  } else {
    add_star_of_point(around(vertex), star);
  }
  star.sort();
  return star;
}

void OctreeTets::star(std::int64_t vertex, std::vector<std::int64_t>& tets) const {
  const Star star = star_of(vertex);
  for (int k = 0; k < star.n; ++k) {
    const auto& [leaf, bits] = star.parts[static_cast<std::size_t>(k)];
    for (std::uint64_t slots = bits; slots != 0; slots &= slots - 1)
      tets.push_back(tet_id(leaf, std::countr_zero(slots)));
  }
}

bool OctreeTets::on_boundary(std::int64_t vertex) const { return !is_centre(vertex) && !around(vertex).is_complete; }

bool OctreeTets::is_regular_centre(int leaf) const {
  const OctreeCell& cell = octree_.cell(leaf);
  std::uint64_t slots = cell.slots;
  for (int f = 0; f < 6; ++f) {
    const int behind = cell.neighbor[f];
    if (behind < 0 || octree_.cell(behind).level != cell.level) return false;
    if (f % 2 == 0) slots |= octree_.cell(behind).slots & tet_slots::kFace << (tet_slots::kPerFace * (f ^ 1));
  }
  return (slots & tet_slots::kOdd) == 0;
}

bool OctreeTets::is_regular_point(const Around& around) const {
  if (!around.of_one_size) return false;
  std::uint64_t slots = 0;
  for (const auto& [leaf, code] : around.leaves) slots |= tet_slots::at(octree_.cell(leaf), code);
  return (slots & tet_slots::kOdd) == 0;
}

bool OctreeTets::is_regular(std::int64_t vertex) const {
  return is_centre(vertex) ? is_regular_centre(cell_of_vertex(vertex)) : is_regular_point(around(vertex));
}

bool OctreeTets::bcc_link(std::int64_t vertex, BccLink& vertices) const {
  std::array<std::int64_t, 6> axis;  // below and above along x, y and z
  std::array<std::int64_t, 8> octant;
  if (is_centre(vertex)) {
    const int leaf = cell_of_vertex(vertex);
    if (!is_regular_centre(leaf)) return false;
    for (int f = 0; f < 6; ++f) axis[f] = centre_id(octree_.cell(leaf).neighbor[f]);
    for (int o = 0; o < 8; ++o) octant[o] = vertex_id(octree_.place(leaf, {2 * (o & 1), o & 2, (o & 4) / 2}));
  } else {
    const Around leaves = around(vertex);
    if (!is_regular_point(leaves)) return false;
    for (int o = 0; o < 8; ++o) octant[o] = centre_id(leaves.leaves[o].first);
    for (int a = 0; a < 3; ++a) {
      CubeCode upper = {0, 0, 0};
      upper[a] = 2;
      axis[2 * a] = vertex_id(octree_.place(leaves.leaves[7 - (1 << a)].first, {0, 0, 0}));
      axis[2 * a + 1] = vertex_id(octree_.place(leaves.leaves[7].first, upper));
    }
  }
  vertices = {axis[4], octant[0], octant[1], octant[2], octant[3], axis[2],   axis[0],
              axis[1], axis[3],   octant[4], octant[5], octant[6], octant[7], axis[5]};
  return true;
}

int OctreeTets::link_of(std::int64_t vertex, Link& link) const {
  int n = 0;
  const auto add = [&](std::int64_t v) { link[static_cast<std::size_t>(n++)] = v; };
  const auto add_place = [&](int leaf, const CubeCode& code) { add(vertex_id(octree_.place(leaf, code))); };
  const auto add_star = [&](const Star& star) {
    for (int k = 0; k < star.n; ++k) {
      const auto& [leaf, slots] = star.parts[static_cast<std::size_t>(k)];
      const OctreeCell& cell = octree_.cell(leaf);
      for (std::uint32_t codes = tet_slots::places(cell, slots); codes != 0; codes &= codes - 1) {
        const int code = std::countr_zero(codes);
        add_place(leaf, {code % 3, code / 3 % 3, code / 9});
      }
      const std::uint64_t large = slots & tet_slots::of_faces(cell.coarse) & tet_slots::kLargeSide;
      if (slots != large) add(centre_id(leaf));
      for (int f = 0; f < 6; ++f) {
        const std::uint64_t at_face = tet_slots::kFace << (tet_slots::kPerFace * f);
        const bool is_coarse = (cell.coarse >> f & 1) != 0;
        if (((is_coarse ? large : slots) & at_face) == 0) continue;
        if (cell.neighbor[f] < 0) {
          add_place(leaf, tet_slots::centre(f));
        } else {
          add(centre_id(cell.neighbor[f]));
        }
      }
    }
  };
  Star star;
  if (is_centre(vertex)) {
    const int leaf = cell_of_vertex(vertex);
    if (is_regular_centre(leaf)) {
      for (const std::int32_t behind : octree_.cell(leaf).neighbor) add(centre_id(behind));
      for (int o = 0; o < 8; ++o) add_place(leaf, {2 * (o & 1), o & 2, (o & 4) / 2});
    } else {
      add_star_of_centre(leaf, star);
      add_star(star);
    }
  } else {
    const Around leaves = around(vertex);
    if (is_regular_point(leaves)) {
      for (const auto& [leaf, code] : leaves.leaves) add(centre_id(leaf));
      for (int a = 0; a < 3; ++a) {
        CubeCode upper = {0, 0, 0};
        upper[a] = 2;
        add_place(leaves.leaves[7].first, upper);
        add_place(leaves.leaves[static_cast<std::size_t>(7 - (1 << a))].first, {0, 0, 0});
      }
    } else {
      add_star_of_point(leaves, star);
      add_star(star);
    }
  }
  std::sort(link.begin(), link.begin() + n);
  const auto end = std::unique(link.begin(), link.begin() + n);
  return static_cast<int>(std::remove(link.begin(), end, vertex) - link.begin());
}

void OctreeTets::link(std::int64_t vertex, std::vector<std::int64_t>& vertices) const {
  Link link;
  const int n = link_of(vertex, link);
  vertices.insert(vertices.end(), link.begin(), link.begin() + n);
}

double OctreeTets::mean_edge(std::int64_t vertex) const {
  if (is_regular(vertex)) return kBccMeanEdge * width(octree_.cell(cell_of_vertex(vertex)).level);
  Link others;
  const int n = link_of(vertex, others);
  const GridPoint p = grid_point(key(vertex));
  double sum = 0;
  for (int k = 0; k < n; ++k) {
    const GridPoint q = grid_point(key(others[static_cast<std::size_t>(k)]));
    sum += Vec3(q[0] - p[0], q[1] - p[1], q[2] - p[2]).norm();
  }
  return sum / n;
}

}  // namespace umtet
