#include "reconstruct/level_set/mask_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "reconstruct/level_set/least_hessian.h"
#include "reconstruct/level_set/level_volume.h"
#include "reconstruct/level_set/voxel_lines.h"
#include "reconstruct/level_set/voxel_pieces.h"

namespace umtet {
namespace {

// psi = 0 keeps this far from centres of voxels, in voxels. With the first the surface is as smooth as without any
// margin; with the second a vessel of radius 1.2 keeps all but 12 % of its volume, with the first 53 %.
constexpr float kMargin = .1F, kThinMargin = .25F;
// The second holds where no voxel within kNearCore is kCoreDepth deep or deeper, in voxels: less than three across.
constexpr double kCoreDepth = 1.5, kNearCore = 2;
// psi of the other side at such a square, in voxels: the middle of the four then has the sign of the side that holds.
constexpr float kHeldApart = .2F;
// A flat side that is parallel to an axis may have any place between two layers of voxels at no cost: it stays in the
// middle. Waves of 2 pi / kPull^(1/4) = 17 voxels stay by half as the voxels have them; of those of eight, 5 % are
// left.
constexpr double kPull = 2e-2;
// In voxels: psi stays this near to the distance, and is searched this far from faces. Half a voxel is what the faces
// miss a smooth surface by; the search area is wide enough that twice as much changes no volume by more than .1 %.
constexpr float kNearDistance = 1, kBand = 5;
// Voxels around the body, with room for the mesh and for the stencil of the energy.
constexpr int kLayers = 8;
// The shift of the level, in margins: what is left keeps every centre on its side.
constexpr double kMostShift = .9;
// A piece has its volume when this share of it is missing; the secant method gets there in two or three steps.
constexpr double kVolumeTolerance = 5e-4;
constexpr int kMostShifts = 4;
// In margins: a shift that changes a volume by a hundredth of that.
constexpr double kLeastShift = 1e-3;
// Volume of a layer of .1 voxels around a ball of one voxel: .1 (36 pi)^(1/3).
constexpr double kBallMargin = .48;
// Where more is missing, the level is shifted farther at some places than at others.
constexpr double kMissedVolume = .003;

/// Sums of 3 x 3 x 3 values over 27.
void box_blur(std::vector<float>& v, const Eigen::Vector3i& n) {
  for (int axis = 0; axis < 3; ++axis) {
    for_each_line(v, n, axis, [](const VoxelLine<float>& line) {
      float before = line[0];
      for (int i = 0; i < line.n; ++i) {
        const float here = line[i], after = line[std::min(i + 1, line.n - 1)];
        line[i] = (before + here + after) / 3;
        before = here;
      }
    });
  }
}

/// The greatest of 3 x 3 x 3 values.
void box_dilate(std::vector<float>& v, const Eigen::Vector3i& n) {
  for (int axis = 0; axis < 3; ++axis) {
    for_each_line(v, n, axis, [](const VoxelLine<float>& line) {
      float before = line[0];
      for (int i = 0; i < line.n; ++i) {
        const float here = line[i], after = line[std::min(i + 1, line.n - 1)];
        line[i] = std::max({before, here, after});
        before = here;
      }
    });
  }
}

/// Marks the voxels whose side is thin.
std::vector<std::uint8_t> thin_voxels(const VoxelMask& mask) {
  const Vec3 unit = Vec3::Ones();
  std::vector<std::uint8_t> thin(mask.size(), 0);
  for (const char side : {char(0), char(1)}) {
    const std::vector<float> depth = voxel_distances(mask, unit, static_cast<char>(1 - side));
    VoxelMask core{mask.n, std::vector<char>(mask.size())};
    for (std::size_t i = 0; i < mask.size(); ++i) core.inside[i] = mask.inside[i] == side && depth[i] >= kCoreDepth;
    const std::vector<double> to_core = centre_distances(core, unit, 1);
    for (std::size_t i = 0; i < mask.size(); ++i)
      if (mask.inside[i] == side && to_core[i] > kNearCore) thin[i] = 1;
  }
  return thin;
}

/// m at every voxel, in voxels: smooth, as the level is shifted in proportion to it.
std::vector<float> margins(const VoxelMask& mask, const std::vector<std::uint8_t>& thin) {
  std::vector<float> m(thin.begin(), thin.end());
  box_dilate(m, mask.n);
  box_blur(m, mask.n);
  for (float& v : m) v = kMargin + (kThinMargin - kMargin) * v;
  return m;
}

/// Voxels of a square of four of which two are inside and two outside, across from each other: psi = 0 may pass between
/// the two pairs either way. What is thin is to hold together.
/// @param thin  where a voxel's own side is thin
/// @param f     f(voxel, hold): `hold` is the side that is to be connected, 1 inside
template <class F>
void for_each_crossing(const VoxelMask& mask, const std::vector<std::uint8_t>& thin, const F& f) {
  const Eigen::Vector3i& n = mask.n;
  const std::ptrdiff_t stride[] = {1, n[0], static_cast<std::ptrdiff_t>(n[0]) * n[1]};
  for (std::ptrdiff_t at = 0; at + stride[2] + stride[1] + 1 < static_cast<std::ptrdiff_t>(mask.size()); ++at) {
    for (int a = 0; a < 3; ++a) {
      const std::ptrdiff_t s = stride[a], t = stride[(a + 1) % 3];
      if (mask.inside[at] != mask.inside[at + s + t] || mask.inside[at + s] != mask.inside[at + t] ||
          mask.inside[at] == mask.inside[at + s])
        continue;
      const std::ptrdiff_t of_square[] = {at, at + s, at + t, at + s + t};
      bool is_thin[2] = {false, false};
      for (const std::ptrdiff_t i : of_square)
        if (thin[i]) is_thin[static_cast<int>(mask.inside[i])] = true;
      if (!is_thin[0] && !is_thin[1]) continue;
      for (const std::ptrdiff_t i : of_square) f(i, static_cast<char>(is_thin[1] ? 1 : 0));
    }
  }
}

/// Marks the voxels that are within the band, but for the two outermost layers.
std::vector<std::uint8_t> band_of(const std::vector<float>& d, const Eigen::Vector3i& n, float width) {
  std::vector<std::uint8_t> is_free(d.size(), 0);
  for (int k = 2; k + 2 < n[2]; ++k) {
    for (int j = 2; j + 2 < n[1]; ++j) {
      const std::ptrdiff_t row = n[0] * (j + static_cast<std::ptrdiff_t>(n[1]) * k);
      for (int i = 2; i + 2 < n[0]; ++i) is_free[row + i] = std::abs(d[row + i]) <= width ? 1 : 0;
    }
  }
  return is_free;
}

/// The piece of every voxel that is within two layers of one, the least where there are several.
std::vector<std::int32_t> owners(const VoxelMask& mask, const VoxelPieces& pieces) {
  std::vector<std::int32_t> owner = pieces.piece;
  std::vector<std::int32_t> before;
  for (int layer = 0; layer < 2; ++layer) {
    for (int axis = 0; axis < 3; ++axis) {
      for_each_line(owner, mask.n, axis, [](const VoxelLine<std::int32_t>& line) {
        std::int32_t left = -1;
        for (int i = 0; i < line.n; ++i) {
          const std::int32_t here = line[i], right = i + 1 < line.n ? line[i + 1] : -1;
          if (here < 0) line[i] = left < 0 ? right : right < 0 ? left : std::min(left, right);
          left = here;
        }
      });
    }
  }
  return owner;
}

GridLevelSet interpolated(const BodyVoxels& voxels, const std::vector<float>& values, double unit) {
  Grid grid;
  grid.n = voxels.mask.n;
  grid.origin = voxels.origin;
  grid.axes = voxels.axes;
  grid.values.resize(values.size());
  std::transform(values.begin(), values.end(), grid.values.begin(), [&](float v) { return unit * v; });
  return interpolate(std::move(grid));
}

/// psi in units of the smallest step, and the shift of its level.
class MaskSearch {
 public:
  explicit MaskSearch(BodyVoxels voxels)
      : voxels_(std::move(voxels)),
        unit_(voxels_.steps().minCoeff()),
        steps_(voxels_.steps() / unit_),
        thin_(thin_voxels(voxels_.mask)),
        margin_(margins(voxels_.mask, thin_)) {}

