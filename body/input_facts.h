#pragma once

#include <optional>
#include <string>

namespace umtet {

/// Changes and guesses that were made to a cloud before psi was fitted: they are the possible causes of a wrong body.
/// Numbers are shares of the points, in [0, 1].
struct InputFacts {
  bool normals_given = false;  ///< they came with the cloud; else they were estimated
  double turned = 0;           ///< given normals that were turned over, or estimated normals that `turned_by` overruled
  std::string turned_by;       ///< "neighbours", "winding number", "psi"; empty if none were turned
  double doubtful = 0;         ///< normals whose outward side is a guess
  double opposed = 0;          ///< normals that point against grad psi
  double consistency = 1;      ///< share of neighbouring pairs whose signs agree in the end
  /// Share of patches that bound no body according to the winding number; empty if it was not computed.
  std::optional<double> off_a_half;
};

}  // namespace umtet
