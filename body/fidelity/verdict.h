#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "body/fidelity/mesh_measures.h"
#include "body/options.h"

namespace umtet {

/// The second of the three judgements. The mesh fits psi if its boundary is on psi = 0 without folds, loses no part
/// that h resolves, and has the topology of psi = 0. Small defects do not count.
bool fits_psi(const MeshMeasures& measured);
/// Returns whether the input contains more than psi: samples, triangles or labels.
bool has_input(const MeshMeasures& measured);

/// The requirements on a mesh, and the three judgements.
struct Verdict {
  std::optional<double> min_quality_gate;  ///< the least mean ratio that passes, if the user set one
  double volume_gap_gate = kMostGap;       ///< the largest gap_over_volume that passes
  bool strict = false;                     ///< a named defect fails, too
  std::string accept;                      ///< the kinds of defects that pass, as the user gave them
  bool is_valid = true;                    ///< first judgement: proved
  bool fits_psi = true;                    ///< second: fits_psi()
  bool fits_input = true;                  ///< third: input_judgement.h
  std::vector<std::string> accepted;       ///< defects that pass because of `accept`
  std::vector<std::string> defects;        ///< small defects, which pass
  std::size_t n_defects = 0;               ///< number of these defects
  std::vector<std::string> reasons;        ///< reasons why the mesh fails

  bool passes() const { return reasons.empty(); }
  /// "pass", "pass with N defects named" or "fail".
  std::string word() const;
};

/// Makes the three judgements. A mesh fails for the reasons in its measurements, for defects that are neither small nor
/// accepted, and for a value outside a limit that the user set. \throw UsageError  `accept` names no kind
Verdict judge(const MeshMeasures& measured, const VerdictOptions& options);
/// Makes the first two judgements: whether the mesh is valid and fits psi.
/// @param accept  as in VerdictOptions
Verdict judge_shape(const MeshMeasures& measured, bool strict = false, const std::string& accept = "");

}  // namespace umtet
