#include "mesh/sizes/body_size.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/formatted.h"
#include "mesh/core/asking_psi.h"

namespace umtet {
namespace {

// Side of the coarse sampling of a body.
constexpr int kSamples = 64;

/// Tets in a cube whose edge is that of an A15 cell of the same h.
double tets_per_cube(const Tiling& tiling) {
  const double a15_cells = tiling.mean_edge / a15().mean_edge;  // a unit of the tiling is 1 / this of such an edge
  return static_cast<double>(tiling.tets.size()) / (tiling.period[0] * tiling.period[1] * tiling.period[2]) *
         (a15_cells * a15_cells * a15_cells);
}

struct CoarseMeasure {
  BodySize size;
  Box inside;  ///< of the samples inside, a sample wider on every side
};

/// Volume and area of {psi < 0} from the signs of psi on a lattice: counted points for the volume, Cauchy-Crofton for
/// the area (a unit of area is crossed by 3/2 lattice lines per d^2, averaged over normals).
CoarseMeasure sample(ImplicitFunctionRef psi, const Box& box, double steepest) {
  const double d = box.sizes().maxCoeff() / kSamples;
  const Eigen::Array3i n = (box.sizes().array() / d).ceil().cast<int>().max(1) + 1;
  std::vector<double> values(static_cast<std::size_t>(n.prod()));
  const Vec3 origin = box.center() - .5 * d * (n - 1).cast<double>().matrix();
  const auto take_row = [&](int k) {
    for (int j = 0; j < n.y(); ++j) {
      double* row = values.data() + static_cast<std::size_t>(n.x()) * (j + static_cast<std::size_t>(n.y()) * k);
      for (int i = 0; i < n.x();) {
        const double value = psi.value(origin + d * Vec3(i, j, k));
        // Samples of the row over which psi keeps its sign: |psi| / steepest is a bound of the distance to a zero.
        const double same = std::abs(value) / (steepest * d);
        const int end = same >= 1 ? i + 1 + static_cast<int>(std::min<double>(same, n.x() - i - 1)) : i + 1;
        std::fill(row + i, row + end, value);
        i = end;
      }
    }
  };
  if (psi.side_by_side() && !std::isfinite(steepest)) {
    const auto point = [&](std::size_t at) {
      const auto i = static_cast<int>(at);
      return Vec3(origin + d * Vec3(i % n.x(), i / n.x() % n.y(), i / (n.x() * n.y())));
    };
    take_in_blocks(psi, values.size(), {}, point, [&](std::size_t at, double value) { values[at] = value; });
  } else {
    tbb::parallel_for(0, n.z(), take_row);
  }
  BodySize size;
  double inside = 0, crossings = 0;
  Box found;
  const std::array<int, 3> stride = {1, n.x(), n.x() * n.y()};
  for (int k = 0; k < n.z(); ++k) {
    for (int j = 0; j < n.y(); ++j) {
      for (int i = 0; i < n.x(); ++i) {
        const std::size_t at = i + n.x() * (j + n.y() * static_cast<std::size_t>(k));
        const std::array<int, 3> index = {i, j, k};
        if (!std::isfinite(values[at]) && size.n_not_finite++ == 0) size.not_finite = origin + d * Vec3(i, j, k);
        if (values[at] < 0) {
          ++inside;
          found.extend(origin + d * Vec3(i, j, k));
        }
        for (int a = 0; a < 3; ++a) {
          if (index[a] + 1 < n[a]) crossings += (values[at] < 0) != (values[at + stride[a]] < 0);
        }
      }
    }
  }
  if (!found.isEmpty()) found = Box(found.min() - Vec3::Constant(d), found.max() + Vec3::Constant(d)).intersection(box);
  size.volume = inside * d * d * d;
  size.area = crossings * d * d / 1.5;
  return {size, found};
}

/// A body in a large box is sampled again in its own.
CoarseMeasure measure(ImplicitFunctionRef psi, const Box& box, double steepest) {
  // A body smaller than this share of the box's longest side has too few samples for an error of 10 %.
  constexpr double kTooSmall = .5;
  CoarseMeasure first = sample(psi, box, steepest);
  if (first.inside.isEmpty()) return first;
  const bool small = first.inside.sizes().maxCoeff() < kTooSmall * box.sizes().maxCoeff();
  return small ? sample(psi, first.inside, steepest) : first;
}

/// Thickness of the layer by which omega_h exceeds Omega, in cell edges of an A15.
double excess_layer(const Tiling& tiling, ClassificationSource source) {
  // Outside vertices of a chosen classification are nearer to psi = 0, so the layer is thinner.
  constexpr double kLessByChoice = .15;
  return tiling.excess_layer - (source == ClassificationSource::Chosen ? kLessByChoice : 0);
}

void check_box(const Box& box) {
  if (box.isEmpty() || !box.sizes().allFinite()) throw std::invalid_argument("box: must be finite and not empty");
}

}  // namespace

BodySize body_size(ImplicitFunctionRef psi, const Box& box, double steepest) {
  check_box(box);
  return measure(psi, box, steepest).size;
}

double expected_tets(const Tiling& tiling, const BodySize& size, double h, ClassificationSource source) {
  if (!(h > 0)) throw std::invalid_argument("h = " + std::to_string(h) + ": must be > 0");
  const double a = h / a15().mean_edge;
  const double volume = size.volume + excess_layer(tiling, source) * a * size.area;  // < 0 for specks in a cube
  return tets_per_cube(tiling) * std::max(volume, 0.) / (a * a * a);
}

double expected_tets(const Tiling& tiling, ImplicitFunctionRef psi, const Box& box, double h) {
  return expected_tets(tiling, body_size(psi, box), h);
}

double expected_tets(ImplicitFunctionRef psi, const Box& box, double h) { return expected_tets(a15(), psi, box, h); }

double h_for_tets(const Tiling& tiling, const BodySize& size, double n_tets, ClassificationSource source) {
  if (!(n_tets > 0)) throw std::invalid_argument("n_tets = " + std::to_string(n_tets) + ": must be > 0");
  if (!(size.volume > 0)) {
    std::string what = "psi: not negative at any of the samples taken in the box";
    if (size.n_not_finite > 0) {
      const Vec3& x = size.not_finite;
      what += formatted(", and not finite at %zu, first at (%.6g, %.6g, %.6g)", size.n_not_finite, x.x(), x.y(), x.z());
    }
    throw std::invalid_argument(what);
  }
  // a^3 = b a + c has one positive root, which Newton's steps meet from above: it is below cbrt(c) + sqrt(max(b, 0)).
  const double per_tet = tets_per_cube(tiling) / n_tets;
  const double b = per_tet * excess_layer(tiling, source) * size.area, c = per_tet * size.volume;
  double a = std::cbrt(c) + std::sqrt(std::max(b, 0.));
  for (int i = 0; i < 50; ++i) a = (2 * a * a * a + c) / (3 * a * a - b);
  return a * a15().mean_edge;
}

double h_for_tets(const Tiling& tiling, ImplicitFunctionRef psi, const Box& box, double n_tets) {
  return h_for_tets(tiling, body_size(psi, box), n_tets);
}

double h_for_tets(ImplicitFunctionRef psi, const Box& box, double n_tets, ClassificationSource source) {
  return h_for_tets(a15(), body_size(psi, box), n_tets, source);
}

}  // namespace umtet
