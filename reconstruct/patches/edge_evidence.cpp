#include "reconstruct/patches/edge_evidence.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/disjoint_sets.h"
#include "reconstruct/cloud/neighbours/local_quadric.h"
#include "reconstruct/patches/measures.h"

namespace umtet {
namespace {

constexpr std::size_t kFew = 16, kMany = 45;
/// Spacings: residuals below it say nothing about noise. A quadric over 45 samples misses a sphere with a radius of 10
/// spacings by as much.
constexpr double kFloor = .01;
constexpr double kBall = 3;            ///< spacings around a site: the samples that judge it
constexpr double kBeside = 1.2;        ///< spacings from an edge: the samples that a fillet of this radius moves
constexpr double kLeastSine = .5;      ///< of the angle of an edge: 30 degrees
constexpr double kMostResidual2 = 16;  ///< four deviations: an outlier of both sheets
constexpr std::size_t kOneSheet = 32;  ///< samples of the single sheet
constexpr double kAlong = 3;           ///< spacings along the border over which evidence is averaged
constexpr double kTogether = 2.5;      ///< spacings between two sites of one network: beyond the second ring
/// Least mean square residual away from borders. Without noise, residuals come from the third order of curved patches:
/// at the holes of the bracket of the tests, with a radius of four spacings, they are larger than elsewhere.
constexpr double kLeastUsual = .5;

/// Variance of the nearest samples of a patch around sample i from a quadric; -1 if there are fewer than `count`.
double variance_around(const PatchCloud& cloud, const std::vector<int>& labels, std::size_t i, std::size_t count) {
  std::array<Neighbour, kMany> members;
  std::size_t n = 0;
  members[n++] = {0, static_cast<std::uint32_t>(i)};
  for (const std::uint32_t j : cloud.near.points(i)) {
    if (n == count) break;
    if (labels[j] == labels[i] && cloud.normals[j].dot(cloud.normals[i]) > 0)
      members[n++] = {squared_distance(cloud.points[i], cloud.points[j]), j};
  }
  if (n < count) return -1;
  return local_quadric(cloud.points, cloud.points[i], std::span(members).first(n)).variance;
}

/// Squared residual of sample k from a sheet, the mean over its components, in standard deviations.
double residual2(const PatchCloud& cloud, const LocalSheet& sheet, const Vec3& x, const Vec3& normal) {
  const double d = sheet.distance(x) / cloud.noise;
  if (!cloud.has_measured_normals()) return std::min(kMostResidual2, d * d);
  const double a = (sheet.normal(x) - normal).norm() / cloud.tilt;
  return std::min(kMostResidual2, (d * d + a * a) / 3);
}

double residual2(const PatchCloud& cloud, const LocalSheet& sheet, std::size_t k) {
  return residual2(cloud, sheet, cloud.points[k], cloud.measured[k]);
}

/// What residual2() from `whole` would be if the sample were exactly on one of its own sheets.
double ideal_residual2(const PatchCloud& cloud, const LocalSheet& own, const LocalSheet& whole, std::size_t k) {
  const Vec3 normal = own.normal(cloud.points[k]);
  return residual2(cloud, whole, cloud.points[k] - own.distance(cloud.points[k]) * normal, normal);
}

/// The mean square residual of each patch, away from its borders, from its own sheets. Patches with few such samples
/// have nearly the mean of all.
std::vector<double> usual_residuals2(const PatchCloud& cloud, const std::vector<int>& labels) {
  constexpr std::size_t kSampled = 20000, kAround = 12;
  constexpr double kPrior = 6;  // samples: a mean over fewer is as uncertain as patches differ
  const std::size_t stride = 1 + cloud.size() / kSampled;
  std::vector<double> found((cloud.size() + stride - 1) / stride, -1);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t k) {
    const std::size_t i = k * stride;
    for (const std::uint32_t j : cloud.nearest(i, kAround))
      if (labels[j] != labels[i]) return;
    if (const auto sheet = sheet_near(cloud, labels, labels[i], i)) found[k] = residual2(cloud, *sheet, i);
  });
  const auto n_patches = static_cast<std::size_t>(1 + *std::max_element(labels.begin(), labels.end()));
  std::vector<double> usual(n_patches), count(n_patches);
  double sum = 0, n = 0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (found[k] < 0) continue;
    const auto label = static_cast<std::size_t>(labels[k * stride]);
    usual[label] += found[k];
    ++count[label];
    sum += found[k];
    ++n;
  }
  const double all = n > 0 ? sum / n : 1;
  for (std::size_t label = 0; label < n_patches; ++label)
    usual[label] = std::max(kLeastUsual, (usual[label] + kPrior * all) / (count[label] + kPrior));
  return usual;
}

