#include "reconstruct/resolution.h"

#include <fmt/format.h>

#include <cmath>

namespace umtet {

namespace {

constexpr double kSpacings = 1.25, kNoises = 3;
constexpr double kCleanSmoothing = 0.001, kNoisySmoothing = 0.2;
// On eq. (9), 50k samples with noise of 0.5 % and 6 degrees: mean error 3.3e-4 of the diagonal with 6, 3.2e-4 with 10;
// 20k with .2 %: 3.6e-4 and 3.1e-4. Normals estimated from the samples deserve less trust than these.
constexpr double kValueNoises = 10;
// Samples of the armadillo are .029 edges of its mesh from psi = 0 instead of .035, those of spot_ascii (one lattice)
// .031 instead of .037. A quarter gives .025, but psi of the armadillo is so rough then that tets of Q = .79 are left.
constexpr double kFinestSpacings = .5;

}  // namespace

Resolution choose_resolution(double sample_spacing, double noise, double detail, double smooth) {
  const bool noisy = kNoises * noise > kSpacings * sample_spacing;
  Resolution r;
  r.spacing = (noisy ? kNoises * noise : kSpacings * sample_spacing) / detail;
  r.smoothing = smooth * (kCleanSmoothing + kNoisySmoothing * std::pow(noise / r.spacing, 2));
  r.reason =
      noisy ? fmt::format("{:.3g} times the noise of {:.3g}", kNoises / detail, noise)
            : fmt::format("{:.3g} times the distance of {:.3g} between samples", kSpacings / detail, sample_spacing);
  r.reason += fmt::format("; c = {:.3g} for noise of {:.3g} spacings", r.smoothing, noise / r.spacing);
  return r;
}

double value_length(double spacing, double noise) { return std::hypot(spacing, kValueNoises * noise); }

double finest_value_length(double spacing, double noise) {
  return std::hypot(kFinestSpacings * spacing, kValueNoises * noise);
}

}  // namespace umtet
