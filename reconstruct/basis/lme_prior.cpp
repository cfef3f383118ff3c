#include "reconstruct/basis/lme_prior.h"

#include <cmath>

namespace umtet {

namespace {
constexpr int kLargestHalfWidth = 4;  // eight lanes: two AVX registers of doubles
}

std::vector<std::string> problems(const LmePrior& prior) {
  std::vector<std::string> p;
  if (!(prior.gamma > 0 && prior.gamma <= 4)) p.push_back("prior gamma must be in (0, 4]");
  if (prior.kind == LmePrior::Kind::CompactC2) {
    if (prior.support < 2 || prior.support > kLargestHalfWidth) p.push_back("prior support must be 2, 3 or 4");
  } else {
    if (!(prior.epsilon > 0 && prior.epsilon < 1))
      p.push_back("prior epsilon must be in (0, 1)");
    else if (prior.gamma > 0 && !(radius(prior) <= kLargestHalfWidth && radius(prior) > 1))
      p.push_back("prior gamma and epsilon must put the cut sqrt(ln(1/epsilon)/gamma) between 1 and 4 spacings");
  }
  return p;
}

double radius(const LmePrior& prior) {
  return prior.kind == LmePrior::Kind::CompactC2 ? prior.support : std::sqrt(-std::log(prior.epsilon) / prior.gamma);
}

int half_width(const LmePrior& prior) { return static_cast<int>(std::ceil(radius(prior))); }

PriorJet evaluate(const LmePrior& prior, double t) {
  if (std::abs(t) >= radius(prior)) return {};
  if (prior.kind == LmePrior::Kind::Gaussian) {
    const double w = std::exp(-prior.gamma * t * t);
    return {w, -2 * prior.gamma * t * w, (4 * prior.gamma * prior.gamma * t * t - 2 * prior.gamma) * w};
  }
  constexpr double s = 4;
  const double k = 1.0 / (prior.support * prior.support), A = prior.gamma - s * k;
  const double g = 1 - t * t * k, E = std::exp(-A * t * t), g2 = g * g, g3 = g2 * g;
  const double h = -2 * A * t * g - 2 * s * t * k;  // w' = E g^3 h
  const double dh = -2 * A * g + 4 * A * t * t * k - 2 * s * k;
  return {E * g2 * g2, E * g3 * h, E * (g3 * dh - 2 * A * t * g3 * h - 6 * t * k * g2 * h)};
}

}  // namespace umtet
