#include "reconstruct/triangles/face_sides.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/polled_loops.h"
#include "reconstruct/triangles/face_patches.h"
#include "reconstruct/triangles/triangle_winding.h"

namespace umtet {
namespace {

// Triangles of a patch that are asked, evenly picked.
constexpr std::size_t kAsked = 16;
// An open patch sees the others from both sides at half its width, and not farther than this share of the diagonal.
constexpr double kWidth = .5, kFarthest = .05;
// Across a small gap the winding number of the others changes by one, across one as wide as the body by little; less
// than this is what a tree and the rims of other gaps are worth.
constexpr double kClearlyWrong = -.03;
constexpr int kRounds = 8;
constexpr std::size_t kPatchesPerPoll = 64;
// Of the volume of a sphere with the area: less is that of a sheet, and says nothing.
constexpr double kClearlyNegative = -.02;

struct Patch {
  std::vector<std::uint32_t> faces;
  double area = 0, volume = 0;  ///< enclosed, about the origin of all
};

class Sides {
 public:
  Sides(TriangleMesh& mesh, const Context& context)
      : mesh_(mesh), context_(context), found_(find_patches(mesh)), was_(mesh.F), patches_(found_.size()) {
    for (std::size_t f = 0; f < mesh.F.size(); ++f)
      if (found_.is_turned[f]) turn_face(mesh, f);
    diagonal_ = diagonal_of(mesh);
    double area = 0;
    Vec3 sum = Vec3::Zero();
    const Vec3 first = mesh.centroid(0);
    for (std::size_t f = 0; f < mesh.F.size(); ++f) {
      const double a = mesh.area_vector(f).norm();
      area += a;
      sum += a * (mesh.centroid(f) - first);
    }
    const Vec3 middle = first + sum / area;
    for (std::uint32_t f = 0; f < mesh.F.size(); ++f) {
      Patch& p = patches_[found_.patch[f]];
      p.faces.push_back(f);
      p.area += mesh.area_vector(f).norm();
      p.volume += mesh.area_vector(f).dot(mesh.centroid(f) - middle) / 3;
    }
  }

  FaceSidesReport operator()() {
    orient_closed();
    orient_open();
    FaceSidesReport report = std::move(report_);
    report.n_open_edges = found_.n_open_edges;
    report.n_branching_edges = found_.n_branching_edges;
    report.n_one_sided_edges = found_.n_one_sided_edges;
    report.weld_distance = found_.weld_distance;
    report.n_patches = found_.size();
    report.n_closed_patches = static_cast<std::size_t>(std::count(found_.is_closed.begin(), found_.is_closed.end(), 1));
    for (std::size_t f = 0; f < mesh_.F.size(); ++f) report.n_turned += mesh_.F[f] != was_[f] ? 1 : 0;
    return report;
  }

 private:
  void turn(Patch& patch) {
    for (const std::uint32_t f : patch.faces) turn_face(mesh_, f);
    patch.volume = -patch.volume;
  }
  double own_share(const Patch& patch, const Vec3& x) const {
    double w = 0;
    for (const std::uint32_t f : patch.faces)
      w += solid_angle_share(x, mesh_.corner(f, 0), mesh_.corner(f, 1), mesh_.corner(f, 2));
    return w;
  }
  template <class F>
  void for_asked(const Patch& patch, F f) const {
    const std::size_t step = (patch.faces.size() + kAsked - 1) / kAsked;
    for (std::size_t k = step / 2; k < patch.faces.size(); k += step) f(patch.faces[k]);
  }
  /// A step off a triangle: on it the own share is that of rounding.
  Vec3 beside(std::uint32_t f, double step) const {
    return mesh_.centroid(f) + step * mesh_.area_vector(f).normalized();
  }
  bool is_inside_others(const Patch& patch, const TriangleWinding& w) const {
    int votes = 0;
    for_asked(patch, [&](std::uint32_t f) {
      const Vec3 x = beside(f, 1e-6 * diagonal_);
      votes += std::abs(w(x) - own_share(patch, x)) > .5 ? 1 : -1;
    });
    return votes > 0;
  }
  void orient_closed();
  void orient_open();
  double fall_along_normals(const Patch& patch, const TriangleWinding& w) const;

