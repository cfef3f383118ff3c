#include "body/scan/scan_reports.h"

#include <algorithm>
#include <array>
#include <utility>

namespace umtet {

InputFacts input_facts(const CloudReport& cloud, const LevelSetReport& level_set) {
  const NormalsReport& normals = cloud.normals;
  const auto n = static_cast<double>(std::max<std::size_t>(1, cloud.n_points));
  InputFacts facts;
  facts.normals_given = normals.given;
  if (normals.orientation) {
    facts.doubtful = static_cast<double>(normals.orientation->n_doubtful) / n;
    facts.consistency = normals.orientation->consistency_after;
  } else {
    facts.consistency = normals.consistency;  // the normals are kept as they are given
  }
  if (normals.winding) facts.off_a_half = normals.winding->off_after;
  // Signs of estimated normals come from the neighbours in the first place: nothing is turned by them.
  const std::size_t by_neighbours = normals.given && normals.orientation ? normals.orientation->n_turned : 0;
  const std::array<std::pair<std::size_t, const char*>, 3> turned = {
      {{by_neighbours, "neighbours"},
       {normals.turned_by_winding.value_or(0), "the winding number"},
       {level_set.fit.n_turned_normals, "psi"}}};
  const auto most =
      std::max_element(turned.begin(), turned.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  facts.turned = static_cast<double>(most->first) / n;
  if (most->first > 0) facts.turned_by = most->second;
  facts.opposed = static_cast<double>(level_set.fit.n_opposed_normals) /
                  static_cast<double>(std::max<std::size_t>(1, level_set.fit.n_points));
  return facts;
}

}  // namespace umtet
