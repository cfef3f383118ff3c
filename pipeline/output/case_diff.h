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

/// Statistics of distances or differences, model units.
struct Spread {
  double max = 0;
  double rms = 0;  ///< root of the mean square
};

/// A value that differs between two documents.
struct ValueDifference {
  std::string at;  ///< JSON pointer
  Json a, b;       ///< null if missing
};

/// The comparison of a stage in two cases.
struct StageDiff {
  Stage stage = Stage::Cloud;
  bool in_a = false, in_b = false;                   ///< the stage is done in this case
  bool same = false;                                 ///< the files are equal, or the stage is done in neither
  std::vector<ValueDifference> parameters, numbers;  ///< differences of the records; empty unless both exist
  /// Differences of the results, by name; none if the files are equal:
  ///   cloud       distance of every sample to the nearest sample of the other case
  ///   level-set   |psi_a - psi_b| at the samples of A
  ///   mesh        distance of boundary vertices to the other boundary; numbers of holes if there are any; if the tets
  ///   are equal, displacements of the vertices
  using Measure = std::variant<Spread, double, std::size_t, bool>;
  std::optional<std::vector<std::pair<std::string, Measure>>> difference;
};

/// The differences between two cases.
struct CaseDiff {
  std::string a, b;  ///< their folders
  std::vector<StageDiff> stages;

  /// Returns the first stage whose files differ.
  std::optional<Stage> first_difference() const;
};

/// \throw UsageError  a folder is not a case; ArtefactDamaged, Interrupted, Cancelled, std::system_error
CaseDiff diff_cases(const CasePaths& a, const CasePaths& b, Progress& progress);

/// Returns the answer of `umtet diff --json`.
Json to_json(const CaseDiff& diff);

/// Returns the comparison as text, some lines per stage. The short form leaves out numbers that are equal to three
/// digits, and lists.
std::string diff_text(const CaseDiff& diff, bool is_long = false);

}  // namespace umtet
