#include "reconstruct/winding/orient_by_winding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "common/formatted.h"
#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/cloud/normals/normal_orientation.h"
#include "reconstruct/cloud/survey/cloud_survey.h"
#include "reconstruct/winding/winding_normals.h"

namespace umtet {
namespace {

using Verdict = WindingReport::Verdict;

// Samples that check, and that decide at first. A cloud that has no more is sparse: its parts are a few samples across,
// and neighbours tell directions worse than the field does.
constexpr std::size_t kChecked = 4000;
// Right normals have fewer of their samples off, with the usual softening or a wider one, or fewer of their patches.
constexpr double kMostOff = 0.02, kWider = 3;
// Where fewer are off, one part can have wrong sides: a thin ear whose normals were estimated. Right clouds have at
// most .0022 of their patches off at the last attempt's samples, one such ear in an armadillo .0065. The proposal must
// then leave a quarter of them.
constexpr double kPartOff = 0.004, kPartLeft = 0.25;
// So have those of a closed surface with thin parts.
constexpr double kClosed = 0.04;
// Others have to be off at this share of that, at most, before given or estimated ones are overruled.
constexpr double kBetter = 0.75;
// Normals that are off at more patches bound nothing: a thin plate that was taken for one sheet is off at all. Their
// consistency says nothing then.
constexpr double kUnbounded = 0.5;
// Nor are normals believed then of which more than one in 40 is turned at random, p of 1 - 2 p (1 - p): those that
// follow noise of a spacing have .91 to .94, right ones of the plate .97 and more.
constexpr double kCoherent = 0.95;
// Cosine of the angle from which on an estimated direction is not believed: that of a fit to both sheets of a thin
// part.
constexpr double kContradiction = 0.7;
// Of a sparse cloud every fifth sample is held out, as in cross-validation: half of them would be another body.
constexpr std::size_t kFold = 5;

// Samples of which the noise is taken: the median of so many is known to 5 %, and patches do not ask for more.
constexpr std::size_t kNoiseSamples = 500;

struct Attempt {
  std::size_t n_samples;
  WindingNormalsParams params;
};
// Clean samples and parts as thin as those of so few are apart; noise, and thinner parts.
constexpr std::array<Attempt, 2> kAttempts = {Attempt{kChecked, {}},
                                              Attempt{16000, {.rounds = 10, .widest = 4, .narrowest = 2}}};

/// Every m-th of them: `most`, or fewer.
std::vector<Vec3> at_most(const std::vector<Vec3>& all, std::size_t most) {
  const std::size_t m = (all.size() + most - 1) / most;
  std::vector<Vec3> some;
  for (std::size_t i = 0; i < all.size(); i += m) some.push_back(all[i]);
  return some;
}

/// Some of the samples of a cloud, for several sets of normals of all of them.
struct Part {
  std::size_t most;
  std::vector<Vec3> points;
  std::vector<double> areas;
  Part(const OrientedPointCloud& cloud, std::size_t n)
      : most(n), points(at_most(cloud.points, n)), areas(sample_areas(points)) {}
  std::vector<Vec3> of(const std::vector<Vec3>& normals) const { return at_most(normals, most); }
  double off(const std::vector<Vec3>& normals, double noise) const {
    return patches_off_a_half(points, of(normals), areas, noise);
  }
};

/// Normals of all samples by the winding number.
struct Proposal {
  std::vector<Vec3> normals;
  const WindingNormalsParams* params = nullptr;
  bool is_certain = false;
  double off = 1, consistency = 0;  ///< patches_off_a_half(), consistency()

