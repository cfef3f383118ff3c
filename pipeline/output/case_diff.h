#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "pipeline/case/case_folder.h"
#include "pipeline/case/json_values.h"
#include "pipeline/case/progress.h"

namespace umtet {

/// Of distances or differences, model units.
struct Spread {
  double max = 0;
  double rms = 0;  ///< root of the mean square
};

/// A value of two documents that is not the same in both.
struct ValueDifference {
  std::string at;  ///< JSON pointer
  Json a, b;       ///< null where it is missing
};

/// How a stage of two cases compares.
struct StageDiff {
  Stage stage = Stage::Cloud;
  bool in_a = false, in_b = false;                   ///< the stage is done there
  bool same = false;                                 ///< the same files, or in neither
  std::vector<ValueDifference> parameters, numbers;  ///< of the records; empty unless both are there
  /// By how much the results differ, by name; none where the files are the same:
  ///   cloud       distance of every sample to the next of the other case
  ///   level-set   |psi_a - psi_b| at the samples of A
  ///   mesh        distance of boundary vertices to the other's boundary; numbers of holes if there are any; if the
  ///               tets are the same, moves of the vertices
  using Measure = std::variant<Spread, double, std::size_t, bool>;
  std::optional<std::vector<std::pair<std::string, Measure>>> difference;
};

/// Where two cases part.
struct CaseDiff {
  std::string a, b;  ///< their folders
  std::vector<StageDiff> stages;

  /// The first stage whose files differ.
  std::optional<Stage> first_difference() const;
};

/// \throw UsageError for what is no case; ArtefactDamaged, Interrupted, Cancelled, std::system_error
CaseDiff diff_cases(const CasePaths& a, const CasePaths& b, Progress& progress);

/// What `umtet diff --json` answers.
Json to_json(const CaseDiff& diff);

/// The same for people, some lines a stage.
std::string diff_text(const CaseDiff& diff);

}  // namespace umtet
