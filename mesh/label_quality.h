#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/link_topology.h"

namespace umtet {

/// How well the tets around a boundary vertex can be shaped when its link is labelled so: measured, not derived.
struct LabelQuality {
  int site;              ///< LinkTopology::site
  int n_positive_faces;  ///< bv
  int n_tets;            ///< nt
  double quality;        ///< the worst mean ratio of its ring that can be reached
};

/// Of a15(), measured by tools/labels_fit; see label_quality.cpp for the command.
std::span<const LabelQuality> a15_label_qualities();

/// The price of each labelling of a link around an outside vertex: [type][mask].
using LabelEnergies = std::vector<std::vector<float>>;
LabelEnergies label_energies(const std::vector<LinkTopology>& links, std::span<const LabelQuality> qualities);

/// That of a15() with its qualities, made once.
const LabelEnergies& a15_label_energies();

}  // namespace umtet
