#include "reconstruct/triangles/triangle_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

#include "reconstruct/triangles/body_samples.h"
#include "reconstruct/triangles/face_patches.h"
#include "reconstruct/triangles/triangle_winding.h"

namespace umtet {
namespace {

// Triangles beside which the winding number is asked, evenly picked.
constexpr std::size_t kAskedTriangles = 1000;
// Of the diagonal: far above rounding, far below a gap that shows.
constexpr double kStepBeside = 1e-6;
// The tree is off by .005 on average, and cracks of T-junctions cover less of the directions than this.
constexpr double kWhole = .03;

struct PieceEdge {
  std::uint32_t patch;
  int low, high;
  bool forward;
  auto key() const { return std::make_tuple(patch, low, high); }
};

struct Edges {
  std::size_t n = 0;         ///< once for each piece
  bool are_shared = true;    ///< by two triangles of a piece
  bool are_balanced = true;  ///< as many triangles of a piece run along each one way as the other
};

Edges edges_of(const TriangleMesh& mesh, const std::vector<int>& corner, const std::vector<std::uint32_t>& patch) {
  std::vector<PieceEdge> uses;
  uses.reserve(3 * mesh.F.size());
  for (std::size_t f = 0; f < mesh.F.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = corner[mesh.F[f][k]], b = corner[mesh.F[f][(k + 1) % 3]];
      if (a != b) uses.push_back({patch[f], std::min(a, b), std::max(a, b), a < b});
    }
  std::sort(uses.begin(), uses.end(), [](const PieceEdge& x, const PieceEdge& y) { return x.key() < y.key(); });
  Edges edges;
  for (std::size_t first = 0, last = 0; first < uses.size(); first = last) {
    long balance = 0;
    for (; last < uses.size() && uses[last].key() == uses[first].key(); ++last) balance += uses[last].forward ? 1 : -1;
    ++edges.n;
    edges.are_shared = edges.are_shared && last - first == 2;
    edges.are_balanced = edges.are_balanced && balance == 0;
  }
  return edges;
}

std::size_t n_corners(const TriangleMesh& mesh, const std::vector<int>& corner,
                      const std::vector<std::uint32_t>& patch) {
  std::vector<std::pair<std::uint32_t, int>> all;
  for (std::size_t f = 0; f < mesh.F.size(); ++f)
    for (const int v : mesh.F[f]) all.emplace_back(patch[f], corner[v]);
  std::sort(all.begin(), all.end());
  return static_cast<std::size_t>(std::unique(all.begin(), all.end()) - all.begin());
}

/// Whether w falls from 1 to 0 across triangles, as far as some of them tell.
bool winds_once(const TriangleMesh& mesh, const Context& context) {
  const TriangleWinding w(mesh);
  const double step = kStepBeside * diagonal_of(mesh);
  const std::size_t every = (mesh.F.size() + kAskedTriangles - 1) / kAskedTriangles;
  std::vector<Vec3> before, behind;
  for (std::size_t f = every / 2; f < mesh.F.size(); f += every) {
    const Vec3 n = step * mesh.area_vector(f).normalized();
    before.push_back(mesh.centroid(f) + n);
    behind.push_back(mesh.centroid(f) - n);
  }
  const std::vector<double> at = w(before, context), beyond = w(behind, context);
  return std::all_of(at.begin(), at.end(), [](double x) { return std::abs(x) < kWhole; }) &&
         std::all_of(beyond.begin(), beyond.end(), [](double x) { return std::abs(x - 1) < kWhole; });
}

}  // namespace

TriangleBody measure_body(const TriangleMesh& boundary, const Context& context) {
  TriangleBody body;
  if (boundary.F.empty()) return body;
  const Vec3 middle = boundary.centroid(0);
  for (std::size_t f = 0; f < boundary.F.size(); ++f) {
    const Vec3 a = boundary.area_vector(f);
    body.area += a.norm();
    body.volume += a.dot(boundary.centroid(f) - middle) / 3;
  }
  const FacePatches patches = find_patches(boundary);
  const std::vector<int> corner = welded(boundary.V, patches.weld_distance);
  const Edges edges = edges_of(boundary, corner, patches.patch);
  body.n_pieces = patches.size();
  body.euler_characteristic = static_cast<long>(n_corners(boundary, corner, patches.patch)) -
                              static_cast<long>(edges.n) + static_cast<long>(boundary.F.size());
  const bool are_whole = std::none_of(boundary.labels.begin(), boundary.labels.end(), is_partly_inside);
  body.is_manifold = are_whole && edges.are_shared && edges.are_balanced;
  body.is_closed = are_whole && (edges.are_balanced || winds_once(boundary, context));
  return body;
}

}  // namespace umtet