  MaskFit fit() {
    const VoxelMask& mask = voxels_.mask;
    const std::vector<float> d = signed_face_distances(mask, steps_);
    MaskReport report;
    report.n_iterations = search(d);
    report.n_inside = static_cast<std::size_t>(std::count(mask.inside.begin(), mask.inside.end(), 1));
    report.volume_of_voxels = static_cast<double>(report.n_inside) * voxels_.voxel_volume();
    GridLevelSet psi = shifted(report);
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if ((value_[i] < 0) == (mask.inside[i] != 0)) continue;
      ++report.n_changed;
      report.farthest_changed = std::max<double>(report.farthest_changed, unit_ * std::abs(value_[i]));
    }
    std::vector<Vec3> surface = sign_changes(voxels_, value_);
    return {std::move(psi), report, std::move(voxels_), std::move(surface)};
  }

 private:
  /// A margin in units: of the distance to the face where that is less than half the largest step.
  float margin_at(std::size_t i, float d) const {
    return margin_[i] * std::min(2 * std::abs(d), static_cast<float>(steps_.maxCoeff()));
  }
  int search(const std::vector<float>& d) {
    const auto voxel = static_cast<float>(steps_.maxCoeff());
    BoundedValues u{voxels_.mask.n, d, d, d, band_of(d, voxels_.mask.n, kBand * voxel)};
    std::vector<float> margin_of_(d.size());
    for (std::size_t i = 0; i < d.size(); ++i) {
      const float m = margin_at(i, d[i]);
      const float low = d[i] - kNearDistance * voxel, high = d[i] + kNearDistance * voxel;
      u.low[i] = d[i] > 0 ? std::max(low, m) : low;
      u.high[i] = d[i] < 0 ? std::min(high, -m) : high;
      margin_of_[i] = margin_[i];
      margin_[i] = m;
    }
    for_each_crossing(voxels_.mask, thin_, [&](std::ptrdiff_t i, char hold) {
      const float unit = margin_[i] / margin_of_[i];
      const float held = kThinMargin * unit, other = kHeldApart * unit;
      const bool is_held = voxels_.mask.inside[i] == hold;
      float &inner = voxels_.mask.inside[i] ? u.high[i] : u.low[i],
            &outer = voxels_.mask.inside[i] ? u.low[i] : u.high[i];
      const float sign = voxels_.mask.inside[i] ? -1.F : 1.F;
      if (is_held && sign * inner < held) inner = sign * held;
      if (!is_held && sign * outer > other) outer = sign * other;
      if (sign * inner > sign * outer) inner = outer;
    });
    LeastHessianParams params;
    params.pull = kPull;
    const int n = minimise_hessian(u, steps_.cwiseAbs2().cwiseInverse(), params);
    value_ = std::move(u.value);
    return n;
  }
  std::vector<double> volumes(const GridLevelSet& psi, const std::vector<std::int32_t>& owner, std::size_t n) const {
    std::vector<double> v = volumes_of_pieces(psi.in_nodes(), value_, owner, n, steps_.maxCoeff());
    for (double& x : v) x *= voxels_.voxel_volume();
    return v;
  }
  /// How far the level may go to one side at each voxel, until a centre near it changes sides: smooth, in units.
  /// @param outward  psi falls, the body grows
  std::vector<float> room(bool outward) const;
  GridLevelSet interpolated_now() const { return interpolated(voxels_, value_, unit_); }
  GridLevelSet shifted(MaskReport& report);
  GridLevelSet shift_by(const std::vector<float>& inward, const std::vector<float>& outward,
                        const std::vector<std::int32_t>& owner, const VoxelPieces& pieces, std::vector<double>& volume);

