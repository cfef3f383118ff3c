#include "mesh/octree/linear_octree.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>

namespace umtet {

LinearOctree::LinearOctree(const std::vector<std::uint64_t>& cubes) : keys_(cubes.size()), cells_(cubes.size()) {
  tbb::parallel_for(std::size_t{0}, cubes.size(), [&](std::size_t i) {
    const int level = cube_level(cubes[i]);
    keys_[i] = cube_corner(cubes[i]);
    cells_[i].level = static_cast<std::uint8_t>(level);
    cells_[i].octant = level == 0 ? 0 : static_cast<std::uint8_t>(keys_[i] >> half_width_shift(level - 1) & 7);
  });
  find_neighbors();
  add_points();
  find_vertices();
}

std::uint64_t LinearOctree::end_key(int c) const {
  const OctreeCell& cell = cells_[static_cast<std::size_t>(c)];
  return keys_[static_cast<std::size_t>(c)] + (cell.is_leaf() ? std::uint64_t{8} << half_width_shift(cell.level) : 1);
}

/// Among the cells begin .. end - 1.
int LinearOctree::locate(std::uint64_t key, std::size_t begin, std::size_t end) const {
  const auto first = keys_.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto after = std::upper_bound(first, keys_.begin() + static_cast<std::ptrdiff_t>(end), key);
  const int c = static_cast<int>(after - keys_.begin()) - 1;
  return c >= 0 && key < end_key(c) ? c : -1;
}

/// By steps of doubled length from cell c: most neighbours are near in Morton order.
int LinearOctree::locate_near(std::size_t c, std::uint64_t key) const {
  std::size_t begin = c, end = c + 1;
  for (std::size_t step = 8; begin > 0 && keys_[begin] > key; step *= 8) begin = begin > step ? begin - step : 0;
  for (std::size_t step = 8; end < keys_.size() && keys_[end] <= key; step *= 8)
    end = std::min(keys_.size(), end + step);
  return locate(key, begin, end);
}

GridPoint LinearOctree::point(int leaf, const CubeCode& code) const {
  GridPoint p = grid_point(corner_key(leaf));
  const std::int32_t half = width(cell(leaf).level) / 2;
  for (int a = 0; a < 3; ++a) p[a] += code[a] * half;
  return p;
}

int LinearOctree::locate_from(int c, const GridPoint& p) const {
  if (!is_in_root(p)) return -1;
  const std::uint64_t key = morton_key(p);
  // A step an axis, and one more an axis among four small leaves.
  for (int steps = 0; steps < 7 && cell(c).is_leaf(); ++steps) {
    if (corner_key(c) <= key && key < end_key(c)) return c;
    const GridPoint corner = grid_point(corner_key(c));
    const std::int32_t w = width(cell(c).level);
    int face = -1;
    for (int a = 0; a < 3; ++a) {
      if (p[a] < corner[a]) face = 2 * a;
      if (p[a] >= corner[a] + w) face = 2 * a + 1;
    }
    if (cell(c).neighbor[face] < 0) break;
    c = cell(c).neighbor[face];
  }
  return locate(key);
}

LinearOctree::VertexPlace LinearOctree::place_in(int c, std::uint64_t key) const {
  if (c < 0) return {-1, 0};
  if (!cell(c).is_leaf()) return {c, 0};
  const int shift = half_width_shift(cell(c).level);
  const std::uint64_t offset = (key - corner_key(c)) >> shift;
  if (corner_key(c) + (offset << shift) != key || (cell(c).vertices >> offset & 1) == 0) return {-1, 0};
  return {c, static_cast<int>(offset)};
}

/// The leaf that a place of a leaf is in, over neighbours of one size; -1 where some are not.
int LinearOctree::equal_leaf(int leaf, const CubeCode& code) const {
  int c = leaf;
  for (int a = 0; a < 3; ++a) {
    if (code[a] < 2) continue;
    c = cell(c).neighbor[2 * a + 1];
    if (c < 0 || cell(c).level != cell(leaf).level) return -1;
  }
  return c;
}

LinearOctree::VertexPlace LinearOctree::place(int leaf, const CubeCode& code) const {
  const int c = equal_leaf(leaf, code);
  if (c < 0) {
    const GridPoint p = point(leaf, code);
    return place_in(locate_from(leaf, p), morton_key(p));
  }
  const int bit = (code[0] & 1) + 2 * (code[1] & 1) + 4 * (code[2] & 1);
  return cell(c).vertices >> bit & 1 ? VertexPlace{c, bit} : VertexPlace{-1, 0};
}

int LinearOctree::small_leaf(int leaf, int face, bool upper_u, bool upper_v) const {
  const int a = face / 2;
  int s = cell(leaf).neighbor[face];
  if (upper_u) s = cell(s).neighbor[2 * ((a + 1) % 3) + 1];
  if (upper_v) s = cell(s).neighbor[2 * ((a + 2) % 3) + 1];
  return s;
}

bool LinearOctree::is_edge_split(int leaf, int face, int other_face) const {
  const OctreeCell& own = cell(leaf);
  const int behind = own.neighbor[face], other = own.neighbor[other_face];
  for (const int n : {behind, other}) {
    if (n >= 0 && cell(n).level > own.level) return true;
  }
  int across = -1;
  if (behind >= 0 && cell(behind).level == own.level) {
    across = cell(behind).neighbor[other_face];
  } else if (other >= 0 && cell(other).level == own.level) {
    across = cell(other).neighbor[face];
  } else if (behind < 0 && other < 0) {
    GridPoint p = point(leaf, {0, 0, 0});
    for (const int f : {face, other_face}) p[f / 2] += f % 2 == 0 ? -1 : width(own.level);
    across = locate(p);
  }  // else a leaf of twice the size is at the edge: by balance none of half the size
  return across >= 0 && cell(across).is_leaf() && cell(across).level > own.level;
}

void LinearOctree::find_neighbors() {
  tbb::parallel_for(std::size_t{0}, cells_.size(), [&](std::size_t i) {
    OctreeCell& cell = cells_[i];
    for (int f = 0; f < 6; ++f) {
      // The lower corner of the neighbour's face: of four small ones it is at the one with the least coordinates.
      GridPoint p = grid_point(keys_[i]);
      p[f / 2] += f % 2 == 0 ? -1 : width(cell.level);
      cell.neighbor[f] = is_in_root(p) && p[f / 2] < kRootWidth ? locate_near(i, morton_key(p)) : -1;
      if (cell.neighbor[f] >= 0 && cells_[static_cast<std::size_t>(cell.neighbor[f])].level < cell.level) {
        cell.coarse = static_cast<std::uint8_t>(cell.coarse | 1 << f);
      }
    }
  });
}

/// Upper corners and upper face centres of a leaf that lie in no leaf.
void LinearOctree::find_points(int leaf, std::vector<std::uint64_t>& points) const {
  const auto add = [&](const CubeCode& code) {
    if (equal_leaf(leaf, code) >= 0) return;
    const GridPoint p = point(leaf, code);
    if (locate_from(leaf, p) < 0) points.push_back(morton_key(p));
  };
  for (int corner = 1; corner < 8; ++corner) add({2 * (corner & 1), 2 * (corner >> 1 & 1), 2 * (corner >> 2 & 1)});
  for (int a = 0; a < 3; ++a) {
    CubeCode centre = {1, 1, 1};
    centre[a] = 2;
    if (cell(leaf).neighbor[2 * a + 1] < 0) add(centre);
  }
}

void LinearOctree::add_points() {
  constexpr std::size_t kLeavesPerTask = 1 << 12;
  std::vector<std::vector<std::uint64_t>> of_task((cells_.size() + kLeavesPerTask - 1) / kLeavesPerTask);
  tbb::parallel_for(std::size_t{0}, of_task.size(), [&](std::size_t task) {
    const std::size_t end = std::min(cells_.size(), (task + 1) * kLeavesPerTask);
    for (std::size_t c = task * kLeavesPerTask; c < end; ++c) find_points(static_cast<int>(c), of_task[task]);
  });
  std::vector<std::uint64_t> points;
  for (const auto& some : of_task) points.insert(points.end(), some.begin(), some.end());
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());

