#include "mesh/background/graded_mesh.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "mesh/background/balanced_octree.h"
#include "mesh/background/tet_slots.h"
#include "mesh/core/tet_quality.h"

namespace umtet {
namespace {

/// Mean edge length of BCC tets in leaves of width 1: six edges of 1 and eight of sqrt(3) / 2 meet at a vertex.
const double kMeanEdge = (6 + 8 * std::sqrt(.75)) / 14;

// A leaf has at most 6 x 8 tets on either side of its faces.
constexpr int kMaxSteps = 96;

constexpr int kTetsPerSample = 16;  ///< about those of a leaf, so that a search is a step or two

struct RootCube {
  Vec3 origin;
  double width = 0;
  int max_level = 0;
};

RootCube root_cube(const Grading& g) {
  if (g.box.isEmpty() || !g.box.sizes().allFinite()) throw std::invalid_argument("box: must be finite and not empty");
  if (!(g.finest > 0) || !std::isfinite(g.finest)) {
    throw std::invalid_argument("finest = " + std::to_string(g.finest) + ": must be > 0");
  }
  if (!(g.tolerance > 0)) throw std::invalid_argument("tolerance = " + std::to_string(g.tolerance) + ": must be > 0");
  if (!g.size) throw std::invalid_argument("size: a function is needed");
  RootCube root;
  root.width = g.finest / kMeanEdge;
  for (; root.width < g.box.sizes().maxCoeff(); root.width *= 2) ++root.max_level;
  if (root.max_level > kMaxOctreeLevel) {
    throw std::invalid_argument("finest = " + std::to_string(g.finest) + ": the box would need " +
                                std::to_string(root.max_level) + " levels, more than " +
                                std::to_string(kMaxOctreeLevel));
  }
  root.origin = g.box.center() - Vec3::Constant(.5 * root.width);
  return root;
}

std::vector<std::uint64_t> leaves_of(const Grading& g, const RootCube& root) {
  const double unit = root.width / kRootWidth;
  const auto half_width = [&](std::uint64_t cube) { return .5 * unit * width(cube_level(cube)); };
  const auto centre = [&](std::uint64_t cube) -> Vec3 {
    const GridPoint p = grid_point(cube);
    return root.origin + unit * Vec3(p[0], p[1], p[2]);
  };
  OctreeRules rules{.max_level = root.max_level, .splits = {}, .wanted = {}, .max_leaves = g.max_leaves};
  rules.splits = [&](std::uint64_t cube) {
    const double half = half_width(cube), size = g.size(centre(cube), half);
    if (!(size > 0)) throw std::invalid_argument("size = " + std::to_string(size) + ": must be > 0");
    return kMeanEdge * 2 * half > g.tolerance * size;
  };
  if (g.wanted) rules.wanted = [&](std::uint64_t cube) { return g.wanted(centre(cube), half_width(cube)); };
  try {
    return balanced_octree(rules);
  } catch (const std::length_error& error) {
    throw std::invalid_argument("finest = " + std::to_string(g.finest) + ", with these sizes: " + error.what());
  }
}

}  // namespace

void GradedMesh::Star::sort() { std::sort(parts.begin(), parts.begin() + n); }

GradedMesh::GradedMesh(const Grading& grading)
    : finest_(grading.finest), octree_(leaves_of(grading, root_cube(grading))), first_vertices_(octree_.n_vertices()) {
  const RootCube root = root_cube(grading);
  origin_ = root.origin;
  unit_ = root.width / kRootWidth;
  if (octree_.n_vertices() > std::numeric_limits<int>::max()) {  // a mesh cut out of this one has vertex numbers of int
    throw std::invalid_argument("finest = " + std::to_string(finest_) +
                                ", with these sizes: more than 2^31 - 1 vertices");
  }
  tbb::parallel_for(0, octree_.n_cells(), [&](int c) {
    if (octree_.cell(c).is_leaf()) find_slots(c);
  });
  for (int c = 0; c < octree_.n_cells(); ++c) {
    OctreeCell& cell = octree_.cell(c);
    first_vertices_.insert(cell.first_vertex);
    cell.first_tet = n_tets_;
    n_tets_ += std::popcount(cell.slots);
    for (auto t = static_cast<std::int64_t>(tet_cell_.size()); t * kTetsPerSample < n_tets_; ++t)
      tet_cell_.push_back(c);
    if (!cell.is_leaf()) continue;
    ++n_leaves_;
    for (const int x : {0, 2}) {
      const GridPoint p = octree_.point(c, {x, x, x});
      box_.extend(origin_ + unit_ * Vec3(p[0], p[1], p[2]));
    }
  }
  first_vertices_.index();
  offsets_ = smooth_transitions(*this, transition_vertices(), grading.transition_sweeps);
}

std::uint64_t GradedMesh::transition_slots(const OctreeCell& leaf) {
  const std::uint64_t between = leaf.slots & tet_slots::of_faces(leaf.coarse);
  const std::uint64_t halves = leaf.slots & ~between & tet_slots::kOdd;
  return between | halves | halves >> 1;
}

bool GradedMesh::is_transition(std::int64_t tet) const {
  const OctreeCell& cell = octree_.cell(cell_of_tet(tet));
  return (transition_slots(cell) >> tet_slots::select(cell.slots, static_cast<int>(tet - cell.first_tet)) & 1) != 0;
}

IdSet GradedMesh::transition_vertices() const {
  IdSet vertices(n_vertices());
  tbb::parallel_for(0, octree_.n_cells(), [&](int leaf) {
    for (std::uint64_t slots = octree_.cell(leaf).slots & tet_slots::of_faces(octree_.cell(leaf).coarse); slots != 0;
         slots &= slots - 1) {
      for (const std::int64_t v : corners(leaf, std::countr_zero(slots))) vertices.insert_shared(v);
    }
  });
  return vertices;
}

void GradedMesh::find_slots(int leaf) {
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

int GradedMesh::cell_of_vertex(std::int64_t vertex) const { return first_vertices_.rank(vertex + 1) - 1; }

int GradedMesh::cell_of_tet(std::int64_t tet) const {
  int c = tet_cell_[static_cast<std::size_t>(tet / kTetsPerSample)];
  while (c + 1 < octree_.n_cells() && octree_.cell(c + 1).first_tet <= tet) ++c;
  return c;
}

std::int64_t GradedMesh::vertex_id(const LinearOctree::VertexPlace& place) const {
  const OctreeCell& cell = octree_.cell(place.cell);
  return std::int64_t{cell.first_vertex} + std::popcount(cell.vertices & ((1u << place.bit) - 1));
}

std::int64_t GradedMesh::tet_id(int leaf, int slot) const {
  const OctreeCell& cell = octree_.cell(leaf);
  return cell.first_tet + tet_slots::rank(cell.slots, slot);
}

std::uint64_t GradedMesh::key(std::int64_t vertex) const {
  const int c = cell_of_vertex(vertex);
  const OctreeCell& cell = octree_.cell(c);
  if (!cell.is_leaf()) return octree_.corner_key(c);
  const auto bit = static_cast<std::uint64_t>(
      tet_slots::select(cell.vertices, static_cast<int>(vertex - std::int64_t{cell.first_vertex})));
  return octree_.corner_key(c) | bit << half_width_shift(cell.level);
}

std::int64_t GradedMesh::vertex_of(std::uint64_t key) const {
  const auto place = octree_.place(key);
  return place.cell < 0 ? -1 : vertex_id(place);
}

std::uint64_t GradedMesh::tet_key(std::int64_t tet) const {
  const int leaf = cell_of_tet(tet);
  const OctreeCell& cell = octree_.cell(leaf);
  const int slot = tet_slots::select(cell.slots, static_cast<int>(tet - cell.first_tet));
  return cube_key(octree_.corner_key(leaf), cell.level) << 6 | static_cast<std::uint64_t>(slot);
}

Vec3 GradedMesh::position(std::int64_t vertex) const {
  const GridPoint p = grid_point(key(vertex));
  if (!offsets_.has(vertex)) return origin_ + unit_ * Vec3(p[0], p[1], p[2]);
  const auto& by = offsets_.by[static_cast<std::size_t>(offsets_.moved.rank(vertex))];
  return origin_ + unit_ * Vec3(p[0] + static_cast<double>(by[0]), p[1] + static_cast<double>(by[1]),
                                p[2] + static_cast<double>(by[2]));
}

std::array<std::int64_t, 4> GradedMesh::tet(std::int64_t tet) const {
  const int leaf = cell_of_tet(tet);
  const OctreeCell& cell = octree_.cell(leaf);
  return corners(leaf, tet_slots::select(cell.slots, static_cast<int>(tet - cell.first_tet)));
}

std::array<std::int64_t, 4> GradedMesh::corners(int leaf, int slot) const {
  const OctreeCell& cell = octree_.cell(leaf);
  const int f = slot / tet_slots::kPerFace, rest = slot % tet_slots::kPerFace, behind = cell.neighbor[f];
  const auto vertex = [&](const CubeCode& code) { return vertex_id(octree_.place(leaf, code)); };
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

/// The tet with the centre of a leaf and (that half of) an edge of one of its faces, at this face.
std::int64_t GradedMesh::tet_at_edge(int leaf, int face, int e, int half) const {
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
std::int64_t GradedMesh::tet_around_edge(int leaf, int face, int e, int half, bool split) const {
  const auto& [other, edge, reversed] = tet_slots::on_other_face(face, e);
  return tet_at_edge(leaf, other, edge, split && reversed ? 1 - half : half);
}

std::int64_t GradedMesh::neighbor(std::int64_t tet, int face) const {
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

void GradedMesh::add_star_of_centre(int leaf, Star& star) const {
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

GradedMesh::Around GradedMesh::around(std::int64_t vertex) const {
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

void GradedMesh::add_star_of_point(const Around& around, Star& star) const {
  for (int k = 0; k < around.n; ++k) {
    const auto& [leaf, code] = around.leaves[static_cast<std::size_t>(k)];
    star.add(leaf, tet_slots::at(octree_.cell(leaf), code));
  }
}

bool GradedMesh::is_centre(std::int64_t vertex) const {
  const OctreeCell& cell = octree_.cell(cell_of_vertex(vertex));
  return cell.is_leaf() && vertex + 1 == std::int64_t{cell.first_vertex} + std::popcount(cell.vertices);
}

GradedMesh::Star GradedMesh::star_of(std::int64_t vertex) const {
  Star star;
  if (is_centre(vertex)) {
    add_star_of_centre(cell_of_vertex(vertex), star);
  } else {
    add_star_of_point(around(vertex), star);
  }
  star.sort();
  return star;
}

bool GradedMesh::on_boundary(std::int64_t vertex) const { return !is_centre(vertex) && !around(vertex).is_complete; }

double GradedMesh::mean_edge(std::int64_t vertex) const {
  if (is_regular(vertex)) return unit_ * kMeanEdge * width(octree_.cell(cell_of_vertex(vertex)).level);
  Link others;
  const int n = link_of(vertex, others);
  const GridPoint p = grid_point(key(vertex));
  double sum = 0;
  for (int k = 0; k < n; ++k) {
    const GridPoint q = grid_point(key(others[static_cast<std::size_t>(k)]));
    sum += Vec3(q[0] - p[0], q[1] - p[1], q[2] - p[2]).norm();
  }
  return unit_ * sum / n;
}

std::int64_t GradedMesh::tet_at(const Vec3& x) const {
  if (!box_.contains(x)) return -1;
  GridPoint p;
  for (int a = 0; a < 3; ++a) {
    p[a] = std::clamp(static_cast<std::int32_t>((x[a] - origin_[a]) / unit_), 0, kRootWidth - 1);
  }
  const int leaf = octree_.locate(p);
  if (leaf < 0 || !octree_.cell(leaf).is_leaf()) return -1;
  Star star;
  add_star_of_centre(leaf, star);
  std::int64_t at = tet_id(star.parts[0].first, std::countr_zero(star.parts[0].second));
  // A walk towards x. It cannot be long; the bound is for rounding that could send it round.
  for (int steps = 0; steps < kMaxSteps; ++steps) {
    const auto corners = tet(at);
    std::int64_t next = -1;
    for (int k = 0; k < 4 && next < 0; ++k) {
      const auto& f = kTetFace[k];
      if (volume6(position(corners[f[0]]), position(corners[f[1]]), position(corners[f[2]]), x) > 0) {
        next = neighbor(at, k);
      }
    }
    if (next < 0) break;
    at = next;
  }
  return at;
}

void GradedMesh::star(std::int64_t vertex, std::vector<std::int64_t>& tets) const {
  const Star star = star_of(vertex);
  for (int k = 0; k < star.n; ++k) {
    const auto& [leaf, bits] = star.parts[static_cast<std::size_t>(k)];
    for (std::uint64_t slots = bits; slots != 0; slots &= slots - 1)
      tets.push_back(tet_id(leaf, std::countr_zero(slots)));
  }
}

bool GradedMesh::is_regular_centre(int leaf) const {
  const OctreeCell& cell = octree_.cell(leaf);
  std::uint64_t slots = cell.slots;
  for (int f = 0; f < 6; ++f) {
    const int behind = cell.neighbor[f];
    if (behind < 0 || octree_.cell(behind).level != cell.level) return false;
    if (f % 2 == 0) slots |= octree_.cell(behind).slots & tet_slots::kFace << (tet_slots::kPerFace * (f ^ 1));
  }
  return (slots & tet_slots::kOdd) == 0;
}

bool GradedMesh::is_regular_point(const Around& around) const {
  if (!around.of_one_size) return false;
  std::uint64_t slots = 0;
  for (const auto& [leaf, code] : around.leaves) slots |= tet_slots::at(octree_.cell(leaf), code);
  return (slots & tet_slots::kOdd) == 0;
}

bool GradedMesh::is_regular(std::int64_t vertex) const {
  return is_centre(vertex) ? is_regular_centre(cell_of_vertex(vertex)) : is_regular_point(around(vertex));
}

int GradedMesh::link_of(std::int64_t vertex, Link& link) const {
  int n = 0;
  const auto add = [&](std::int64_t v) { link[static_cast<std::size_t>(n++)] = v; };
  const auto add_place = [&](int leaf, const CubeCode& code) { add(vertex_id(octree_.place(leaf, code))); };
  const auto add_star = [&](const Star& star) {
    for (int k = 0; k < star.n; ++k) {
      const auto& [leaf, bits] = star.parts[static_cast<std::size_t>(k)];
      for (std::uint64_t slots = bits; slots != 0; slots &= slots - 1) {
        for (const std::int64_t v : corners(leaf, std::countr_zero(slots))) {
          if (v != vertex) add(v);
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
  return static_cast<int>(std::unique(link.begin(), link.begin() + n) - link.begin());
}

void GradedMesh::link(std::int64_t vertex, std::vector<std::int64_t>& vertices) const {
  Link link;
  const int n = link_of(vertex, link);
  vertices.insert(vertices.end(), link.begin(), link.begin() + n);
}

TetMesh to_tet_mesh(const GradedMesh& mesh) {
  if (mesh.n_tets() > std::numeric_limits<int>::max()) throw std::invalid_argument("more than 2^31 - 1 tets");
  TetMesh stored;
  stored.V.resize(static_cast<std::size_t>(mesh.n_vertices()));
  stored.C.resize(static_cast<std::size_t>(mesh.n_tets()));
  tbb::parallel_for(std::size_t{0}, stored.V.size(),
                    [&](std::size_t v) { stored.V[v] = mesh.position(static_cast<std::int64_t>(v)); });
  tbb::parallel_for(std::size_t{0}, stored.C.size(), [&](std::size_t t) {
    const auto tet = mesh.tet(static_cast<std::int64_t>(t));
    for (std::size_t k = 0; k < 4; ++k) stored.C[t][k] = static_cast<int>(tet[k]);
  });
  return stored;
}

}  // namespace umtet
