#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/background/link_steps.h"
#include "mesh/core/implicit_function.h"
#include "mesh/classification/configuration_costs.h"
#include "mesh/classification/classification.h"
#include "mesh/fast/repair.h"

namespace umtet::detail {

/// The labels that repair() may change, by the rules of choose_labels().
class LabelCandidates {
 public:
  struct Candidate {
    std::int64_t vertex;
    float energy;  ///< by which the flip changes the price of the labels around
  };

  /// Keeps what it is given by reference: `inside` as it is when asked.
  LabelCandidates(const BackgroundMesh& background, const std::vector<LinkTopology>& links, ImplicitFunctionRef psi,
                  const LabelParams& labels, const RepairParams& params, const IdSet& inside)
      : background_(background),
        links_(links),
        psi_(psi),
        labels_(labels),
        params_(params),
        energies_(labels.energies ? *labels.energies : a15_label_energies()),
        inside_(inside),
        steps_(background) {}

  /// Those of a tet's vertices and their neighbours, the most promising first, max_tries at most.
  /// @param n_evaluations  receives the number of values of psi
  std::vector<Candidate> operator()(const std::array<std::int64_t, 4>& tet, std::size_t& n_evaluations) const;

 private:
  bool in_reach(std::int64_t v, std::size_t& n_evaluations) const;

  const BackgroundMesh& background_;
  const std::vector<LinkTopology>& links_;
  ImplicitFunctionRef psi_;
  const LabelParams& labels_;
  const RepairParams& params_;
  const LabelEnergies& energies_;
  const IdSet& inside_;
  LinkSteps steps_;
};

}  // namespace umtet::detail