  bool is_better_than(const Proposal& other) const {
    return is_certain != other.is_certain ? is_certain : off < other.off;
  }
};

double consistency_of(const OrientedPointCloud& cloud, const std::vector<Vec3>& normals, const OrientByWinding& how) {
  OrientedPointCloud other;
  other.points = cloud.points;
  other.normals = normals;
  return consistency(other, {}, how.near, how.covering);
}

double noise_of(const OrientedPointCloud& cloud) {
  return cloud.points.size() < kFewestSurveyed ? 0 : noise_along_normals(cloud.points, kNoiseSamples);
}

/// Numbers of the samples that are known and held out: few enough of both that two fits take a second.
struct Split {
  std::vector<std::size_t> known, held_out;
  explicit Split(std::size_t n) {
    if (n <= kChecked) {
      for (std::size_t i = 0; i < n; ++i) (i % kFold == kFold / 2 ? held_out : known).push_back(i);
      return;
    }
    const std::size_t m = (n + kChecked - 1) / kChecked;
    for (std::size_t i = 0; i < n; i += m) known.push_back(i);
    for (std::size_t i = m / 2; i < n; i += m) held_out.push_back(i);
  }
};

std::vector<Vec3> picked(const std::vector<Vec3>& all, const std::vector<std::size_t>& numbers) {
  std::vector<Vec3> some;
  some.reserve(numbers.size());
  for (const std::size_t i : numbers) some.push_back(all[i]);
  return some;
}

/// Those of `points` that have both a former and a proposed normal.
void add(const std::vector<Vec3>& points, const std::vector<Vec3>& former, const std::vector<Vec3>& proposed,
         OrientedPointCloud& as_former, OrientedPointCloud& as_proposed) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (former[i].isZero(0) || proposed[i].isZero(0)) continue;
    as_former.points.push_back(points[i]);
    as_former.normals.push_back(former[i]);
    as_proposed.points.push_back(points[i]);
    as_proposed.normals.push_back(proposed[i]);
  }
}

/// The cloud's normals, and those of the proposal where they are on the other side.
std::vector<Vec3> with_sides_of(const Proposal& proposal, const std::vector<Vec3>& normals) {
  std::vector<Vec3> mixed = normals;
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    if (mixed[i].dot(proposal.normals[i]) < 0) mixed[i] = proposal.normals[i];
  }
  return mixed;
}

/// Normals of the known samples alone, at these and at the held-out ones, against those of the cloud. Where a part
/// alone is at stake, all other normals are the same.
bool explain_better(const OrientedPointCloud& cloud, const Proposal& proposal, bool is_of_a_part,
                    const OrientByWinding& how) {
  if (!how.explains_better) return proposal.is_certain;
  const Split split(cloud.points.size());
  const std::vector<Vec3> known = picked(cloud.points, split.known), others = picked(cloud.points, split.held_out);
  if (is_of_a_part) {
    const std::vector<Vec3> mixed = with_sides_of(proposal, cloud.normals);
    SplitCloud former, proposed;
    add(known, picked(cloud.normals, split.known), picked(mixed, split.known), former.known, proposed.known);
    add(others, picked(cloud.normals, split.held_out), picked(mixed, split.held_out), former.held_out,
        proposed.held_out);
    return how.explains_better(former, proposed, proposal.is_certain);
  }
  std::vector<Vec3> places = known;
  places.insert(places.end(), others.begin(), others.end());
  const std::vector<Vec3> found = normals_by_winding(known, sample_areas(known), places, *proposal.params);
  const auto middle = found.begin() + static_cast<std::ptrdiff_t>(known.size());
  SplitCloud former, proposed;
  add(known, picked(cloud.normals, split.known), {found.begin(), middle}, former.known, proposed.known);
  add(others, picked(cloud.normals, split.held_out), {middle, found.end()}, former.held_out, proposed.held_out);
  return how.explains_better(former, proposed, proposal.is_certain);
}

