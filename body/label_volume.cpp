#include "body/label_volume.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/disjoint_sets.h"
#include "mesh/implicit/surface_distance.h"
#include "reconstruct/level_set/voxel_pieces.h"

namespace umtet {
namespace {

// Of the volume of a tet with corners in voxel coordinates: its centres may lie on faces, for both tets there.
constexpr double kOnFace = 1e-9;

PieceCount pieces_of(const VoxelMask& mask, char side) {
  return {voxel_pieces(mask, side, VoxelNeighbours::Points).n(), voxel_pieces(mask, side, VoxelNeighbours::Faces).n()};
}

/// Sets of corners that simplices join.
template <class Simplices>
std::size_t n_joined(const Simplices& simplices, std::size_t n_vertices) {
  DisjointSets sets(n_vertices);
  std::vector<char> is_used(n_vertices, 0);
  for (const auto& s : simplices) {
    for (const int v : s) sets.unite(s[0], v), is_used[v] = 1;
  }
  std::size_t n = 0;
  for (std::size_t v = 0; v < n_vertices; ++v)
    if (is_used[v] && sets.find(static_cast<int>(v)) == static_cast<int>(v)) ++n;
  return n;
}

/// f(voxel) for each whose centre is in the tet. @param x  corners in voxel coordinates
template <class F>
void for_each_centre(const std::array<Vec3, 4>& x, const VoxelMask& mask, const F& f) {
  const Vec3 low = x[0].cwiseMin(x[1]).cwiseMin(x[2]).cwiseMin(x[3]);
  const Vec3 high = x[0].cwiseMax(x[1]).cwiseMax(x[2]).cwiseMax(x[3]);
  const Eigen::Vector3i first = (low.array() - kOnFace).ceil().cast<int>().max(0);
  const Eigen::Vector3i last = (high.array() + kOnFace).floor().cast<int>().min(mask.n.array() - 1);
  if ((first.array() > last.array()).any()) return;
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = x[k + 1] - x[0];
  const Mat3 to_corners = edges.inverse();
  for (int k = first[2]; k <= last[2]; ++k) {
    for (int j = first[1]; j <= last[1]; ++j) {
      for (int i = first[0]; i <= last[0]; ++i) {
        const Vec3 b = to_corners * (Vec3(i, j, k) - x[0]);
        if (b.minCoeff() >= -kOnFace && b.sum() <= 1 + kOnFace) f(mask.index(i, j, k));
      }
    }
  }
}

/// Which voxels have their centres in the mesh.
/// @param V  vertices in voxel coordinates
std::vector<char> covered_voxels(const std::vector<Vec3>& V, const std::vector<Tet>& C, const VoxelMask& mask) {
  std::vector<char> covered(mask.size(), 0);
  for (const Tet& t : C)
    for_each_centre({V[t[0]], V[t[1]], V[t[2]], V[t[3]]}, mask, [&](std::ptrdiff_t at) { covered[at] = 1; });
  return covered;
}

double volume_of(const TetMesh& mesh) {
  double six = 0;
  for (const Tet& t : mesh.C) {
    const Vec3& o = mesh.V[t[0]];
    six += (mesh.V[t[1]] - o).cross(mesh.V[t[2]] - o).dot(mesh.V[t[3]] - o);
  }
  return six / 6;
}

/// Area and integral of the mean curvature.
void integrate_over_surface(LabelVolume& labels, const GridLevelSet& psi) {
  const Mat3& axes = labels.voxels.axes;
  const Mat3 to_voxels = axes.inverse();
  for (const Vec3& x : labels.surface) {
    Vec3 g;
    Mat3 H;
    psi.evaluate(x, &g, &H);
    const double length = g.norm();
    if (!(length > 0)) continue;
    const Vec3 n = g / length, at = to_voxels * (x - labels.voxels.origin);
    // The axis of the line: along it the place is between two voxels.
    int axis = 0;
    (at.array() - at.array().round()).abs().maxCoeff(&axis);
    const Vec3 across = axes.col((axis + 1) % 3).cross(axes.col((axis + 2) % 3));
    const double area = std::abs(n.dot(across));
    labels.area += area;
    labels.mean_curvature += (H.trace() - n.dot(H * n)) / length * area;
  }
}

}  // namespace

LabelVolume label_volume(MaskFit& fit, std::optional<std::int64_t> part, std::optional<double> kernel) {
  LabelVolume labels{.voxels = std::move(fit.voxels), .surface = std::move(fit.surface), .report = {}};
  LabelVolumeReport& r = labels.report;
  r.part = part;
  r.kernel = kernel;
  r.n_voxels = fit.report.n_inside;
  r.volume_of_voxels = fit.report.volume_of_voxels;
  r.volume_of_psi = fit.report.volume;
  const VoxelMask& mask = labels.voxels.mask;
  r.pieces = pieces_of(mask, 1);
  r.cavities = pieces_of(mask, 0);
  --r.cavities.by_points, --r.cavities.by_faces;
  Eigen::AlignedBox3d box;
  for (int k = 0; k < mask.n[2]; ++k) {
    for (int j = 0; j < mask.n[1]; ++j) {
      for (int i = 0; i < mask.n[0]; ++i)
        if (mask.inside[mask.index(i, j, k)]) box.extend(labels.voxels.centre(i, j, k));
    }
  }
  integrate_over_surface(labels, fit.psi);
  labels.diagonal = box.diagonal().norm() + labels.voxels.steps().norm();
  return labels;
}

LabelVolumeReport label_volume_report(const Domain& domain, const TetMesh& mesh, const std::vector<Triangle>& faces,
                                      const Context& context) {
  const LabelVolume& labels = *domain.labels;
  const BodyVoxels& voxels = labels.voxels;
  LabelVolumeReport r = labels.report;
  r.volume_of_mesh = volume_of(mesh);
  r.pieces_of_mesh = n_joined(mesh.C, mesh.V.size());
  const std::size_t n_boundary = n_joined(faces, mesh.V.size());
  r.cavities_of_mesh = n_boundary - std::min(n_boundary, r.pieces_of_mesh);
  const Mat3 to_voxels = voxels.axes.inverse();
  std::vector<Vec3> V(mesh.V.size());
  std::transform(mesh.V.begin(), mesh.V.end(), V.begin(),
                 [&](const Vec3& x) -> Vec3 { return to_voxels * (x - voxels.origin); });
  const std::vector<char> covered = covered_voxels(V, mesh.C, voxels.mask);
  std::vector<Vec3> changed;
  const Eigen::Vector3i& n = voxels.mask.n;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        const std::ptrdiff_t at = voxels.mask.index(i, j, k);
        if (covered[at] != voxels.mask.inside[at]) changed.emplace_back(i, j, k);
      }
    }
  }
  r.n_changed = changed.size();
  if (changed.empty() || faces.empty()) return r;
  const std::vector<double> d = SurfaceDistance(V, faces).distances(changed, context);
  const auto worst = static_cast<std::size_t>(std::max_element(d.begin(), d.end()) - d.begin());
  r.farthest_changed = d[worst];
  r.farthest_at = voxels.origin + voxels.axes * changed[worst] + domain.shift;
  r.n_changed_far = static_cast<std::size_t>(std::count_if(d.begin(), d.end(), [](double x) { return x > .5; }));
  return r;
}

}  // namespace umtet
