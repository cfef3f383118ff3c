#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "mesh/background/link_topology.h"

namespace umtet {

/// Attainable quality of the tets around a boundary vertex whose link has this configuration; measured, not derived.
struct ConfigurationQuality {
  int site;              ///< LinkTopology::site
  int n_positive_faces;  ///< bv
  int n_tets;            ///< nt
  double quality;        ///< the greatest worst mean ratio of the ring that can be reached
};

/// The cost of a configuration of the link around an outside vertex.
class StarCostTable {
 public:
  /// @param good  the quality that costs nothing, above all in the list: see configuration_costs.cpp
  StarCostTable(const std::vector<LinkTopology>& links, std::span<const ConfigurationQuality> qualities, double good);
  /// Table in which every manifold configuration costs cost(bv, nt), whatever the site.
  StarCostTable(const std::vector<LinkTopology>& links, const std::function<float(int, int)>& cost);

  float operator()(int site, const LinkState& s) const {
    const OfSite& of = of_site_[static_cast<std::size_t>(site)];
    return s.manifold ? of.cost[s.n_positive_faces * of.row + s.n_tets] : not_manifold_;
  }
  /// Sets the cost of every configuration to a value of f(), in unspecified order.
  template <class F>
  void generate(const F& f) {
    for (OfSite& of : of_site_) std::generate(of.cost.begin(), of.cost.end(), f);
    not_manifold_ = f();
  }

 private:
  struct OfSite {
    std::size_t row = 0;      ///< number of triangles of the link plus one
    std::vector<float> cost;  ///< by positive faces, then by tets
  };
  void make_rows(const std::vector<LinkTopology>& links);

  std::vector<OfSite> of_site_;
  float not_manifold_;
};

}  // namespace umtet