  BodyVoxels voxels_;
  double unit_;
  Vec3 steps_;  ///< in units
  std::vector<std::uint8_t> thin_;
  std::vector<float> margin_, value_;
};

std::vector<float> MaskSearch::room(bool outward) const {
  const VoxelMask& mask = voxels_.mask;
  const char side = outward ? 0 : 1;
  // Beyond a voxel there is room enough.
  std::vector<float> free(mask.size(), static_cast<float>(steps_.maxCoeff()));
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask.inside[i] == side) free[i] = std::min(free[i], std::max(0.F, std::abs(value_[i])));
  for (float& v : free) v = -v;
  box_dilate(free, mask.n);
  for (float& v : free) v = -v;
  box_blur(free, mask.n);
  return free;
}

/// psi + s w with an s of each piece between 0 and kMostShift, w one of the two by the sign of what it lacks: a secant
/// method for the volume.
/// @param volume  in: of the pieces now; out: then
GridLevelSet MaskSearch::shift_by(const std::vector<float>& inward, const std::vector<float>& outward,
                                  const std::vector<std::int32_t>& owner, const VoxelPieces& pieces,
                                  std::vector<double>& volume) {
  const std::size_t n = pieces.n();
  const double voxel = voxels_.voxel_volume();
  std::vector<double> at(n, 0), slope(n, 0), first(volume);
  GridLevelSet psi = interpolated_now();
  for (int step = 0; step < kMostShifts; ++step) {
    std::vector<float> by(n, 0);
    bool is_done = true;
    for (std::size_t p = 0; p < n; ++p) {
      const double wanted = static_cast<double>(pieces.n_voxels[p]) * voxel, miss = wanted - volume[p];
      if (std::abs(miss) <= kVolumeTolerance * wanted) continue;
      // The margin of a ball of as many voxels has this share of its volume.
      if (step == 0) slope[p] = kBallMargin * std::pow(static_cast<double>(pieces.n_voxels[p]), 2. / 3) * voxel;
      const double grow = std::clamp(at[p] + miss / slope[p], -kMostShift, kMostShift);
      // On the side that it began to move to.
      const double next = wanted > first[p] ? std::max(0., grow) : std::min(0., grow);
      by[p] = static_cast<float>(next - at[p]);
      at[p] = next;
      if (std::abs(by[p]) > kLeastShift) is_done = false;
    }
    if (is_done) break;
    for (std::size_t i = 0; i < value_.size(); ++i) {
      if (owner[i] < 0) continue;
      const auto p = static_cast<std::size_t>(owner[i]);
      const bool grows = static_cast<double>(pieces.n_voxels[p]) * voxel > first[p];
      value_[i] -= by[p] * (grows ? outward[i] : inward[i]);
    }
    psi = interpolated_now();
    const std::vector<double> former = std::exchange(volume, volumes(psi, owner, n));
    for (std::size_t p = 0; p < n; ++p)
      if (std::abs(by[p]) > kLeastShift && (volume[p] - former[p]) / by[p] > 0)
        slope[p] = (volume[p] - former[p]) / by[p];
  }
  return psi;
}

