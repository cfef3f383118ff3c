#include "reconstruct/triangles/touching_pieces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "reconstruct/cloud/neighbours/neighbour_tree.h"

namespace umtet {
namespace {

// In the most that a sample moves: how far from a contact samples move at all. The surface turns by 27 degrees then.
constexpr double kReach = 2;
// A sample nearer to the contact, in that unit, comes beyond the other side's where the two make a right angle: from s
// = w (1 - s / (2 w)) on it does not.
constexpr double kBeyond = kReach / (kReach + 1);

}  // namespace

std::vector<Vec3> contact_points(const TriangleMesh& mesh, const FacePatches& patches, double step,
                                 TouchingReport& report) {
  const std::vector<int> corner = welded(mesh.V, patches.weld_distance);
  struct Use {
    std::size_t n = 0;
    std::set<std::uint32_t> patches;
  };
  std::map<std::pair<int, int>, Use> edges;
  std::vector<std::uint32_t> first(mesh.V.size(), 0);
  std::vector<std::uint8_t> is_used(mesh.V.size(), 0), is_shared(mesh.V.size(), 0);
  std::set<std::uint32_t> touching;
  for (std::size_t f = 0; f < mesh.F.size(); ++f) {
    // Patches with cracks between them share corners, too, and touch nothing.
    if (!patches.is_closed[patches.patch[f]]) continue;
    for (int k = 0; k < 3; ++k) {
      const int a = corner[mesh.F[f][k]], b = corner[mesh.F[f][(k + 1) % 3]];
      if (a != b) {
        Use& use = edges[{std::min(a, b), std::max(a, b)}];
        ++use.n;
        use.patches.insert(patches.patch[f]);
      }
      if (is_used[a] && first[a] != patches.patch[f]) {
        is_shared[a] = 1;
        touching.insert({first[a], patches.patch[f]});
      }
      if (!is_used[a]) first[a] = patches.patch[f];
      is_used[a] = 1;
    }
  }
  std::vector<Vec3> points;
  for (const auto& [edge, use] : edges) {
    if (use.n < 4) continue;
    touching.insert(use.patches.begin(), use.patches.end());
    const Vec3 &a = mesh.V[edge.first], &b = mesh.V[edge.second];
    const auto n = static_cast<int>(std::ceil((b - a).norm() / step));
    for (int k = 0; k <= n; ++k) points.push_back(a + (b - a) * (static_cast<double>(k) / n));
  }
  for (std::size_t v = 0; v < mesh.V.size(); ++v)
    if (is_shared[v]) points.push_back(mesh.V[v]);
  report.n_contacts = points.size();
  report.n_pieces = touching.size();
  return points;
}

std::vector<std::uint8_t> move_from_contacts(const std::vector<Vec3>& contacts, double w, Touching touching,
                                             std::vector<Vec3>& points, std::vector<Vec3>& normals) {
  std::vector<std::uint8_t> goes(points.size(), 0);
  if (contacts.empty()) return goes;
  const NeighbourTree tree(contacts);
  const double reach = kReach * w, way = touching == Touching::Apart ? -1 : 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::array<Neighbour, 1> room;
    const Neighbour near = tree.k_nearest(points[i], room).front();
    const double s = std::sqrt(near.distance2);
    if (!(s < reach)) continue;
    Vec3 &x = points[i], &n = normals[i];
    Vec3 off = x - contacts[near.point];
    off -= off.dot(n) * n;
    if (off.norm() < kBeyond * w) {
      goes[i] = 1;
      continue;
    }
    x += way * w * (1 - s / reach) * n;
    n = (n + way * w / reach * off.normalized()).normalized();
  }
  return goes;
}

}  // namespace umtet
