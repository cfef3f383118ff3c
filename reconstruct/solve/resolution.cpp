#include "reconstruct/solve/resolution.h"

#include <algorithm>
#include <cmath>

#include "common/formatted.h"

namespace umtet {

namespace {

// The finest spacing is 1.25 S, S the distance between samples, and at least three times the noise. A finer lattice
// follows single samples and their noise, a coarser one loses detail.
constexpr double kSampleSpacings = 1.25, kNoises = 3;
// A lattice coarser than the mesh is made as fine as it, but by no more than this factor: the spacing stays above S.
constexpr double kFiner = 1.2;
// Outside a sharp edge there are no samples, and a weak c lets psi fall below 0 there: a false piece of surface. A
// strong c rounds detail off. The finest band only corrects a psi that has its sign by then, so c is weaker there. With
// noise c rises with the square of noise / spacing: the data terms are sums of squares.
constexpr double kCleanSmoothing = 0.004, kFinestSmoothing = 0.001, kNoisySmoothing = 0.2;
// In the length l by which values are weighed (resolution.h): a sample that is off by the noise counts as much as a
// normal that is off by a tenth, 6 degrees. Less follows the noise of the samples; more leaves it to the normals where
// the surface is, and these are often estimated from the same samples.
constexpr double kValueNoises = 10;
// On the finest lattice l is this many spacings. Less brings psi = 0 nearer to the samples and makes it rougher, which
// costs quality of the tets; more leaves samples farther off.
constexpr double kFinestSpacings = .5;

}  // namespace

Resolution choose_resolution(double sample_spacing, double mesh_edge, double noise, double detail, double smooth,
                             double least) {
  const double of_samples = std::max(
      least, std::clamp(mesh_edge, kSampleSpacings / kFiner * sample_spacing, kSampleSpacings * sample_spacing));
  Resolution r;
  r.noise_decides = kNoises * noise > of_samples;
  r.spacing = (r.noise_decides ? kNoises * noise : of_samples) / detail;
  const double of_noise = kNoisySmoothing * std::pow(noise / r.spacing, 2);
  r.smoothing = smooth * (kCleanSmoothing + of_noise);
  r.finest_smoothing = smooth * (kFinestSmoothing + of_noise);
  r.reason = r.noise_decides ? formatted("%.3g times the noise of %.3g", kNoises / detail, noise)
                             : formatted("%.3g times the distance of %.3g between samples", r.spacing / sample_spacing,
                                         sample_spacing);
  r.reason += formatted("; c = %.3g, %.3g in the finest band, for noise of %.3g spacings", r.smoothing,
                        r.finest_smoothing, noise / r.spacing);
  return r;
}

double value_length(double spacing, double noise) { return std::hypot(spacing, kValueNoises * noise); }

double finest_value_length(double spacing, double noise) {
  return std::hypot(kFinestSpacings * spacing, kValueNoises * noise);
}

}  // namespace umtet
