#pragma once

#include <optional>
#include <string>
#include <vector>

namespace umtet {

/// Defects of one kind that a user accepts. The kind is a word of DefectKind or of InputDefectKind ("missed" is both).
struct AcceptedDefects {
  std::string kind;
  std::optional<double> most;  ///< in h for places, else in the unit of InputDefectKind; none: any amount
};

/// Reads "folded,off:0.2,guessed". \throw UsageError naming the word
std::vector<AcceptedDefects> parse_accepted_defects(const std::string& text);

/// Whether a defect of this kind and amount is in the list.
bool is_accepted(const std::vector<AcceptedDefects>& accepted, const std::string& kind, double amount);

}  // namespace umtet
