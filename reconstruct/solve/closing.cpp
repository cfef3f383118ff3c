#include "reconstruct/solve/closing.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>

namespace umtet {
namespace {

using How = FittedHole::How;

// Of a value of a far cell, where a sample of the surface has about 1: it decides where nothing else does. With more,
// the joint between what samples say and what is said here is narrower: an edge along rims.
constexpr double kFarWeight = 1e-3;
// Below this cosine along its rim a hole is closed flat: a surface that comes down to its rim at a right angle to it,
// as where a body stands on a table, is .0, and noise and single edges of a rim leave a tenth.
constexpr double kFlatCosine = .15;
// Outside of a ball that is cut by a plane, w at the far end of what is missing is level_of_ball(); psi < 0 at less
// than this share of it is too far out. Flat holes: where less than that of the directions is inner side.
constexpr double kShareOfLevel = .9, kFlatLevel = .2;
// Algebraic spheres have the word up to the bulge of a hole, and lose it up to this many bulges.
constexpr double kLastBulge = 1.5;
// Where w is below this, a place is outside of the body however its holes are closed.
constexpr double kSurelyOutside = .1;
// Samples have a body behind them where w on their inner side is more: 1/2 on one side of a sheet, which has none, .55
// behind a shallow relief.
constexpr double kLeastInner = .55;

// Of a ball that is cut by a plane where its normals have the cosine c with the plane's: the winding number of the
// rest, at the far end of the part that is missing.
double level_of_ball(double c) { return .5 * (1 - std::sqrt((1 - std::clamp(c, 0., 1.)) / 2)); }

struct Nodes {
  Eigen::Vector3i n;
  std::size_t size() const { return static_cast<std::size_t>(n[0]) * n[1] * n[2]; }
  std::size_t operator()(int i, int j, int k) const {
    return i + static_cast<std::size_t>(n[0]) * (j + static_cast<std::size_t>(n[1]) * k);
  }
  bool at_wall(int i, int j, int k) const {
    return i == 0 || j == 0 || k == 0 || i == n[0] - 1 || j == n[1] - 1 || k == n[2] - 1;
  }
  /// Calls f(i, j, k, index), layers in parallel.
  template <class F>
  void for_each(F&& f) const {
    tbb::parallel_for(0, n[2], [&](int k) {
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) f(i, j, k, (*this)(i, j, k));
    });
  }
};

/// Whether psi < 0 at the wall, or psi = 0 between two nodes that no sample is near.
bool leaves_samples(const Nodes& nodes, const std::vector<std::uint8_t>& far, const std::vector<float>& value) {
  const std::array<std::size_t, 3> stride{1, nodes(0, 1, 0), nodes(0, 0, 1)};
  for (int k = 0; k < nodes.n[2]; ++k)
    for (int j = 0; j < nodes.n[1]; ++j)
      for (int i = 0; i < nodes.n[0]; ++i) {
        const std::size_t a = nodes(i, j, k);
        if (!far[a]) continue;
        if (value[a] < 0 && nodes.at_wall(i, j, k)) return true;
        const std::array<int, 3> at{i, j, k};
        for (int d = 0; d < 3; ++d) {
          if (at[d] + 1 == nodes.n[d]) continue;
          const std::size_t b = a + stride[d];
          if (far[b] && (value[a] < 0) != (value[b] < 0)) return true;
        }
      }
  return false;
}

}  // namespace

ClosingPlan::ClosingPlan(const LevelSet& psi, std::vector<SsdSample> samples, Closing closing)
    : lattice_(psi.coarsest().lattice), closing_(closing), surface_(std::move(samples)) {
  for (const SsdSample& s : surface_) box_.extend(lattice_.origin + lattice_.h * s.xi);
  if (closing_ == Closing::None || !find_holes(psi)) return;
  is_needed_ = true;
  prepare();
}

bool ClosingPlan::is_flat(int hole) const {
  return closing_ == Closing::Flat || (closing_ == Closing::Auto && found_.holes[hole].rim_cosine < kFlatCosine);
}

// @return whether anything has to be closed
bool ClosingPlan::find_holes(const LevelSet& psi) {
  const Nodes nodes{lattice_.n};
  const std::vector<std::uint8_t> far = far_nodes(lattice_.n, SampleColumns(surface_).places);
  std::vector<float> value(nodes.size(), 0), w(nodes.size(), 0);
  nodes.for_each([&](int i, int j, int k, std::size_t a) {
    if (far[a]) value[a] = static_cast<float>(psi.value(lattice_.origin + lattice_.h * Vec3(i, j, k)));
  });
  if (!leaves_samples(nodes, far, value)) return false;

  winding_.emplace(surface_);
  if (winding_->inner() < kLeastInner) return false;
  nodes.for_each([&](int i, int j, int k, std::size_t a) {
    if (far[a]) w[a] = static_cast<float>((*winding_)(Vec3(i, j, k)));
  });
  found_ = scan_holes(surface_, *winding_, lattice_.n, far, w);
  if (!found_.places.empty()) closing_tree_.emplace(found_.places);
  return judge(far, value, w);
}

