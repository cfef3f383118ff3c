#include "reconstruct/solve/resolution.h"

#include <algorithm>
#include <cmath>

#include "common/formatted.h"

namespace umtet {

namespace {

constexpr double kSpacings = 1.25, kNoises = 3;
// A lattice coarser than the mesh is made as fine, but by no more than this. With 1000 to 2500 samples of koala, blub,
// spot, armadillo, scorpion and duck, psi then misses samples it has not seen by .81 to .97 of what it does otherwise
// (duck: 1.09).
constexpr double kFiner = 1.2;
// Outside a sharp edge no sample speaks, and a weak c lets psi < 0 there: beside 24 of 84 boxes of 1000 to 30,000
// samples with .001, beside 8 with .002, 1 with .003, none with .004. What a finest band corrects is too little for
// that, and it shows the detail: .001 costs a thousandth of h there.
constexpr double kCleanSmoothing = 0.004, kFinestSmoothing = 0.001, kNoisySmoothing = 0.2;
// On eq. (9), 50k samples with noise of 0.5 % and 6 degrees: mean error 3.3e-4 of the diagonal with 6, 3.2e-4 with 10;
// 20k with .2 %: 3.6e-4 and 3.1e-4. Normals estimated from the samples deserve less trust than these.
constexpr double kValueNoises = 10;
// Samples of the armadillo are .029 edges of its mesh from psi = 0 instead of .035, those of spot_ascii (one lattice)
// .031 instead of .037. A quarter gives .025, but psi of the armadillo is so rough then that tets of Q = .79 are left.
constexpr double kFinestSpacings = .5;

}  // namespace

Resolution choose_resolution(double sample_spacing, double mesh_edge, double noise, double detail, double smooth) {
  const double of_samples = std::clamp(mesh_edge, kSpacings / kFiner * sample_spacing, kSpacings * sample_spacing);
  const bool noisy = kNoises * noise > of_samples;
  Resolution r;
  r.spacing = (noisy ? kNoises * noise : of_samples) / detail;
  const double of_noise = kNoisySmoothing * std::pow(noise / r.spacing, 2);
  r.smoothing = smooth * (kCleanSmoothing + of_noise);
  r.finest_smoothing = smooth * (kFinestSmoothing + of_noise);
  r.reason =
      noisy ? formatted("%.3g times the noise of %.3g", kNoises / detail, noise)
            : formatted("%.3g times the distance of %.3g between samples", r.spacing / sample_spacing, sample_spacing);
  r.reason += formatted("; c = %.3g, %.3g in the finest band, for noise of %.3g spacings", r.smoothing,
                        r.finest_smoothing, noise / r.spacing);
  return r;
}

double value_length(double spacing, double noise) { return std::hypot(spacing, kValueNoises * noise); }

double finest_value_length(double spacing, double noise) {
  return std::hypot(kFinestSpacings * spacing, kValueNoises * noise);
}

}  // namespace umtet
