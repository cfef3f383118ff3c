#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/vec3.h"
#include "mesh/regions/detail/label_band.h"
#include "mesh/regions/detail/vertex_places.h"
#include "mesh/regions/region_labels.h"

namespace umtet::detail {

/// The cost of the labels of a band (choose_labels()), as a sum over its vertices, and its change with one label.
class LabelCosts {
 public:
  /// @param band  its labels change with set(); must outlive this, as the others
  LabelCosts(const RegionDomain& domain, LabelBand& band, const RegionLabelParams& params);

  const LabelBand& band() const { return band_; }
  std::size_t size() const { return band_.size(); }
  /// M(v).
  RegionSet regions(int v) const { return regions_[v]; }
  double cost(int v) const { return cost_[v]; }
  /// Whether the regions around an interface vertex lie as at a smooth sheet, curve or corner.
  bool is_valid(int v) const;

  /// The labels of the neighbours, without the own one.
  RegionSet other_labels(int v) const;
  /// Whether {label >= k} keeps its topology for each k, if v gets another label.
  bool is_simple(int v, std::uint8_t label) const;
  /// Sets a label, and what follows from it. @return the change of the sum of costs
  double set(int v, std::uint8_t label);
  /// The vertices with another M(v) since the last set().
  const std::vector<int>& changed() const { return changed_; }

 private:
  RegionSet regions_at(int code) const;
  RegionSet regions_around(int v) const;
  double cost_of(int v);
  double cost_of_tets(int v);
  Vec3 place(int v);

  LabelBand& band_;
  const RegionLabelParams& params_;
  VertexPlaces places_;
  std::vector<RegionSet> regions_;
  std::vector<double> cost_;
  std::vector<int> changed_;
  std::vector<std::uint64_t> seen_;  ///< the last set() that has measured each vertex
  std::uint64_t stamp_ = 0;
};

}  // namespace umtet::detail
