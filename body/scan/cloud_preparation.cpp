#include "body/scan/cloud_preparation.h"

#include <algorithm>
#include <utility>

#include "body/option_names.h"
#include "common/formatted.h"
#include "reconstruct/cloud/cleaning/cleaning.h"
#include "reconstruct/cloud/cleaning/covering.h"
#include "reconstruct/cloud/cloud_arrays.h"
#include "reconstruct/cloud/neighbours/morton_order.h"
#include "reconstruct/cloud/normals/lines_of_sight.h"
#include "reconstruct/cloud/normals/normal_estimation.h"
#include "reconstruct/cloud/normals/normal_orientation.h"
#include "reconstruct/cloud/normals/scanner_positions.h"
#include "reconstruct/cloud/survey/cloud_survey.h"
#include "reconstruct/solve/held_out.h"
#include "reconstruct/winding/orient_by_winding.h"
#include "reconstruct/winding/winding_outliers.h"

namespace umtet {
namespace {

// Share of neighbours whose signs agree in a cloud whose normals are right but for noise.
constexpr double kConsistent = .97;
// Share of normals that may look away from what is taken for their scanners: a direction that is the same everywhere,
// or none, has half of them.
constexpr double kMostAway = .25;
constexpr std::size_t kFewestPoints = kFewestSurveyed;  // the fit needs an estimate of the noise

class Preparation {
 public:
  Preparation(CloudFile&& file, const std::string& name, const BodyOptions& options)
      : name_(name), options_(options), file_(file.report), cloud_(std::move(file.cloud)) {}
  PreparedCloud operator()();

 private:
  void tell_fields();
  void mark(const Vec3& x, SampleMark how) { result_.marked.push_back({x + shift_, how}); }
  void mark_turned(const std::vector<Vec3>& as_given);
  void mark_doubtful();
  void clean_points();
  void find_normals();
  void fill_missing();
  void part_with_lines_of_sight();
  template <class Goes>
  std::size_t drop_if(SampleMark why, Goes&& goes);
  void drop_off_surface();
  void drop_undefined();
  void orient_as_told();
  void take(const OrientationReport& r);
  void say_doubt();
  void look_to_origins();
  bool explains_better(const SplitCloud& former, const SplitCloud& proposed, bool is_certain);
  void ask_winding_number(const std::vector<Vec3>* as_given);
  void notice(std::string fact, std::vector<Remedy> remedies = {}) {
    result_.report.notices.emplace_back(std::move(fact), std::move(remedies));
  }
  NormalsReport& normals() { return result_.report.normals; }
  double percent(std::size_t n) const {
    return 100. * static_cast<double>(n) / static_cast<double>(cloud_.points.size());
  }

