#include "reconstruct/triangles/plane_caps.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "reconstruct/triangles/face_patches.h"

namespace umtet {
namespace {

// Of the width of a rim, root of its area: exporters in single precision and CAD programs leave far less, a scan more.
constexpr double kPlane = 1e-3;
// Of the area of a circle with that rim: cracks along T-junctions enclose less.
constexpr double kOfCircle = 1e-3;
// Mean cosine between the triangles along the rim and the cap: below the first the surface comes down at a right angle
// or flares out (closing.cpp has the same); above the last it goes on in the plane of the cap; below -.9 the triangles
// are a sheet that fills the rim.
constexpr double kFlatCosine = .15, kSameCosine = .99, kSheetCosine = -.9;
// The square of more is minutes.
constexpr std::size_t kMostCorners = 5000;

struct RimEdge {
  int from, to;
  std::uint32_t face;
};

/// Edges of one triangle, by where they begin; of corners with several, all.
std::multimap<int, RimEdge> rim_edges(const TriangleMesh& mesh, const std::vector<int>& corner) {
  std::map<std::pair<int, int>, std::pair<int, RimEdge>> uses;
  for (std::uint32_t f = 0; f < mesh.F.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = corner[mesh.F[f][k]], b = corner[mesh.F[f][(k + 1) % 3]];
      if (a == b) continue;
      auto& use = uses[{std::min(a, b), std::max(a, b)}];
      ++use.first;
      use.second = {a, b, f};
    }
  std::multimap<int, RimEdge> open;
  for (const auto& [edge, use] : uses)
    if (use.first == 1) open.emplace(use.second.from, use.second);
  return open;
}

/// Closed chains along which triangles look to one side. Where chains meet at a corner, none is followed.
std::vector<std::vector<RimEdge>> rims(const TriangleMesh& mesh, const std::vector<int>& corner) {
  const std::multimap<int, RimEdge> open = rim_edges(mesh, corner);
  std::vector<std::vector<RimEdge>> all;
  std::vector<std::uint8_t> is_done(mesh.V.size(), 0);
  for (const auto& [first, edge] : open) {
    if (is_done[first]) continue;
    std::vector<RimEdge> chain;
    for (int v = first; !is_done[v] && open.count(v) == 1;) {
      is_done[v] = 1;
      chain.push_back(open.find(v)->second);
      v = chain.back().to;
    }
    if (chain.size() > 2 && chain.back().to == first) all.push_back(std::move(chain));
  }
  return all;
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

bool is_in(const Eigen::Vector2d& x, const std::array<Eigen::Vector2d, 3>& t) {
  for (int k = 0; k < 3; ++k)
    if (cross(t[(k + 1) % 3] - t[k], x - t[k]) < 0) return false;
  return true;
}

/// Triangles of a simple polygon, counter-clockwise: ears are cut off [Meisters1975]. Of one that is not simple a fan.
std::vector<std::array<int, 3>> cut_ears(const std::vector<Eigen::Vector2d>& p) {
  std::vector<std::array<int, 3>> triangles;
  std::vector<int> left(p.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<int>(i);
  std::size_t at = 0, n_failed = 0;
  while (left.size() > 3 && n_failed < left.size()) {
    const std::size_t n = left.size();
    at %= n;
    const int a = left[(at + n - 1) % n], b = left[at], c = left[(at + 1) % n];
    bool is_ear = cross(p[b] - p[a], p[c] - p[b]) > 0;
    for (std::size_t k = 0; k < n && is_ear; ++k) {
      const int v = left[k];
      const bool is_other = v != a && v != b && v != c && p[v] != p[a] && p[v] != p[b] && p[v] != p[c];
      is_ear = !(is_other && is_in(p[v], {p[a], p[b], p[c]}));
    }
    if (!is_ear) {
      ++at;
      ++n_failed;
      continue;
    }
    triangles.push_back({a, b, c});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(at));
    // The next ear is not beside this one, so that triangles do not become a fan about one corner.
    ++at;
    n_failed = 0;
  }
  for (std::size_t k = 1; k + 1 < left.size(); ++k) triangles.push_back({left[0], left[k], left[k + 1]});
  return triangles;
}

}  // namespace

std::vector<PlaneCap> cap_plane_rims(TriangleMesh& mesh, double weld_distance) {
  std::vector<PlaneCap> caps;
  const std::vector<int> corner = welded(mesh.V, weld_distance);
  for (const std::vector<RimEdge>& rim : rims(mesh, corner)) {
    if (rim.size() > kMostCorners) continue;
    // Counter-clockwise from outside: against the triangles along it.
    std::vector<int> v;
    for (auto edge = rim.rbegin(); edge != rim.rend(); ++edge) v.push_back(edge->to);
    PlaneCap cap;
    for (const int i : v) cap.centre += mesh.V[i] / static_cast<double>(v.size());
    Vec3 area = Vec3::Zero();
    double length = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      const Vec3 &a = mesh.V[v[i]], &b = mesh.V[v[(i + 1) % v.size()]];
      area += (a - cap.centre).cross(b - cap.centre) / 2;
      length += (b - a).norm();
    }
    cap.area = area.norm();
    if (!(cap.area > kOfCircle * length * length / (4 * std::numbers::pi))) continue;
    cap.normal = area / cap.area;
    for (const int i : v) cap.off_plane = std::max(cap.off_plane, std::abs(cap.normal.dot(mesh.V[i] - cap.centre)));
    if (cap.off_plane > kPlane * std::sqrt(cap.area)) continue;
    double cosine = 0;
    for (const RimEdge& edge : rim)
      cosine += (mesh.V[edge.to] - mesh.V[edge.from]).norm() / length *
                mesh.area_vector(edge.face).normalized().dot(cap.normal);
    if (cosine < kSheetCosine || (cosine > kFlatCosine && cosine < kSameCosine)) continue;
    const Vec3 e = cap.normal.unitOrthogonal(), f = cap.normal.cross(e);
    std::vector<Eigen::Vector2d> p;
    for (const int i : v) p.emplace_back(e.dot(mesh.V[i] - cap.centre), f.dot(mesh.V[i] - cap.centre));
    for (const auto& t : cut_ears(p)) {
      mesh.F.push_back({v[t[0]], v[t[1]], v[t[2]]});
      if (!(mesh.area_vector(mesh.F.size() - 1).norm() > 0)) {
        mesh.F.pop_back();
        continue;
      }
      if (!mesh.labels.empty()) mesh.labels.push_back(0);
      ++cap.n_triangles;
    }
    if (cap.n_triangles > 0) caps.push_back(cap);
  }
  return caps;
}

}  // namespace umtet
