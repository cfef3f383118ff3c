#include "body/sizing/too_thin.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>

#include "body/pieces/clusters.h"
#include "body/sizing/sheets.h"
#include "common/formatted.h"
#include "mesh/implicit/thickness.h"

namespace umtet {
namespace {

// psi is followed in steps of this many edges, to a little beyond kLeastEdgesAcross.
constexpr double kSheetStep = .125, kSheetReach = kLeastEdgesAcross + 2 * kSheetStep;
// Places listed in an error.
constexpr std::size_t kListed = 5;

/// Points of the boundary with the area each stands for.
struct Samples {
  std::vector<Vec3> points;
  std::vector<double> area, thickness;
};

Samples samples_of(const ZeroSetChoice& pieces) {
  Samples s;
  for (const std::size_t c : pieces.kept) {
    const auto points = pieces.topology.points_of(pieces.topology.components[c]);
    const auto areas = pieces.topology.areas_of(pieces.topology.components[c]);
    s.points.insert(s.points.end(), points.begin(), points.end());
    s.area.insert(s.area.end(), areas.begin(), areas.end());
  }
  return s;
}

/// The largest h at which less than kLeastThinArea h^2 is thinner than kLeastEdgesAcross h.
double needed(std::vector<std::pair<double, double>> thickness_and_area) {
  std::sort(thickness_and_area.begin(), thickness_and_area.end());
  double area = 0, h = 0;
  for (const auto& [t, a] : thickness_and_area) {
    h = t / kLeastEdgesAcross;
    area += a;
    if (area >= kLeastThinArea * h * h) return h;
  }
  return h;
}

/// The thin points of one kind, set by set, appended to the result where a set is large enough.
void collect(const Domain& domain, const Samples& samples, bool is_gap, const Context& context, ThinPlaces& result) {
  const double h = result.h;
  Samples thin;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    if (samples.thickness[i] >= kLeastEdgesAcross * h) continue;
    thin.points.push_back(samples.points[i]);
    thin.area.push_back(samples.area[i]);
    thin.thickness.push_back(samples.thickness[i]);
  }
  if (thin.points.empty()) return;
  // Detail that is cut away at this h is there again at a smaller one.
  std::vector<double> with_detail = thin.thickness;
  if (domain.fitted) {
    const auto d = sheet_distances(domain.fitted->whole(), thin.points, kSheetStep * h, kSheetReach * h, context,
                                   domain.steepest());
    for (std::size_t i = 0; i < d.size(); ++i) {
      with_detail[i] = std::min(with_detail[i], is_gap ? d[i].gap : d[i].body);
    }
  }
  for (const std::vector<int>& members : members_of(clusters(thin.points, h / 2))) {
    ThinPlace place;
    place.is_gap = is_gap;
    place.thickness = kSheetReach * h;
    std::vector<std::pair<double, double>> spectrum;
    for (const int i : members) {
      place.area += thin.area[i];
      place.box.extend(thin.points[i]);
      place.centre += thin.points[i];
      place.thickness = std::min(place.thickness, thin.thickness[i]);
      spectrum.push_back({with_detail[i], thin.area[i]});
    }
    if (place.area < kLeastThinArea * h * h) continue;
    place.centre /= static_cast<double>(members.size());
    place.h_needed = needed(std::move(spectrum));
    for (const int i : members) {
      result.points.push_back(thin.points[i]);
      result.thickness.push_back(thin.thickness[i]);
      result.place.push_back(static_cast<int>(result.places.size()));
    }
    result.places.push_back(place);
  }
}

void sort_worst_first(ThinPlaces& result) {
  std::vector<int> order(result.places.size()), rank(order.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return result.places[a].h_needed < result.places[b].h_needed; });
  std::vector<ThinPlace> places;
  for (std::size_t k = 0; k < order.size(); ++k) {
    rank[order[k]] = static_cast<int>(k);
    places.push_back(result.places[order[k]]);
  }
  result.places = std::move(places);
  for (int& p : result.place) p = rank[p];
}

}  // namespace

ThinPlaces find_thin_places(const Domain& domain, const ZeroSetChoice& pieces, double h, const Context& context) {
  ThinPlaces result;
  result.h = h;
  Samples samples = samples_of(pieces);
  const std::vector<double> scale(samples.points.size(), h);
  const std::vector<SheetDistances> distances =
      body_sheets(domain, samples.points, scale, kSheetStep, kSheetReach, context);
  samples.thickness.resize(distances.size());
  for (const bool is_gap : {false, true}) {
    std::transform(distances.begin(), distances.end(), samples.thickness.begin(),
                   [&](const SheetDistances& d) { return is_gap ? d.gap : d.body; });
    collect(domain, samples, is_gap, context, result);
  }
  sort_worst_first(result);
  return result;
}

std::vector<ThinPlace> in_model(const ThinPlaces& thin, const Vec3& shift) {
  std::vector<ThinPlace> places = thin.places;
  for (ThinPlace& p : places) {
    p.centre += shift;
    p.box = {p.box.min() + shift, p.box.max() + shift};
  }
  return places;
}

std::string described(const ThinPlaces& thin, const Vec3& shift) {
  std::string out;
  for (std::size_t k = 0; k < std::min(kListed, thin.places.size()); ++k) {
    const ThinPlace& p = thin.places[k];
    const Vec3 at = p.centre + shift, size = p.box.sizes();
    out += formatted("%s  %s down to %.3g thick around (%.6g, %.6g, %.6g), %.2g x %.2g x %.2g wide: needs h = %.3g",
                     k > 0 ? "\n" : "", p.is_gap ? "gap" : "body", p.thickness, at.x(), at.y(), at.z(), size.x(),
                     size.y(), size.z(), p.h_needed);
  }
  if (thin.places.size() > kListed) out += formatted("\n  and %zu more", thin.places.size() - kListed);
  return out;
}

}  // namespace umtet
