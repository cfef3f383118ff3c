#include "body/scan/level_set_fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "body/option_names.h"
#include "body/sizing/wanted_detail.h"
#include "common/formatted.h"
#include "reconstruct/cloud/cleaning/covering.h"
#include "reconstruct/cloud/cleaning/merged_samples.h"
#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/cloud/normals/enclosed_volume.h"
#include "reconstruct/cloud/survey/cloud_survey.h"
#include "reconstruct/cloud/survey/local_noise.h"
#include "reconstruct/solve/noise_bias.h"
#include "reconstruct/solve/turned_fit.h"

namespace umtet {
namespace {

/// Distances between opposed samples; none where none face one another.
std::optional<std::array<double, 3>> thickness_percentiles(const OrientedPointCloud& cloud, const NeighbourTree& tree) {
  // 20 of them fall below the first percentile, and all together take a small part of a second.
  constexpr std::size_t kRays = 2000;
  const std::vector<double> t = thicknesses(cloud, tree, kRays);
  if (t.empty()) return std::nullopt;
  const auto at = [&](double p) { return t[static_cast<std::size_t>(p * static_cast<double>(t.size() - 1))]; };
  return {{at(.01), at(.05), at(.5)}};
}

/// States how the holes of the scan were closed; none where the fit alone closes all.
std::optional<Message> described(const std::vector<FittedHole>& holes) {
  const auto count = [&](FittedHole::How how) {
    return std::count_if(holes.begin(), holes.end(), [how](const FittedHole& h) { return h.how == how; });
  };
  const auto flat = count(FittedHole::How::Flat), smooth = count(FittedHole::How::Smooth);
  if (flat + smooth == 0) return std::nullopt;
  return Message(
      formatted("closed where no sample is: %td hole%s flat, %td smoothly", flat, flat == 1 ? "" : "s", smooth),
      {{Change::Use, option::close, "chooses"}, {Change::Use, {option::close, "none"}, "does not"}});
}

// Of normals that were turned and psi fitted again as often as that helped. Noise as large as the parts of a body
// leaves a fifth; normals that mean nothing leave a third and more.
constexpr double kHopeless = .3;

/// local_noise(), of points that are not even that of the nearest that is.
std::vector<double> noise_of_all(const OrientedPointCloud& cloud, const OrientedPointCloud& even,
                                 const NeighbourTree& tree, double usual) {
  std::vector<double> local = local_noise(even, tree, usual);
  if (local.empty() || &even == &cloud) return local;
  std::vector<double> all(cloud.points.size());
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    std::array<Neighbour, 1> room;
    all[i] = local[tree.k_nearest(cloud.points[i], room).front().point];
  });
  return all;
}

// Texture as fine as the samples, and two sheets near each other, look like noise to quadrics through neighbours; psi
// fits them. Each round lets psi show more of it.
constexpr int kNoiseRounds = 3;
// Of the noise, what psi has to leave to be believed.
constexpr double kLeft = .85;

/// The discrepancy principle [Morozov1966]: psi leaves as much as there is noise, where noise decides its spacing.
/// Without noise it always leaves less.
bool leaves_less(const SsdReport& report, double noise) {
  return report.noise_decided && report.rms_value < kLeft * noise;
}

// And what it may leave, unless that is little for its lattice, as psi rounds edges: more is a contradiction of
// samples, such as two sheets.
constexpr double kLeftAtMost = 1.5, kLeftOfSpacing = .12;  // of the lattice's
bool leaves_more(const SsdReport& report, double noise, double finest) {
  if (report.spacing <= finest) return false;  // that is detail which is not wanted
  return report.rms_value > std::max(kLeftAtMost * noise, kLeftOfSpacing * report.spacing);
}

// |grad psi - n|^2 of samples that have a surface is below .27 with normals 30 degrees off, and below .36 with noise of
// half the thickness of a body; of noise in a ball it is .35 and more.
constexpr double kDoubtfulDefect = .3;
// Of the diagonal: where normals follow psi all the same, the samples are this far off it. The noisiest scans of
// benchmarks have .014.
constexpr double kDoubtfulNoise = .05;
// Of points that fill a volume.
constexpr double kVolumeDimension = 2.5;

/// No surface is there to be found.
void refuse_volume(const OrientedPointCloud& cloud, const SsdReport& r, double noise) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : cloud.points) box.extend(x);
  if (r.normal_defect < kDoubtfulDefect && noise < kDoubtfulNoise * box.diagonal().norm()) return;
  const double dimension = correlation_dimension(cloud.points);
  if (dimension < kVolumeDimension) return;
  throw SolveError(
      formatted("the samples are no surface: their number within r grows like r^%.2g, the normals are off the "
                "gradient of psi by %.2g (mean square), and the samples off psi = 0 by %.2g; give samples of a "
                "surface",
                dimension, r.normal_defect, noise));
}