// Says of every hole how it is closed, by the nodes where psi has the wrong sign. @return whether anything has to be
// closed
bool ClosingPlan::judge(const std::vector<std::uint8_t>& far, const std::vector<float>& value,
                        const std::vector<float>& w) {
  const Nodes nodes{lattice_.n};
  std::vector<std::size_t> n_beyond(found_.holes.size(), 0);
  bool leaks = false;  // where there is no hole: by wrong normals
  for (int k = 0; k < nodes.n[2]; ++k)
    for (int j = 0; j < nodes.n[1]; ++j)
      for (int i = 0; i < nodes.n[0]; ++i) {
        const std::size_t a = nodes(i, j, k);
        if (!far[a] || (value[a] < 0) == (w[a] > .5F)) continue;
        const double part = std::min(w[a], 1 - w[a]);  // of the directions, that speaks for psi's sign
        const bool ends_at_wall = nodes.at_wall(i, j, k);
        if (!closing_tree_) {
          leaks = leaks || ends_at_wall || part < kSurelyOutside;
          continue;
        }
        std::array<Neighbour, 1> room;
        const Neighbour near = closing_tree_->k_nearest(Vec3(i, j, k), room).front();
        const int h = found_.hole_of[near.point];
        const ScanHole& hole = found_.holes[h];
        const double level = is_flat(h) ? kFlatLevel : kShareOfLevel * level_of_ball(hole.rim_cosine);
        const double reach = is_flat(h) ? 1 : std::max(1., hole.bulge()) + 1;
        if (ends_at_wall || (part < level && near.distance2 > reach * reach)) ++n_beyond[h];
      }
  bool any = leaks;
  for (std::size_t h = 0; h < found_.holes.size(); ++h) {
    const bool is_closed = n_beyond[h] > 0 || closing_ == Closing::Flat;
    any = any || is_closed;
    closed_.push_back({found_.holes[h], !is_closed                     ? How::AsFitted
                                        : is_flat(static_cast<int>(h)) ? How::Flat
                                                                       : How::Smooth});
    ScanHole& hole = closed_.back().hole;
    hole.centre = lattice_.origin + lattice_.h * hole.centre;
    hole.area *= lattice_.h * lattice_.h;
    hole.depth *= lattice_.h;
  }
  return any;
}

// The flat closings become samples of the surface; the box takes in how far smooth ones may go.
void ClosingPlan::prepare() {
  std::vector<SsdSample> all = surface_;
  for (std::size_t p = 0; p < found_.places.size(); ++p) {
    const int h = found_.hole_of[p];
    const Vec3 &x = found_.places[p], &normal = found_.normals[p];
    if (closed_[h].how == How::Flat) {
      // Areas of samples are off by the scale; where both are summed up, these have to be, too.
      all.push_back({x, normal, 0, winding_->scale() * found_.areas[p]});
    } else if (closed_[h].how == How::Smooth) {
      box_.extend(lattice_.origin + lattice_.h * (x + std::max(1., found_.holes[h].bulge()) * normal));
    }
  }
  if (all.size() > surface_.size()) winding_.emplace(all);
  const SampleColumns columns(all);
  spheres_.emplace(columns.places, columns.normals, columns.areas);
}

// Of a far cell, in cells of the first fit; none where psi needs none.
std::optional<double> ClosingPlan::value_at(const Vec3& x, double nearest) const {
  const double w = (*winding_)(x);
  double share = 0;  // of the algebraic spheres
  bool is_closed = false;
  if (closing_tree_) {
    std::array<Neighbour, 1> room;
    const Neighbour near = closing_tree_->k_nearest(x, room).front();
    const int h = found_.hole_of[near.point];
    is_closed = closed_[h].how != How::AsFitted;
    const double bulge = std::max(1., found_.holes[h].bulge());
    if (closed_[h].how == How::Smooth)
      share = std::clamp((kLastBulge - std::sqrt(near.distance2) / bulge) / (kLastBulge - 1), 0., 1.);
  }
  if (!is_closed && w > kSurelyOutside) return std::nullopt;
  const double side = w < .5 ? nearest : -nearest;
  if (share == 0) return side;
  return share * std::clamp(spheres_->signed_distance(x), -nearest, nearest) + (1 - share) * side;
}

std::vector<SsdSample> ClosingPlan::samples(const Lattice& lattice) const {
  const double to = lattice.h / lattice_.h;
  const auto here = [&](const Vec3& xi) {
    return Vec3((lattice_.origin + lattice_.h * xi - lattice.origin) / lattice.h);
  };
  const auto there = [&](const Vec3& xi) {
    return Vec3((lattice.origin + lattice.h * xi - lattice_.origin) / lattice_.h);
  };
  std::vector<SsdSample> result;
  for (std::size_t p = 0; p < found_.places.size(); ++p) {
    if (closed_[found_.hole_of[p]].how != How::Flat) continue;
    const double area = found_.areas[p] / (to * to);
    result.push_back({here(found_.places[p]), found_.normals[p], area, area});
  }
  std::vector<Vec3> places;
  for (const SsdSample& s : surface_) places.push_back(here(s.xi));
  for (const SsdSample& s : result) places.push_back(s.xi);
  const std::vector<std::uint8_t> far = far_nodes(lattice.n, places);
  const NeighbourTree tree(places);
  const Nodes nodes{lattice.n};
  std::vector<std::vector<SsdSample>> layers(lattice.n[2]);
  nodes.for_each([&](int i, int j, int k, std::size_t a) {
    if (!far[a] || i + 1 == nodes.n[0] || j + 1 == nodes.n[1] || k + 1 == nodes.n[2]) return;
    const Vec3 x(i + .5, j + .5, k + .5);
    std::array<Neighbour, 1> room;
    const double nearest = std::sqrt(tree.k_nearest(x, room).front().distance2);
    if (const std::optional<double> value = value_at(there(x), nearest * to))
      layers[k].push_back({x, Vec3::Zero(), kFarWeight, 0, *value / to});
  });
  for (const std::vector<SsdSample>& layer : layers) result.insert(result.end(), layer.begin(), layer.end());
  return result;
}

}  // namespace umtet
