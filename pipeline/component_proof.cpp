#include "pipeline/component_proof.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/detail/disjoint_sets.h"
#include "reconstruct/sign_cells.h"

namespace umtet {
namespace {

// Cells this many times finer decide what the first ones leave open.
constexpr double kFiner = 4;

/// Cells by place: they come sorted by z, y, x.
class CellGroups {
 public:
  explicit CellGroups(SignCells cells);

  int find(const Eigen::Vector3i& cell) const;
  int cell_of(const Vec3& x) const {
    return find(((x - cells_.origin) / cells_.size).array().floor().cast<int>());
  }
  /// Marks the groups of the cells at x and around it.
  void mark(const Vec3& x);
  bool is_marked(int cell) { return marked_[groups_.find(cell)]; }
  int group(int cell) { return groups_.find(cell); }
  const SignCells& cells() const { return cells_; }
  Vec3 corner(int cell) const { return cells_.origin + cells_.size * cells_.cells[cell].cast<double>(); }

 private:
  SignCells cells_;
  detail::DisjointSets groups_;
  std::vector<char> marked_;
};

std::array<int, 3> order(const Eigen::Vector3i& c) { return {c[2], c[1], c[0]}; }

int CellGroups::find(const Eigen::Vector3i& cell) const {
  const auto at = std::lower_bound(cells_.cells.begin(), cells_.cells.end(), cell,
                                   [](const auto& a, const auto& b) { return order(a) < order(b); });
  return at != cells_.cells.end() && *at == cell ? static_cast<int>(at - cells_.cells.begin()) : -1;
}

template <class F>
void for_each_neighbour(const Eigen::Vector3i& cell, F&& f) {
  for (int q = 0; q < 27; ++q) f(Eigen::Vector3i(cell + Eigen::Vector3i(q % 3 - 1, q / 3 % 3 - 1, q / 9 - 1)));
}

CellGroups::CellGroups(SignCells cells)
    : cells_(std::move(cells)), groups_(cells_.cells.size()), marked_(cells_.cells.size(), 0) {
  for (int c = 0; c < static_cast<int>(cells_.cells.size()); ++c) {
    for_each_neighbour(cells_.cells[c], [&](const Eigen::Vector3i& next) {
      if (order(next) >= order(cells_.cells[c])) return;  // each pair once
      if (const int n = find(next); n >= 0) groups_.unite(c, n);
    });
  }
}

void CellGroups::mark(const Vec3& x) {
  // Cut points are linear along grid edges: they lie beside psi = 0.
  for_each_neighbour(((x - cells_.origin) / cells_.size).array().floor().cast<int>(), [&](const Eigen::Vector3i& next) {
    if (const int n = find(next); n >= 0) marked_[groups_.find(n)] = 1;
  });
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

ComponentProof prove_components(const LevelSet& psi, const Eigen::AlignedBox3d& box, const ZeroSetTopology& counted,
                                double size) {
  CellGroups groups(sign_cells(psi, size));
  for (const Vec3& x : counted.cut_points) groups.mark(x);
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
  const SignCells finer = sign_cells(psi, groups.cells().size / kFiner);
  std::vector<char> left(n, 0);
  for (const Eigen::Vector3i& f : finer.cells) {
    const Vec3 corner = finer.origin + finer.size * f.cast<double>();
    const int c = groups.cell_of(corner + Vec3::Constant(finer.size / 2));
    if (c < 0 || verdict[groups.group(c)] != Open || groups.is_marked(c)) continue;
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
