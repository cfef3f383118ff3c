#include "body/pieces/component_proof.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "common/disjoint_sets.h"

namespace umtet {
namespace {

// Where the first cells leave open whether psi has a zero, cells this many times finer decide.
constexpr double kFiner = 4;

Eigen::Vector3i cube_of(const Vec3& x, const Vec3& origin, double size) {
  return ((x - origin) / size).array().floor().cast<int>();
}

/// Cells by place: they come sorted by z, y, x.
class CellGroups {
 public:
  explicit CellGroups(const SignCells& cells);

  int find(const Eigen::Vector3i& cell) const;
  int cell_of(const Vec3& x) const { return find(cube_of(x, cells_.origin, cells_.size)); }
  /// Marks the groups of the cells at these points and around them.
  void mark(const std::vector<Vec3>& points);
  bool is_marked(int cell) { return marked_[groups_.find(cell)]; }
  int group(int cell) { return groups_.find(cell); }
  const SignCells& cells() const { return cells_; }
  Vec3 corner(int cell) const { return cells_.origin + cells_.size * cells_.cells[cell].cast<double>(); }

 private:
  /// Joins the cells of two rows that touch.
  void unite_rows(int j, int k, int other_j, int other_k);

  const SignCells& cells_;
  Eigen::Array2i first_ = {0, 0}, n_ = {0, 0};  ///< rows of cells along x: y and z
  std::vector<int> row_begin_;                  ///< into cells_.cells, y fastest
  DisjointSets groups_;
  std::vector<char> marked_;
};

int CellGroups::find(const Eigen::Vector3i& cell) const {
  const int j = cell[1] - first_[0], k = cell[2] - first_[1];
  if (j < 0 || k < 0 || j >= n_[0] || k >= n_[1]) return -1;
  const auto begin = cells_.cells.begin() + row_begin_[j + n_[0] * k];
  const auto end = cells_.cells.begin() + row_begin_[j + n_[0] * k + 1];
  const auto at = std::lower_bound(begin, end, cell[0], [](const auto& a, int x) { return a[0] < x; });
  return at != end && (*at)[0] == cell[0] ? static_cast<int>(at - cells_.cells.begin()) : -1;
}

template <class F>
void for_each_neighbour(const Eigen::Vector3i& cell, F&& f) {
  for (int q = 0; q < 27; ++q) f(Eigen::Vector3i(cell + Eigen::Vector3i(q % 3 - 1, q / 3 % 3 - 1, q / 9 - 1)));
}

CellGroups::CellGroups(const SignCells& cells)
    : cells_(cells), groups_(cells_.cells.size()), marked_(cells_.cells.size(), 0) {
  Eigen::AlignedBox2i rows;
  for (const Eigen::Vector3i& c : cells_.cells) rows.extend(Eigen::Vector2i(c[1], c[2]));
  if (rows.isEmpty()) return;
  first_ = rows.min().array();
  n_ = rows.sizes().array() + 1;
  row_begin_.assign(static_cast<std::size_t>(n_.prod()) + 1, 0);
  for (const Eigen::Vector3i& c : cells_.cells) ++row_begin_[c[1] - first_[0] + n_[0] * (c[2] - first_[1]) + 1];
  std::partial_sum(row_begin_.begin(), row_begin_.end(), row_begin_.begin());
  for (int k = 0; k < n_[1]; ++k) {
    for (int j = 0; j < n_[0]; ++j) {
      // Each pair once: with the rows before, then within the row.
      for (const auto& [dj, dk] : {std::pair{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {0, 0}})
        unite_rows(j, k, j + dj, k + dk);
    }
  }
}

void CellGroups::unite_rows(int j, int k, int other_j, int other_k) {
  if (other_j < 0 || other_k < 0 || other_j >= n_[0] || other_k >= n_[1]) return;
  const int row = j + n_[0] * k, other = other_j + n_[0] * other_k;
  int near = row_begin_[other];
  const int end = row_begin_[other + 1];
  for (int c = row_begin_[row]; c < row_begin_[row + 1]; ++c) {
    const int x = cells_.cells[c][0];
    while (near < end && cells_.cells[near][0] < x - 1) ++near;
    for (int n = near; n < end && cells_.cells[n][0] <= x + 1; ++n) {
      if (n != c) groups_.unite(c, n);
    }
  }
}

void CellGroups::mark(const std::vector<Vec3>& points) {
  Eigen::Vector3i last = Eigen::Vector3i::Constant(std::numeric_limits<int>::min());
  for (const Vec3& x : points) {
    const Eigen::Vector3i cube = cube_of(x, cells_.origin, cells_.size);
    if (cube == last) continue;  // cut points of one grid node come one after the other
    last = cube;
    // Cells that touch are one group already.
    if (const int own = find(cube); own >= 0) {
      marked_[groups_.find(own)] = 1;
      continue;
    }
    // They are linear along grid edges: they lie beside psi = 0.
    for_each_neighbour(cube, [&](const Eigen::Vector3i& next) {
      if (const int n = find(next); n >= 0) marked_[groups_.find(n)] = 1;
    });
  }
}

/// psi at the corners and in the middle has both signs.
bool crosses(const LevelSet& psi, const Vec3& corner, double size) {
  const bool inside = psi.value(corner + Vec3::Constant(size / 2)) < 0;
  for (int q = 0; q < 8; ++q) {
    if ((psi.value(corner + size * Vec3(q & 1, q >> 1 & 1, q >> 2)) < 0) != inside) return true;
  }
  return false;
}

}  // namespace

ZeroFreeMap::ZeroFreeMap(const SignCells& cells, const Eigen::AlignedBox3d& box, double reach)
    : inner_(box.min().array() + reach, box.max().array() - reach),
      origin_(cells.origin),
      size_(std::ceil(reach / cells.size) * cells.size) {
  first_ = cube_of(box.min(), origin_, size_).array();
  n_ = (cube_of(box.max(), origin_, size_).array() - first_ + 1).max(0);
  near_.assign(static_cast<std::size_t>(n_[0]) * n_[1] * n_[2], 0);
  // Cubes that hold a cell may lie one beyond those of the box.
  const Eigen::Array3i n = n_ + 2;
  const auto at = [&](int i, int j, int k) {
    return i + static_cast<std::size_t>(n[0]) * (j + static_cast<std::size_t>(n[1]) * k);
  };
  std::vector<std::uint8_t> holds(at(0, 0, n[2]), 0), in_row(holds.size(), 0);
  for (const Eigen::Vector3i& cell : cells.cells) {
    const Eigen::Array3i cube =
        cube_of(origin_ + cells.size * (cell.cast<double>() + Vec3::Constant(.5)), origin_, size_).array() - first_ + 1;
    if ((cube >= 0).all() && (cube < n).all()) holds[at(cube[0], cube[1], cube[2])] = 1;
  }
  // The cubes around them, along one axis after the other.
  tbb::parallel_for(0, n[2], [&](int k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 1; i + 1 < n[0]; ++i)
        in_row[at(i, j, k)] = holds[at(i - 1, j, k)] | holds[at(i, j, k)] | holds[at(i + 1, j, k)];
    }
  });
  tbb::parallel_for(0, n_[2], [&](int k) {
    for (int j = 0; j < n_[1]; ++j) {
      for (int q = 0; q < 9; ++q) {
        const std::uint8_t* row = &in_row[at(1, j + q % 3, k + q / 3)];
        std::uint8_t* near = &near_[index({0, j, k})];
        for (int i = 0; i < n_[0]; ++i) near[i] |= row[i];
      }
    }
  });
}

