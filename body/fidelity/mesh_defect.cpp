#include "body/fidelity/mesh_place.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace umtet {
namespace {

constexpr std::array<const char*, 7> kWords = {"folded", "off", "filled", "cut", "thin", "topology", "missed"};

bool is_worse(const MeshPlace& a, const MeshPlace& b) {
  return std::tuple(is_small(b), a.off_over_h) > std::tuple(is_small(a), b.off_over_h);
}

}  // namespace

const char* to_string(PlaceKind kind) { return kWords.at(static_cast<std::size_t>(kind)); }

std::optional<PlaceKind> place_kind_of(const std::string& word) {
  const auto* at = std::find(kWords.begin(), kWords.end(), word);
  if (at == kWords.end()) return std::nullopt;
  return static_cast<PlaceKind>(at - kWords.begin());
}

bool is_small(const MeshPlace& place) {
  if (place.off_over_h > kSmallLoss) return false;
  const bool is_finer_than_h = place.feature_over_h && *place.feature_over_h < kLeastEdgesAcross;
  if (is_finer_than_h && (place.kind == PlaceKind::Thin || place.off_over_h <= kSmallOff)) return true;
  return place.kind != PlaceKind::Topology && place.size_over_h <= kSmallSize;
}

std::size_t PlaceReport::n() const {
  std::size_t sum = 0;
  for (const OfKind& k : kinds) sum += k.n;
  return sum;
}

PlaceReport report_on(std::vector<MeshPlace>& places) {
  std::stable_sort(places.begin(), places.end(), is_worse);
  PlaceReport report;
  for (std::size_t k = 0; k < kWords.size(); ++k) {
    PlaceReport::OfKind of_kind{static_cast<PlaceKind>(k), 0, 0, {}, 0};
    for (const MeshPlace& place : places) {
      if (place.kind != of_kind.kind) continue;
      if (of_kind.n == 0) of_kind.worst = place;
      ++of_kind.n;
      of_kind.n_small += is_small(place) ? 1 : 0;
      of_kind.max_off_over_h = std::max(of_kind.max_off_over_h, place.off_over_h);
    }
    if (of_kind.n > 0) report.kinds.push_back(of_kind);
  }
  const auto n_listed = static_cast<std::ptrdiff_t>(std::min(places.size(), kListedPlaces));
  report.listed.assign(places.begin(), places.begin() + n_listed);
  return report;
}

}  // namespace umtet