/// Evidence of one site: sums over its samples, in place of means.
SiteEvidence sums_at(const PatchCloud& cloud, const std::vector<int>& labels, const std::vector<double>& usual,
                     const BorderSite& site) {
  SiteEvidence found;
  const double usual_a = usual[static_cast<std::size_t>(site.a)], usual_b = usual[static_cast<std::size_t>(site.b)];
  const auto a = sheet_near(cloud, labels, site.a, site.i);
  const auto b = sheet_near(cloud, labels, site.b, site.i);
  if (!a || !b) return found;
  std::array<std::uint32_t, kPatchNeighbours + 1> both;
  std::size_t n = 0;
  both[n++] = site.i;
  for (const std::uint32_t k : cloud.near.points(site.i))
    if (labels[k] == site.a || labels[k] == site.b) both[n++] = k;
  const Vec3 x = cloud.middle(site), on_a = a->normal(x), on_b = b->normal(x);
  const double angle = angle_between(on_a, on_b), width = kBeside * std::max(kLeastSine, std::sin(angle));
  // Sheets that face each other have no plane over which both are graphs: then any plane shows that one is not enough.
  const Vec3 sum = on_a + on_b;
  const LocalSheet whole(cloud.samples(), cloud.points[site.i], sum.norm() > .1 ? sum.normalized() : on_a,
                         std::span(both).first(std::min(n, kOneSheet)));
  for (const std::uint32_t k : std::span(both).first(n)) {
    const Vec3& y = cloud.points[k];
    if ((y - x).norm() > kBall || std::max(std::abs(a->distance(y)), std::abs(b->distance(y))) > width) continue;
    const double from_a = residual2(cloud, *a, k) / usual_a, from_b = residual2(cloud, *b, k) / usual_b;
    const double usual_of_both = std::max(usual_a, usual_b);
    found.two += std::min(from_a, from_b);
    found.one += residual2(cloud, whole, k) / usual_of_both;
    found.ideal += ideal_residual2(cloud, from_a < from_b ? *a : *b, whole, k) / usual_of_both;
    ++found.count;
  }
  found.angle = angle * found.count;
  return found;
}

}  // namespace

PatchMisfit patch_misfit(const PatchCloud& cloud, const std::vector<int>& labels) {
  std::vector<double> few(cloud.size(), -1), many(cloud.size(), -1);
  tbb::parallel_for(std::size_t{0}, cloud.size(), [&](std::size_t i) {
    few[i] = variance_around(cloud, labels, i, kFew);
    many[i] = variance_around(cloud, labels, i, kMany);
  });
  std::vector<double> all, inner, wide;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (few[i] >= 0) all.push_back(few[i]);
    if (many[i] < 0) continue;
    inner.push_back(few[i]);
    wide.push_back(many[i]);
  }
  PatchMisfit misfit;
  if (all.empty()) return misfit;
  misfit.noise = std::sqrt(median(std::move(all)));
  if (inner.empty()) return misfit;
  const double floor2 = kFloor * kFloor;
  misfit.ratio = std::sqrt((median(std::move(wide)) + floor2) / (median(std::move(inner)) + floor2));
  return misfit;
}

std::vector<SiteEvidence> evidence_at(const PatchCloud& cloud, const std::vector<int>& labels,
                                      const std::vector<BorderSite>& sites) {
  std::vector<SiteEvidence> single(sites.size()), result(sites.size());
  if (sites.empty()) return result;
  const std::vector<double> usual = usual_residuals2(cloud, labels);
  tbb::parallel_for(std::size_t{0}, sites.size(),
                    [&](std::size_t k) { single[k] = sums_at(cloud, labels, usual, sites[k]); });
  const SitesInSpace in_space(cloud, sites);
  tbb::parallel_for(std::size_t{0}, sites.size(), [&](std::size_t k) {
    SiteEvidence& mean = result[k];
    for (const std::uint32_t l : in_space.within(k, kAlong)) {
      if (pair_of(sites[l]) != pair_of(sites[k])) continue;
      mean.angle += single[l].angle;
      mean.two += single[l].two;
      mean.one += single[l].one;
      mean.ideal += single[l].ideal;
      mean.count += single[l].count;
    }
    if (mean.count == 0) return;
    mean.angle /= mean.count;
    mean.two /= mean.count;
    mean.one /= mean.count;
    mean.ideal /= mean.count;
  });
  return result;
}

std::vector<char> accepted_sites(const PatchCloud& cloud, const std::vector<BorderSite>& sites,
                                 const std::vector<SiteEvidence>& evidence, const EdgeThresholds& enough) {
  std::vector<char> accepted(sites.size());
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const SiteEvidence& e = evidence[k];
    accepted[k] = e.count > 0 && e.angle > enough.angle && e.two < enough.two && e.one > enough.gain * e.two &&
                  e.one - e.two > enough.share * e.ideal;
  }
  const std::vector<std::size_t> size = network_sizes(cloud, sites, accepted, kTogether);
  for (std::size_t k = 0; k < sites.size(); ++k)
    if (static_cast<double>(size[k]) * kLengthPerSite < enough.length) accepted[k] = 0;
  double turning = 0, sharp = 0;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    turning += evidence[k].count > 0 && evidence[k].angle > enough.angle ? 1 : 0;
    sharp += accepted[k] ? 1 : 0;
  }
  if (sharp < enough.common * turning) accepted.assign(sites.size(), 0);
  return accepted;
}

}  // namespace umtet