bool ZeroFreeMap::operator()(const Vec3& x) const {
  return inner_.contains(x) && near_[index(cube_of(x, origin_, size_).array() - first_)] == 0;
}

ComponentProof prove_components(const LevelSet& psi, const Eigen::AlignedBox3d& box, const ZeroSetTopology& counted,
                                const SignCells& cells) {
  CellGroups groups(cells);
  groups.mark(counted.cut_points);
  ComponentProof proof;
  const int n = static_cast<int>(groups.cells().cells.size());
  enum Verdict : char { Unknown, Crossing, Open };
  std::vector<char> verdict(n, Unknown);
  bool any_open = false;
  for (int c = 0; c < n; ++c) {
    if (groups.is_marked(c) || verdict[groups.group(c)] == Crossing || !box.contains(groups.corner(c))) continue;
    if (crosses(psi, groups.corner(c), groups.cells().size)) {
      verdict[groups.group(c)] = Crossing;
      proof.unseen.push_back(groups.corner(c) + Vec3::Constant(groups.cells().size / 2));
    } else {
      verdict[groups.group(c)] = Open;
      any_open = true;
    }
  }
  if (!any_open) return proof;
  std::vector<int> open;
  for (int c = 0; c < n; ++c) {
    if (!groups.is_marked(c) && verdict[groups.group(c)] == Open) open.push_back(c);
  }
  const SignCells finer = sign_cells_within(psi, groups.cells(), open, groups.cells().size / kFiner);
  std::vector<char> left(n, 0);
  for (const Eigen::Vector3i& f : finer.cells) {
    const Vec3 corner = finer.origin + finer.size * f.cast<double>();
    const int c = groups.cell_of(corner + Vec3::Constant(finer.size / 2));
    char& state = left[groups.group(c)];
    if (state == Crossing) continue;
    if (crosses(psi, corner, finer.size)) {
      state = Crossing;
      proof.unseen.push_back(corner + Vec3::Constant(finer.size / 2));
    } else {
      state = Open;
    }
  }
  proof.n_open = static_cast<std::size_t>(std::count(left.begin(), left.end(), static_cast<char>(Open)));
  return proof;
}

}  // namespace umtet