void require_body(const SsdReport& r) {
  const double opposed = opposed_share(r);
  const bool open = r.least_wall_value < 0;
  if (!open && opposed <= kHopeless) return;
  throw SolveError(
      formatted("%s: %.1f %% of the %zu normals point against its gradient; %sorient the normals consistently, outward",
                open ? "psi < 0 reaches the wall of its box: the samples do not bound a body with outward normals"
                     : "psi was fitted, but the normals disagree with one another",
                100 * opposed, r.n_points, open ? "check that the surface is closed, and " : ""));
}

/// Of samples that were merged for a mesh: no lattice that it has no use for.
void leave_out_finer(const OrientedPointCloud& cloud, const NeighbourDistances& near, const BodyOptions& options,
                     SsdParams& params, LevelSetReport& report) {
  if (params.spacing > 0) return;
  const std::vector<std::uint32_t> one(cloud.points.size(), 0);
  const EnclosedVolume body = enclosed_volumes(cloud, sample_areas(near), one, 1).front();
  ScanSize scan{.volume = body.volume, .area = body.area, .noise = params.noise};
  Eigen::AlignedBox3d box;
  for (const Vec3& x : cloud.points) box.extend(x);
  scan.diagonal = box.diagonal().norm();
  if (report.thickness) scan.thickness = report.thickness->front();
  params.finest = finest_lattice(options, scan);
  report.left_out_finer = params.finest > 0;
}

// As choose_resolution() has it: 1.25 spacings of samples.
constexpr double kSpacings = 1.25;

/// Where the samples of thin parts ask for a finer lattice than the median sample does: that one; else 0.
double lattice_of(const ExactSamples& exact, const NeighbourDistances& near, const SsdParams& params) {
  // Samples are rarely nearer to each other than .8 of the spacing of most (triangle_samples.h).
  constexpr double kAsDense = .8;
  if (exact.least_spacing > kAsDense * sample_spacing(near)) return 0;
  return kSpacings * exact.least_spacing / params.detail;
}

/// @param cloud  near the origin
LevelSetFit fit_near_origin(OrientedPointCloud& cloud, NeighbourDistances near, const BodyOptions& options,
                            const Context& context, BandRefiner* bands, const std::optional<ExactSamples>& exact) {
  SsdParams params = ssd_params(options.fit);
  params.bands = bands;
  params.max_memory = options.max_memory;
  context.report("noise", 0);
  LevelSetReport report;
  if (near.nearest.empty()) near = covered_distances(cloud.points, cloud.counts);
  {
    const bool is_even = near.representatives.empty();
    const OrientedPointCloud few = is_even ? OrientedPointCloud() : picked(cloud, near.representatives);
    const OrientedPointCloud& even = is_even ? cloud : few;
    const NeighbourTree tree(even.points);
    const double noise = exact && options.fit.noise < 0 ? 0 : options.fit.noise;
    const double of_samples = noise >= 0 ? noise : noise_along_normals(even, tree);
    if (noise < 0) params.local_noise = noise_of_all(cloud, even, tree, of_samples);
    params.noise = noise >= 0 || cloud.counts.empty() ? of_samples : noise_before_merging(even, tree);
    report.thickness = thickness_percentiles(even, tree);
  }
  if (!cloud.counts.empty()) leave_out_finer(cloud, near, options, params, report);
  params.bounded = exact.has_value();
  if (exact && params.spacing == 0) params.spacing = lattice_of(*exact, near, params);
  SsdFit fit = fit_turning_opposed(cloud, params, context, &near);
  if (!exact && options.fit.noise < 0) {
    for (int round = 0; round < kNoiseRounds && (leaves_less(fit.report, params.noise) ||
                                                 (round == 0 && leaves_more(fit.report, params.noise, params.finest)));
         ++round) {
      params.noise = fit.report.rms_value;
      fit = fit_turning_opposed(cloud, params, context, &near);
    }
  }
  report.noise = params.noise;
  if (fit.report.noise_decided) {  // else it is a small part of psi's own error
    report.noise_bias = noise_bias(fit.psi, cloud, params.noise);
    fit.psi = shifted(fit.psi, report.noise_bias);
  }
  require_body(fit.report);
  refuse_volume(cloud, fit.report, report.noise);
  std::vector<Message> notices;
  if (const std::size_t n = fit.report.n_turned_normals; n > 0)
    notices.emplace_back(formatted("turned %zu normals that psi opposed, and fitted again", n));
  if (std::optional<Message> closed = described(fit.report.holes)) notices.push_back(std::move(*closed));
  report.fit = std::move(fit.report);
  return {std::move(fit.psi), std::move(report), std::move(notices)};
}

}  // namespace

LevelSetFit fit_level_set(OrientedPointCloud& cloud, NeighbourDistances near, const BodyOptions& options,
                          const Context& context, BandRefiner* bands, const std::optional<ExactSamples>& exact) {
  const Vec3 shift = far_origin_shift(cloud);
  for (Vec3& x : cloud.points) x -= shift;
  LevelSetFit fit = fit_near_origin(cloud, std::move(near), options, context, bands, exact);
  for (Vec3& x : cloud.points) x += shift;
  fit.report.shift = shift;
  return fit;
}

}  // namespace umtet