  TriangleMesh& mesh_;
  const Context& context_;
  const FacePatches found_;
  const std::vector<Triangle> was_;
  std::vector<Patch> patches_;
  double diagonal_ = 0;
  FaceSidesReport report_;
};

void Sides::orient_closed() {
  std::vector<std::size_t> closed;
  for (std::size_t p = 0; p < patches_.size(); ++p)
    if (found_.is_closed[p]) closed.push_back(p);
  if (closed.empty()) return;
  const auto size = [&](std::size_t p) { return std::abs(patches_[p].volume); };
  const std::size_t largest =
      *std::max_element(closed.begin(), closed.end(), [&](auto a, auto b) { return size(a) < size(b); });
  if (patches_[largest].volume < 0)
    for (Patch& patch : patches_) turn(patch);
  if (patches_.size() == 1) return;
  const TriangleWinding w(mesh_);
  std::vector<std::uint8_t> is_inside(closed.size());
  polled_parallel_for(closed.size(), kPatchesPerPoll, context_,
                      [&](std::size_t i) { is_inside[i] = is_inside_others(patches_[closed[i]], w) ? 1 : 0; });
  for (std::size_t i = 0; i < closed.size(); ++i) {
    Patch& patch = patches_[closed[i]];
    if (is_inside[i])
      ++(patch.volume < 0 ? report_.n_cavities : report_.n_inner_shells);
    else if (patch.volume < 0)
      turn(patch);
  }
}

/// By how much the winding number of all others falls from behind the patch to before it, on average: 1 or near it
/// where it looks outward.
double Sides::fall_along_normals(const Patch& patch, const TriangleWinding& w) const {
  const double step = std::min(kWidth * std::sqrt(patch.area), kFarthest * diagonal_);
  double sum = 0, area = 0;
  for_asked(patch, [&](std::uint32_t f) {
    const double a = mesh_.area_vector(f).norm();
    const Vec3 behind = beside(f, -step), before = beside(f, step);
    sum += a * (w(behind) - own_share(patch, behind) - w(before) + own_share(patch, before));
    area += a;
  });
  return sum / area;
}

void Sides::orient_open() {
  std::vector<std::size_t> open;
  double area = 0, volume = 0;
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    if (found_.is_closed[p]) continue;
    open.push_back(p);
    area += patches_[p].area;
  }
  if (open.empty()) return;
  // Two patches that contradict each other would both be turned, again and again.
  std::size_t largest = 0;
  for (std::size_t p = 1; p < patches_.size(); ++p)
    if (patches_[p].area > patches_[largest].area) largest = p;
  for (int round = 0; round < kRounds && patches_.size() > 1; ++round) {
    const TriangleWinding w(mesh_);
    std::vector<std::uint8_t> is_wrong(open.size());
    polled_parallel_for(open.size(), kPatchesPerPoll, context_, [&](std::size_t i) {
      is_wrong[i] = open[i] != largest && fall_along_normals(patches_[open[i]], w) < kClearlyWrong ? 1 : 0;
    });
    if (std::count(is_wrong.begin(), is_wrong.end(), 1) == 0) break;
    for (std::size_t i = 0; i < open.size(); ++i)
      if (is_wrong[i]) turn(patches_[open[i]]);
  }
  for (const std::size_t p : open) volume += patches_[p].volume;
  const double sphere = std::pow(area, 1.5) / (6 * std::sqrt(std::numbers::pi));
  if (open.size() == patches_.size() && volume < kClearlyNegative * sphere)
    for (Patch& patch : patches_) turn(patch);
}

}  // namespace

FaceSidesReport orient_outward(TriangleMesh& mesh, const Context& context) {
  if (mesh.F.empty()) return {};
  return Sides(mesh, context)();
}

}  // namespace umtet
