#include "mesh/sizes/size_field.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "common/formatted.h"

namespace umtet {
namespace {

// Sources that change the field by less than this share of it are left out: a mesh meets sizes to a factor of two.
constexpr double kTolerance = .05;

bool is_usable(const SizeSource& s) {
  return s.x.allFinite() && s.h > 0 && std::isfinite(s.h) && s.radius >= 0 && std::isfinite(s.radius);
}

void check(const std::vector<SizeSource>& sources, const SizeFieldParams& params) {
  std::vector<std::string> all = problems(params);
  const auto bad = std::find_if_not(sources.begin(), sources.end(), is_usable);
  if (bad != sources.end()) {
    all.push_back(formatted("source %td: h = %g, radius %g at (%g, %g, %g)", bad - sources.begin(), bad->h, bad->radius,
                            bad->x.x(), bad->x.y(), bad->x.z()));
  }
  if (!all.empty()) throw std::invalid_argument(joined(all, "; "));
}

}  // namespace

std::vector<std::string> problems(const SizeFieldParams& p) {
  std::vector<std::string> list;
  if (!(p.grade > 0) || !std::isfinite(p.grade)) list.push_back(formatted("grade = %g: must be > 0", p.grade));
  if (!(p.h_min > 0) || !std::isfinite(p.h_min)) list.push_back(formatted("h_min = %g: must be > 0", p.h_min));
  if (!(p.h_max >= p.h_min)) list.push_back(formatted("h_max = %g: must not be below h_min = %g", p.h_max, p.h_min));
  return list;
}

SizeField::SizeField(std::vector<SizeSource> sources, const SizeFieldParams& params, std::optional<SizeFunction> f,
                     const Context& context)
    : params_(params), f_(std::move(f)) {
  check(sources, params);
  if (f_) {
    const std::vector<SizeSource> ends = steep_ends(*f_, params.grade, params.h_min, params.h_max, context);
    sources.insert(sources.end(), ends.begin(), ends.end());
  }
  std::erase_if(sources, [&](const SizeSource& s) { return s.h >= params.h_max; });  // they change nothing
  for (SizeSource& s : sources) s.h = std::max(s.h, params.h_min);
  tree_ = SourceTree(undominated(thinned(std::move(sources), params.grade, kTolerance), params.grade, context),
                     params.grade);
}

double SizeField::of_function(const Vec3& x) const {
  const double h = f_->h(x);
  return std::isnan(h) ? params_.h_max : std::clamp(h, params_.h_min, params_.h_max);
}

SizeField SizeField::refined(std::vector<SizeSource> more) const {
  check(more, params_);
  SizeField field = *this;
  for (const SizeSource& s : more) field.least_of_more_ = std::min(field.least_of_more_, s.h);
  const std::vector<SizeSource>& before = more_.sources();
  more.insert(more.end(), before.begin(), before.end());
  field.more_ = SourceTree(std::move(more), params_.grade);
  return field;
}

double SizeField::at(const Vec3& x) const {
  const double most = tree_.at(x, params_.h_min, f_ ? of_function(x) : params_.h_max);
  return more_.sources().empty() ? most : more_.at(x, least_of_more_, most);
}

double SizeField::least_in(const Vec3& centre, double half_width) const {
  double most = params_.h_max;
  if (f_) {
    most = of_function(centre);
    for (int k = 0; k < 8; ++k) {
      const Vec3 corner((k & 1) ? 1 : -1, (k & 2) ? 1 : -1, (k & 4) ? 1 : -1);
      most = std::min(most, of_function(centre + half_width * corner));
    }
  }
  most = tree_.least_in(centre, half_width, params_.h_min, most);
  return more_.sources().empty() ? most : more_.least_in(centre, half_width, least_of_more_, most);
}

}  // namespace umtet
