#include "reconstruct/triangles/sliver_repair.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "reconstruct/triangles/face_patches.h"

namespace umtet {
namespace {

// A flip may leave another sliver beside it.
constexpr int kMostPasses = 20;

class SliverRepair {
 public:
  SliverRepair(TriangleMesh& mesh, double tolerance) : mesh_(mesh), tolerance_(tolerance) {
    const std::vector<int> first = welded(mesh.V, 0);
    for (Triangle& t : mesh.F)
      for (int& v : t) v = first[v];
    for (const auto& [a, b] : mesh.lines) lines_.insert(std::minmax(first[a], first[b]));
  }

  void store_lines() {
    mesh_.lines.clear();
    for (const auto& [a, b] : lines_) mesh_.lines.push_back({a, b});
  }

  std::size_t pass() {
    list_neighbours();
    is_locked_.assign(mesh_.F.size(), 0);
    is_gone_.assign(mesh_.F.size(), 0);
    std::size_t n = 0;
    for (std::size_t f = 0; f < mesh_.F.size(); ++f) n += is_sliver(f) && (collapse(f) || flip(f)) ? 1 : 0;
    drop();
    return n;
  }

 private:
  const Vec3& at(int v) const { return mesh_.V[v]; }
  double side(const Triangle& t, int k) const { return (at(t[(k + 1) % 3]) - at(t[k])).norm(); }
  int longest(const Triangle& t) const {
    int best = 0;
    for (int k = 1; k < 3; ++k)
      if (side(t, k) > side(t, best)) best = k;
    return best;
  }
  double height(const Triangle& t) const {
    const double area2 = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).norm();
    return area2 / side(t, longest(t));
  }
  bool is_sliver(std::size_t f) const { return !is_locked_[f] && !(height(mesh_.F[f]) > tolerance_); }

  void list_neighbours() {
    faces_.clear();
    for (std::size_t f = 0; f < mesh_.F.size(); ++f)
      for (int k = 0; k < 3; ++k) faces_[std::minmax(mesh_.F[f][k], mesh_.F[f][(k + 1) % 3])].push_back(f);
    around_.assign(mesh_.V.size(), {});
    for (std::size_t f = 0; f < mesh_.F.size(); ++f)
      for (const int v : mesh_.F[f]) around_[v].push_back(f);
  }

  /// The other triangle at a side, if there is exactly one.
  const std::vector<std::size_t>& faces_at(int a, int b) const { return faces_.at(std::minmax(a, b)); }

  /// Merges the ends of the shortest side. The triangles around keep their corners apart if the two ends have only the
  /// two corners beyond the side as common neighbours.
  bool collapse(std::size_t f) {
    const Triangle t = mesh_.F[f];
    for (int k = 0; k < 3; ++k) {
      if (!(side(t, k) <= tolerance_)) continue;
      const int a = t[k], b = t[(k + 1) % 3];
      if (faces_at(a, b).size() != 2) continue;
      std::vector<std::size_t> touched = around_[a];
      touched.insert(touched.end(), around_[b].begin(), around_[b].end());
      if (std::any_of(touched.begin(), touched.end(), [&](std::size_t g) { return is_locked_[g] != 0; })) continue;
      const auto neighbours = [&](int v) {
        std::vector<int> list;
        for (const std::size_t g : around_[v])
          for (const int w : mesh_.F[g])
            if (w != v) list.push_back(w);
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
        return list;
      };
      const std::vector<int> of_a = neighbours(a), of_b = neighbours(b);
      std::vector<int> common;
      std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::back_inserter(common));
      if (common.size() != 2) continue;
      for (const std::size_t g : touched) is_locked_[g] = 1;
      for (const std::size_t g : faces_at(a, b)) is_gone_[g] = 1;
      for (const std::size_t g : around_[b])
        for (int& v : mesh_.F[g])
          if (v == b) v = a;
      for (const int w : of_b)
        if (lines_.erase(std::minmax(b, w)) > 0 && w != a) lines_.insert(std::minmax(a, w));
      return true;
    }
    return false;
  }

  /// Replaces the longest side ab by the edge from the opposite corner c to that of the neighbour, d.
  bool flip(std::size_t f) {
    const Triangle t = mesh_.F[f];
    const int k = longest(t), a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
    const std::vector<std::size_t>& two = faces_at(a, b);
    if (two.size() != 2) return false;
    const std::size_t g = two[0] == f ? two[1] : two[0];
    if (is_locked_[g] || faces_.contains(std::minmax(c, other_corner(g, a, b)))) return false;
    const int d = other_corner(g, a, b);
    for (int i = 0; i < 3; ++i)
      if (mesh_.F[g][i] == a && mesh_.F[g][(i + 1) % 3] == b) return false;  // both run the same way
    const Triangle one = {a, d, c}, other = {d, b, c};
    // Of two slivers the flip may make none better.
    if (!(std::min(height(one), height(other)) > height(t))) return false;
    for (const std::size_t h : {f, g})
      for (const int v : mesh_.F[h])
        for (const std::size_t i : around_[v]) is_locked_[i] = 1;
    mesh_.F[f] = one;
    mesh_.F[g] = other;
    if (!mesh_.labels.empty()) mesh_.labels[f] = mesh_.labels[g];  // nothing of the sliver is to be seen
    if (lines_.erase(std::minmax(a, b)) > 0) lines_.insert({std::minmax(a, c), std::minmax(c, b)});
    return true;
  }
  int other_corner(std::size_t g, int a, int b) const {
    for (const int v : mesh_.F[g])
      if (v != a && v != b) return v;
    return -1;
  }

  void drop() {
    std::size_t n = 0;
    for (std::size_t f = 0; f < mesh_.F.size(); ++f) {
      if (is_gone_[f]) continue;
      mesh_.F[n] = mesh_.F[f];
      if (!mesh_.labels.empty()) mesh_.labels[n] = mesh_.labels[f];
      ++n;
    }
    mesh_.F.resize(n);
    if (!mesh_.labels.empty()) mesh_.labels.resize(n);
  }

  TriangleMesh& mesh_;
  const double tolerance_;
  std::set<std::pair<int, int>> lines_;
  std::map<std::pair<int, int>, std::vector<std::size_t>> faces_;
  std::vector<std::vector<std::size_t>> around_;  ///< triangles at each vertex
  std::vector<std::uint8_t> is_locked_, is_gone_;
};

}  // namespace

std::size_t remove_slivers(TriangleMesh& mesh, double tolerance) {
  SliverRepair repair(mesh, tolerance);
  std::size_t n_all = 0;
  for (int k = 0; k < kMostPasses; ++k) {
    const std::size_t n = repair.pass();
    if (n == 0) break;
    n_all += n;
  }
  repair.store_lines();
  return n_all;
}

}  // namespace umtet
