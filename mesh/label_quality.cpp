#include "mesh/label_quality.h"

#include <algorithm>
#include <array>

#include "mesh/a15_label_qualities.h"

namespace umtet {
namespace {

// Above every quality in the table, so that all labellings have a price and good ones are told from better ones. On 45
// bodies of labels_fit (seeds not of the fit, 40k tets each) smoothing leaves 461 tets below .82 with .88 here, 43 with
// .92, 14 with .93, 1 with .95 and 569 with 1; .95 costs bodies as thin as the mesh resolves, which .93 does not.
constexpr float kGood = .93F;
constexpr float kScale = 1e4F;  // .1 below kGood is 100: the unit of all prices
// A labelling that the fit never met, or met too seldom to say.
constexpr float kUnknown = 100;
// Worse than all the rings a flip can spoil.
constexpr float kNotManifold = 1000;

}  // namespace

LabelEnergies label_energies(const std::vector<LinkTopology>& links, std::span<const LabelQuality> qualities) {
  LabelEnergies energies;
  for (const LinkTopology& link : links) {
    std::array<std::array<float, 64>, 32> price;  // [bv][nt]: a link of 16 vertices has 28 triangles
    for (auto& row : price) row.fill(kUnknown);
    for (const LabelQuality& q : qualities) {
      if (q.site != link.site) continue;
      const float lack = std::max(0.F, kGood - static_cast<float>(q.quality));
      price[q.n_positive_faces][q.n_tets] = std::min(kUnknown, kScale * lack * lack);
    }
    auto& of_mask = energies.emplace_back(link.states.size());
    for (std::size_t m = 1; m < of_mask.size(); ++m) {
      const LinkState& s = link.states[m];
      of_mask[m] = s.manifold ? price[s.n_positive_faces][s.n_tets] : kNotManifold;
    }
  }
  return energies;
}

std::span<const LabelQuality> a15_label_qualities() { return kA15LabelQualities; }

const LabelEnergies& a15_label_energies() {
  static const LabelEnergies energies = label_energies(a15_links(), a15_label_qualities());
  return energies;
}

}  // namespace umtet
