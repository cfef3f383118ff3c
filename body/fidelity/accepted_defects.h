#pragma once

#include <optional>
#include <string>
#include <vector>

namespace umtet {

/// Defects of one kind that a user accepts. The kind is a word of DefectKind or of InputDefectKind ("missed" is both).
struct AcceptedDefects {
  std::string kind;
  /// Largest accepted amount, in h for DefectKind, otherwise in the unit of InputDefectKind; empty: any amount.
  std::optional<double> most;
};

/// Reads "folded,off:0.2,guessed". \throw UsageError naming the word
std::vector<AcceptedDefects> parse_accepted_defects(const std::string& text);

/// Returns whether the list accepts a defect of this kind and amount.
bool is_accepted(const std::vector<AcceptedDefects>& accepted, const std::string& kind, double amount);

}  // namespace umtet