  // Merge, and count for every leaf the points before it.
  std::vector<std::int32_t> moved(cells_.size());
  std::vector<std::uint64_t> keys;
  std::vector<OctreeCell> cells;
  keys.reserve(keys_.size() + points.size());
  cells.reserve(keys_.size() + points.size());
  auto point = points.begin();
  for (std::size_t i = 0; i <= cells_.size(); ++i) {
    for (; point != points.end() && (i == cells_.size() || *point < keys_[i]); ++point) {
      keys.push_back(*point);
      cells.emplace_back();
    }
    if (i == cells_.size()) break;
    moved[i] = static_cast<std::int32_t>(cells.size());
    keys.push_back(keys_[i]);
    cells.push_back(cells_[i]);
  }
  tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
    for (std::int32_t& n : cells[i].neighbor) n = n < 0 ? -1 : moved[static_cast<std::size_t>(n)];
  });
  keys_ = std::move(keys);
  cells_ = std::move(cells);
}

void LinearOctree::find_vertices() {
  tbb::parallel_for(0, n_cells(), [&](int c) {
    OctreeCell& own = cells_[static_cast<std::size_t>(c)];
    if (!own.is_leaf()) return;
    unsigned vertices = 0x81;  // lower corner and centre
    for (int a = 0; a < 3; ++a) {
      const int u = (a + 1) % 3, v = (a + 2) % 3, behind = own.neighbor[2 * a];
      if (is_edge_split(c, 2 * u, 2 * v)) vertices |= 1u << (1 << a);
      if (behind < 0 || cell(behind).level > own.level) vertices |= 1u << ((1 << u) + (1 << v));
    }
    own.vertices = static_cast<std::uint8_t>(vertices);
  });
  for (OctreeCell& cell : cells_) {
    cell.first_vertex = static_cast<std::uint32_t>(n_vertices_);
    n_vertices_ += std::popcount(cell.vertices);
  }
}

}  // namespace umtet
