#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "body/thin_place.h"

// The exceptions of this library, besides CloudRefused, SolveError and Cancelled.
namespace umtet {

/// The call itself is wrong: an option out of range, or options that contradict each other.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// There is no mesh of this domain at this h; what() has the status and its evidence.
struct MeshingImpossible : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// There is none because the domain is thinner than this h can show.
struct TooThin : MeshingImpossible {
  /// Where, and what would do.
  struct Evidence {
    std::vector<ThinPlace> places;   ///< model coordinates, worst first
    double h = 0;                    ///< that they are too thin for
    std::optional<double> h_enough;  ///< an h that shows all of them; none: unknown
  };
  TooThin(const std::string& message, Evidence evidence) : MeshingImpossible(message), evidence(std::move(evidence)) {}
  Evidence evidence;
};

/// The work would need more than the caller allowed.
struct ResourceLimit : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace umtet
