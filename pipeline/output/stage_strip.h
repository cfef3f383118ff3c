#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/body.h"
#include "pipeline/case/failure_file.h"
#include "pipeline/case/parameters.h"
#include "pipeline/output/report_scene.h"
#include "pipeline/reports/certificate_report.h"

namespace umtet {

/// The stages of a case as pictures of a report, also of a case that is not finished.
struct StageStrip {
  /// `stages`: a list with, for each, id, name, facts (pairs of texts), seconds, file, command (repeats the stage alone
  /// with another parameter, in a copy of the case), layers (ids of sample layers that are shown at first), and scene
  /// (SceneHead, or null if there is nothing to draw). `layers`: SampleLayer. `blame`: null, or stage, number, remedy.
  /// `shown`: id of the stage that the page shows first.
  Json document;
  /// Arrays of report_scene.h with names that begin with the id of the stage and "_", and of stage_layers.h. Those of
  /// the stage "mesh" are the arrays of the report without a prefix.
  std::vector<std::pair<std::string, std::string>> blocks;
};

struct StripSource {
  const CasePaths& paths;
  const Parameters& parameters;
  const Domain* domain = nullptr;            ///< psi as it is meshed; null if there is no level set yet
  const Certificate* certificate = nullptr;  ///< null if there is no mesh
  std::optional<CaseFailure> failure = std::nullopt;
};

/// Reads the records of the stages and the files omega_h.vtu, projected.vtu and marked.vtp; without a domain also
/// cloud.ply. \throw ArtefactDamaged, Interrupted, std::system_error
StageStrip stage_strip(const StripSource& source);

}  // namespace umtet