/// @param field  normals of the winding number at all samples
void overrule(OrientedPointCloud& cloud, const std::vector<Vec3>& field, bool directions_may_change,
              WindingReport& report) {
  const bool is_sparse = field.size() <= kChecked;
  for (std::size_t i = 0; i < field.size(); ++i) {
    Vec3& n = cloud.normals[i];
    const double cosine = n.dot(field[i]);
    if (n.isZero(0) || field[i].isZero(0)) continue;
    report.n_turned += cosine < 0 ? 1 : 0;
    if (directions_may_change && (is_sparse || std::abs(cosine) < kContradiction)) {
      n = field[i];
      ++report.n_replaced;
    } else if (cosine < 0) {
      n = -n;
    }
  }
}

}  // namespace

bool WindingReport::is_closed() const { return off_after <= kClosed; }

WindingReport orient_by_winding(OrientedPointCloud& cloud, const OrientByWinding& how) {
  const std::vector<Vec3>* const others = how.others;
  if (others && others->size() != cloud.points.size())
    throw std::invalid_argument(
        formatted("%zu points but %zu other normals: must be equal", cloud.points.size(), others->size()));
  WindingReport report;
  double noise = 0;
  bool is_of_a_part = false;
  const auto is_settled = [&](double off) {
    is_of_a_part = off <= kMostOff && off > kPartOff && how.directions_may_change && cloud.points.size() > kChecked;
    return off <= kMostOff && !is_of_a_part;
  };
  {
    const Part part(cloud, kChecked);
    const std::vector<Vec3> normals = part.of(cloud.normals);
    for (const double softening : {WindingNormalsParams{}.narrowest, kWider}) {
      const double off = off_a_half(part.points, normals, part.areas, softening);
      if (softening < kWider) report.off_before = report.off_after = off;
      if (is_settled(off)) return report;
      if (is_of_a_part) break;
    }
    noise = noise_of(cloud);
    if (!is_of_a_part) {
      report.off_before = report.off_after = part.off(cloud.normals, noise);
      if (is_settled(report.off_before)) return report;
    }
    if (others && !is_of_a_part) {
      const double off = part.off(*others, noise);
      if (off < report.off_before) {
        cloud.normals = *others;
        report.restored = true;
        report.off_after = off;
      }
    }
  }
  if (how.only_others || (report.off_after <= kMostOff && !is_of_a_part)) return report;
  const Part fine(cloud, kAttempts.back().n_samples);  // shows thinner parts than those that were checked
  const double before = fine.off(cloud.normals, noise);
  if (is_of_a_part && before <= kPartOff) return report;
  report.consistency_before = consistency_of(cloud, cloud.normals, how);
  Proposal best;
  const double better = is_of_a_part ? kPartLeft : kBetter;
  for (const Attempt& attempt : kAttempts) {
    if (is_of_a_part && &attempt != &kAttempts.back()) continue;  // the first one does not show such a part
    const Part part(cloud, attempt.n_samples);
    Proposal p;
    p.params = &attempt.params;
    p.normals = normals_by_winding(part.points, part.areas, cloud.points, attempt.params);
    p.off = fine.off(p.normals, noise);
    p.consistency = consistency_of(cloud, p.normals, how);
    p.is_certain = p.off < better * before && (p.consistency >= report.consistency_before ||
                                               (before > kUnbounded && p.off <= kClosed && p.consistency >= kCoherent));
    if (!best.params || p.is_better_than(best)) best = std::move(p);
    if ((best.off <= kMostOff && best.is_certain) || cloud.points.size() <= attempt.n_samples) break;
  }
  report.off_tried = best.off;
  report.consistency_tried = best.consistency;
  report.verdict = Verdict::Uncertain;
  if (!(best.off < better * before)) return report;
  if (!explain_better(cloud, best, is_of_a_part, how)) {
    if (best.is_certain) report.verdict = Verdict::NotBetter;
    return report;
  }
  report.verdict = Verdict::Taken;
  report.off_before = before;
  report.off_after = report.off_tried;
  overrule(cloud, best.normals, how.directions_may_change, report);
  return report;
}

}  // namespace umtet
