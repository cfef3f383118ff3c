#include "pipeline/domain/deviation.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/domain/zero_set_choice.h"

namespace umtet {
namespace {

// (|k1| + |k2|) h^2 / kFlatness is the largest distance of a face from psi = 0: see the header.
constexpr double kFlatness = 6.8;
// Each round lets in at most one finer level of psi, and there are few levels.
constexpr int kRounds = 8;

/// max |k1| + |k2| over the pieces that are meshed, each curvature at most `cap`.
double greatest_curvature(const Domain& domain, double h, double cap, const Context& context) {
  const ZeroSetChoice pieces = choose_components(domain, h, context);
  std::vector<Vec3> x;
  for (const std::size_t c : pieces.kept) {
    const auto points = pieces.topology.points_of(pieces.topology.components[c]);
    x.insert(x.end(), points.begin(), points.end());
  }
  std::vector<double> sum(x.size());
  polled_parallel_for(x.size(), kValuesPerPoll, context, [&](std::size_t i) {
    const Eigen::Vector2d k = principal_curvatures(domain.psi(), x[i]);
    sum[i] = k.allFinite() ? k.cwiseMin(cap).sum() : 0;  // grad psi = 0: no surface there
  });
  return sum.empty() ? 0 : *std::max_element(sum.begin(), sum.end());
}

}  // namespace

Eigen::Vector2d principal_curvatures(ImplicitFunctionRef psi, const Vec3& x) {
  Vec3 g;
  Mat3 H;
  psi.value(x, g, H);
  const Vec3 n = g.normalized();
  const Mat3 P = Mat3::Identity() - n * n.transpose();
  // P H P / |grad psi| is the shape operator, with a third eigenvalue 0 along the normal.
  const Mat3 S = P * H * P / g.norm();
  Vec3 k = Eigen::SelfAdjointEigenSolver<Mat3>(S, Eigen::EigenvaluesOnly).eigenvalues().cwiseAbs();
  std::sort(k.data(), k.data() + 3);
  return {k[2], k[1]};
}

double h_for_deviation(Domain& domain, double deviation, double start, double least, const Context& context) {
  double h = start;
  for (int round = 0; round < kRounds && h > least; ++round) {
    domain.limit_detail(h);
    const double k = greatest_curvature(domain, h, 1 / deviation, context);
    const double wanted = k > 0 ? std::sqrt(kFlatness * deviation / k) : h;
    if (wanted >= h) return h;
    h = std::max(wanted, least);
  }
  domain.limit_detail(h);
  return h;
}

}  // namespace umtet
