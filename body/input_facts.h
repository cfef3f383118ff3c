#pragma once

#include <optional>
#include <string>

namespace umtet {

/// What was done to a cloud, or guessed, before psi was fitted: where a wrong body may come from. Shares of its points.
struct InputFacts {
  bool normals_given = false;  ///< they came with the cloud; else they were estimated
  double turned = 0;           ///< given normals that were turned, or estimated ones that something else overruled
  std::string turned_by;       ///< "neighbours", "winding number", "psi"; empty where none were turned
  double doubtful = 0;         ///< normals whose outward side is a guess
  double opposed = 0;          ///< normals that point against grad psi
  double consistency = 1;      ///< share of neighbouring pairs whose signs agree in the end
  std::optional<double> off_a_half;  ///< share of patches that bound no body by the winding number; none: not asked
};

}  // namespace umtet
