#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "body/thin_place.h"
#include "common/message.h"

// The errors of this library, besides CloudRefused, SolveError, SolveTooLarge and Cancelled. Each carries a message
// with the fact and its remedies: a remedy names an option by its place in BodyOptions or umtet::Options.
namespace umtet {

/// The call itself is wrong: an option out of range, or options that contradict each other.
struct UsageError : ExplainedError {
  using ExplainedError::ExplainedError;
};

/// There is no mesh of this domain at this h; what() states the status and its evidence.
struct MeshingImpossible : ExplainedError {
  using ExplainedError::ExplainedError;
};

/// There is none because the domain is thinner than this h can show.
struct TooThin : MeshingImpossible {
  /// Where, and what would do.
  struct Evidence {
    std::vector<ThinPlace> places;   ///< model coordinates, worst first
    double h = 0;                    ///< that they are too thin for
    std::optional<double> h_enough;  ///< an h that shows all of them; none: unknown
  };
  TooThin(Message message, Evidence evidence) : MeshingImpossible(std::move(message)), evidence(std::move(evidence)) {}
  Evidence evidence;
};

/// The work would need more than the caller allowed.
struct ResourceLimit : ExplainedError {
  using ExplainedError::ExplainedError;
};

}  // namespace umtet
