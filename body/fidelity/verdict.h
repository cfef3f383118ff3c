#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "body/fidelity/mesh_measures.h"
#include "body/options.h"

namespace umtet {

/// The second of the three judgements: the mesh is psi = 0 as far as h can show it, on it, not folded, nothing lost, of
/// its topology. Small places do not count.
bool fits_psi(const MeshMeasures& measured);
/// Whether something else than psi was given: samples, triangles or labels.
bool has_input(const MeshMeasures& measured);

/// What a mesh is held against, and what came of it.
struct Verdict {
  std::optional<double> min_quality_gate;  ///< the least mean ratio that passes, if the user set one
  double volume_gap_gate = kMostGap;       ///< the largest gap_over_volume that passes
  bool strict = false;                     ///< a named defect fails, too
  std::string accept;                      ///< the kinds of defects that pass, as the user gave them
  bool is_valid = true;                    ///< first judgement: proved
  bool fits_psi = true;                    ///< second: fits_psi()
  bool fits_input = true;                  ///< third: input_judgement.h
  std::vector<std::string> accepted;       ///< what passes because of `accept`
  std::vector<std::string> defects;        ///< what is small, and passes
  std::size_t n_defects = 0;               ///< how many places and numbers these are
  std::vector<std::string> reasons;        ///< why it fails

  bool passes() const { return reasons.empty(); }
  /// "pass", "pass with N defects named" or "fail".
  std::string word() const;
};

/// The three judgements. It fails by the reasons of what was measured, by places and differences from the input that
/// are neither small nor accepted, and by a broken gate. \throw UsageError  `accept` names no kind
Verdict judge(const MeshMeasures& measured, const VerdictOptions& options);
/// The first two judgements: whether the mesh is what h can show of psi. @param accept  as VerdictOptions has it
Verdict judge_shape(const MeshMeasures& measured, bool strict = false, const std::string& accept = "");

}  // namespace umtet