  const std::string& name_;
  const BodyOptions& options_;
  const CloudFileReport file_;
  OrientedPointCloud cloud_;
  Neighbourhoods near_;              ///< of the cleaned cloud
  Covering covering_;                ///< of it
  Vec3 shift_ = Vec3::Zero();        ///< model coordinates minus those of cloud_
  bool is_closed_ = false;           ///< as the winding number has it
  bool sights_are_guessed_ = false;  ///< the origins are what the file has as normals
  PreparedCloud result_;
};

void Preparation::tell_fields() {
  result_.report.columns = file_.columns;
  if (!file_.columns.empty()) {
    notice(file_.columns, file_.columns_are_guessed ? std::vector<Remedy>{{Change::Use, option::columns, "overrules"}}
                                                    : std::vector<Remedy>());
  }
  result_.report.fields = field_names(cloud_);
  if (!result_.report.fields.empty())
    notice(formatted("the mesh gets what the samples carry: %s", joined(result_.report.fields, ", ").c_str()));
  if (const std::string left_out = fields_left_out(file_); !left_out.empty()) notice(left_out);
}

void Preparation::clean_points() {
  CleaningParams params;
  params.outliers = !options_.scan.keep_all && !file_.of_triangles;
  const CleaningReport r = clean(cloud_, params, &near_, &covering_);
  for (const Vec3& x : r.outliers) mark(x, SampleMark::Outlier);
  for (const Vec3& x : r.small_components) mark(x, SampleMark::SmallComponent);
  const std::size_t n_not_finite = file_.n_points_dropped + r.n_not_finite;
  result_.report.dropped = {.not_finite = n_not_finite,
                            .duplicates = r.n_duplicates,
                            .outliers = r.n_outliers,
                            .small_components = r.n_small_components};
  if (n_not_finite > 0) notice(formatted("dropped %zu points that are no numbers", n_not_finite));
  if (r.n_duplicates > 0) notice(formatted("dropped %zu duplicates", r.n_duplicates));
  if (r.n_outliers + r.n_small_components > 0) {
    notice(formatted("dropped %zu outliers and %zu points in %zu small pieces far from the rest", r.n_outliers,
                     r.n_small_components, r.n_small_component_pieces),
           {{Change::Use, option::keep_all, "keeps them"}});
  }
  if (cloud_.points.size() < kFewestPoints) {
    throw CloudRefused(formatted("%s: %zu points are left after cleaning, %zu are needed", name_.c_str(),
                                 cloud_.points.size(), kFewestPoints),
                       {{Change::Use, option::keep_all, "keeps outliers"}});
  }
}

void Preparation::take(const OrientationReport& r) {
  normals().consistency = r.consistency;
  normals().orientation = r;
}

void Preparation::say_doubt() {
  const std::size_t n_doubtful = normals().orientation->n_doubtful;
  if (n_doubtful > 0) {
    notice(formatted("which side is outside is a guess for %.1f %% of the points", percent(n_doubtful)),
           {{Change::Use, option::flip, "turns them over"}, {Change::Use, option::viewpoints, "decides"}});
  }
}

void Preparation::mark_turned(const std::vector<Vec3>& as_given) {
  for (std::size_t i = 0; i < as_given.size(); ++i)
    if (as_given[i].dot(cloud_.normals[i]) < 0) mark(cloud_.points[i], SampleMark::Turned);
}

void Preparation::mark_doubtful() {
  OrientationReport& r = *normals().orientation;
  if (r.n_doubtful > 0) {
    for (std::size_t i = 0; i < r.is_doubtful.size(); ++i)
      if (r.is_doubtful[i] != 0) mark(cloud_.points[i], SampleMark::Doubtful);
  }
  r.is_doubtful = {};
}

/// Given normals that are no normals get the estimated ones of their places.
void Preparation::fill_missing() {
  std::size_t missing = 0;
  for (const Vec3& n : cloud_.normals) missing += n.isZero(0);
  normals().missing = missing;
  if (missing == 0) return;
  const EstimatedNormals estimated = estimate_normals(cloud_.points, {}, &covering_);
  for (std::size_t i = 0; i < cloud_.normals.size(); ++i) {
    if (cloud_.normals[i].isZero(0)) cloud_.normals[i] = estimated.normals[i];
  }
  notice(formatted("estimated %zu normals that were missing", missing));
}

/// What was given as normals may say where the scanners stood; it does not say how the surface lies.
void Preparation::part_with_lines_of_sight() {
  if (cloud_.normals.empty() || file_.of_triangles || options_.scan.normals != NormalsOf::Auto) return;
  if (!are_lines_of_sight(cloud_, near_, covering_)) return;
  notice("the normals of the file are none: they do not stand on the surface of its points",
         {{Change::Use, {option::normals, "given"}, "keeps them"}});
  if (cloud_.origins.empty()) {
    cloud_.origins = cloud_.points;
    for (std::size_t i = 0; i < cloud_.points.size(); ++i) cloud_.origins[i] += cloud_.normals[i];
    sights_are_guessed_ = true;
  }
  cloud_.normals.clear();
}

void Preparation::find_normals() {
  part_with_lines_of_sight();
  const NormalsOf how = options_.scan.normals;
  if (!cloud_.normals.empty() && how != NormalsOf::Estimate) {
    normals().given = true;
    fill_missing();
    if (how == NormalsOf::Given || file_.of_triangles) {
      normals().consistency = consistency(cloud_, {}, &near_, &covering_);
      return;
    }
    const std::vector<Vec3> as_given = cloud_.normals;
    const OrientationReport r = repair_normals(cloud_, {}, &near_, &covering_);
    take(r);
    say_doubt();
    if (r.n_turned > 0) {
      notice(formatted("turned %zu of the given normals (%.1f %%): they were %.1f %% consistent, now %.1f %%",
                       r.n_turned, percent(r.n_turned), 100 * r.consistency, 100 * r.consistency_after),
             {{Change::Use, {option::normals, "given"}, "keeps them"}});
      ask_winding_number(&as_given);
      mark_turned(as_given);
    }
    mark_doubtful();
    return;
  }
  EstimatedNormals estimated = estimate_normals(cloud_.points, {}, &covering_);
  cloud_.normals = std::move(estimated.normals);
  const OrientationReport r = orient_normals(cloud_, {}, &near_, &covering_);
  take(r);
  notice(formatted("estimated the normals and oriented them: %.1f %% consistent, %zu piece%s",
                   100 * r.consistency_after, r.n_components, r.n_components == 1 ? "" : "s"));
  if (!options_.viewpoints) {
    ask_winding_number(nullptr);
    look_to_origins();
  }
  say_doubt();
  mark_doubtful();
}

/// Fits to the known samples of both, and what they say of the held-out ones. A fit that cannot be made explains
/// nothing. Normals of which the winding number is not certain are not fitted unless the former bound no body.
bool Preparation::explains_better(const SplitCloud& former, const SplitCloud& proposed, bool is_certain) {
  WindingCheckReport& w = *normals().winding;
  const double noise = noise_along_normals(cloud_.points);
  const auto residual = [&](const SplitCloud& cloud) -> std::optional<HeldOutResidual> {
    try {
      return held_out_residual(cloud.known, cloud.held_out, noise);
    } catch (const SolveError&) {
    } catch (const std::invalid_argument&) {
    }
    return std::nullopt;
  };
  w.held_out_before = residual(former);
  if (!is_certain && w.held_out_before && w.held_out_before->bounds_a_body) return false;
  w.held_out_tried = residual(proposed);
  if (!w.held_out_tried || !(is_certain || w.held_out_tried->bounds_a_body)) return false;
  return !w.held_out_before || w.held_out_tried->energy() < w.held_out_before->energy();
}

/// Neighbours err where two sheets are nearer to each other than to the next sample, and one error turns a whole part:
/// the winding number sees all samples at once. Given normals that were consistent are not asked about; those that are
/// now are not overruled: noise and missing parts are no reason to.
void Preparation::ask_winding_number(const std::vector<Vec3>* as_given) {
  if (options_.scan.winding == WindingCheck::Off) return;
  normals().winding.emplace();
  const bool are_consistent = normals().given && normals().orientation->consistency_after >= kConsistent;
  const WindingReport r =
      orient_by_winding(cloud_, {.directions_may_change = !normals().given,
                                 .others = as_given,
                                 .only_others = are_consistent,
                                 .near = &near_,
                                 .covering = &covering_,
                                 .explains_better = [this](const SplitCloud& a, const SplitCloud& b, bool is_certain) {
                                   return explains_better(a, b, is_certain);
                                 }});
  is_closed_ = r.is_closed();
  WindingCheckReport& w = *normals().winding;
  w.verdict = r.verdict;
  w.off_before = r.off_before;
  w.off_after = r.off_after;
  w.off_tried = r.off_tried;
  w.consistency_before = r.consistency_before;
  w.consistency_tried = r.consistency_tried;
  w.restored = r.restored;
  if (r.restored) {
    normals().orientation->n_turned = 0;
    normals().orientation->consistency_after = normals().consistency;
    notice("turned them back: the winding number of all samples is for the normals as given");
  }
  if (r.verdict != WindingReport::Verdict::Taken) return;
  if (is_closed_) normals().orientation->n_doubtful = 0;
  normals().turned_by_winding = r.n_turned;
  normals().replaced_by_winding = r.n_replaced;
  normals().orientation->consistency_after = consistency(cloud_, {}, &near_, &covering_);
  notice(formatted(
      "the winding number decided which side is outside: turned %zu normals (%.1f %%), took %zu directions from it",
      r.n_turned, percent(r.n_turned), r.n_replaced));
}

/// Lines of sight that are guessed to be such do not overrule the winding number, which gives directions and sides.
void Preparation::look_to_origins() {
  if (cloud_.origins.empty()) return;
  if (sights_are_guessed_) {
    const double away = share_looking_away(cloud_);
    if (normals().replaced_by_winding || std::min(away, 1 - away) > kMostAway) return;
  }
  normals().turned_to_viewpoints = orient_to_origins(cloud_);
  normals().orientation->n_doubtful = 0;
  notice(formatted("the normals look to the scanner that saw each point, by the %s of the file",
                   sights_are_guessed_ ? "normals" : "columns"),
         {{Change::Use, option::viewpoints, "decides"}});
}

/// @return how many
template <class Goes>
std::size_t Preparation::drop_if(SampleMark why, Goes&& goes) {
  std::vector<std::uint32_t> kept;
  const std::size_t n = cloud_.points.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (!goes(i)) {
      kept.push_back(static_cast<std::uint32_t>(i));
    } else {
      mark(cloud_.points[i], why);
    }
  }
  keep_samples(cloud_, kept);
  return n - kept.size();
}

/// Outliers that only normals show. On scan lines nearest neighbours say nothing.
void Preparation::drop_off_surface() {
  if (options_.scan.keep_all || file_.of_triangles || !covering_.is_even()) return;
  const std::vector<std::uint8_t> is_outlier = winding_outliers(cloud_, near_);
  const std::size_t n = drop_if(SampleMark::Outlier, [&](std::size_t i) { return is_outlier[i] != 0; });
  result_.report.dropped.outliers += n;
  if (n > 0) {
    notice(formatted("dropped %zu more outliers, inside or outside of what the samples enclose", n),
           {{Change::Use, option::keep_all, "keeps them"}});
  }
}

/// A point whose neighbours all lie at one place, or on a line, has no normal.
void Preparation::drop_undefined() {
  const std::size_t n = cloud_.points.size();
  drop_if(SampleMark::NoNormal, [&](std::size_t i) { return cloud_.normals[i].isZero(0); });
  const std::size_t kept = cloud_.points.size();
  if (kept < n) notice(formatted("dropped %zu points whose normal cannot be told", n - kept));
  if (kept < kFewestPoints) {
    throw CloudRefused(
        formatted("%s: no surface: the normals of %zu of %zu points cannot be told", name_.c_str(), n - kept, n));
  }
}

void Preparation::orient_as_told() {
  if (options_.viewpoints) normals().turned_to_viewpoints = orient_from(cloud_, options_.viewpoints());
  // One scanner does not see a body from all sides: a position with such a cloud is what is left of one of its scans.
  if (file_.viewpoint && !normals().given && !is_closed_ && !options_.viewpoints) {
    const Vec3& v = *file_.viewpoint;
    normals().turned_to_viewpoints = orient_from(cloud_, {v});
    notice(formatted("the normals look to the scanner at %.6g %.6g %.6g, the VIEWPOINT of the file", v[0], v[1], v[2]),
           {{Change::Use, option::viewpoints, "decides"}});
  }
  if (options_.scan.flip) flip(cloud_);
}

PreparedCloud Preparation::operator()() {
  CloudReport& report = result_.report;
  report.format = file_.format;
  report.n_points_in_file = file_.n_points + file_.n_points_dropped;
  report.n_normals_rescaled = file_.n_normals_rescaled;
  tell_fields();
  sort_in_space(cloud_);
  shift_ = far_origin_shift(cloud_);  // squares of far coordinates would lose the surface
  for (Vec3& x : cloud_.points) x -= shift_;
  for (Vec3& x : cloud_.origins) x -= shift_;
  clean_points();
  find_normals();
  drop_off_surface();
  drop_undefined();
  // Differences of coordinates have the same bits with and without the shift: so do distances.
  if (near_.size() == cloud_.points.size())
    result_.near = neighbour_distances(cloud_.points, near_, covering_, cloud_.counts);
  for (Vec3& x : cloud_.points) x += shift_;
  for (Vec3& x : cloud_.origins) x += shift_;
  orient_as_told();
  report.n_points = cloud_.points.size();
  for (const Vec3& x : cloud_.points) report.box.extend(x);
  result_.cloud = std::move(cloud_);
  return std::move(result_);
}

}  // namespace

std::string fields_left_out(const CloudFileReport& file) {
  constexpr std::size_t kListed = 8;
  const std::vector<std::string>& names = file.fields_left_out;
  if (names.empty()) return {};
  const std::vector<std::string> listed(names.begin(), names.begin() + std::min(names.size(), kListed));
  return formatted("left out %zu field%s (%s%s): %zu are kept, and one of each name", names.size(),
                   names.size() == 1 ? "" : "s", joined(listed, ", ").c_str(), names.size() > kListed ? " ..." : "",
                   kMostFields);
}

PreparedCloud prepare_cloud(CloudFile file, const std::string& name, const BodyOptions& options) {
  return Preparation(std::move(file), name, options)();
}

}  // namespace umtet