/// By piece: first in proportion to the margin, which leaves the surface as smooth as it is; where that is not enough,
/// as on a box, whose rounded edges press its faces outward, as far as each place allows.
GridLevelSet MaskSearch::shifted(MaskReport& report) {
  const VoxelPieces pieces = voxel_pieces(voxels_.mask, 1, VoxelNeighbours::Points);
  const std::vector<std::int32_t> owner = owners(voxels_.mask, pieces);
  std::vector<double> volume = volumes(interpolated_now(), owner, pieces.n());
  GridLevelSet psi = shift_by(margin_, margin_, owner, pieces, volume);
  const auto misses = [&](std::size_t p) {
    const double wanted = static_cast<double>(pieces.n_voxels[p]) * voxels_.voxel_volume();
    return std::abs(volume[p] - wanted) > kMissedVolume * wanted;
  };
  bool is_enough = true;
  for (std::size_t p = 0; p < pieces.n(); ++p) is_enough = is_enough && !misses(p);
  if (!is_enough) psi = shift_by(room(false), room(true), owner, pieces, volume);
  report.volume = std::accumulate(volume.begin(), volume.end(), 0.);
  return psi;
}

}  // namespace

MaskFit fit_mask(const Grid& grid, std::optional<double> part) {
  return MaskSearch(body_voxels(grid, part, kLayers)).fit();
}

}  // namespace umtet
