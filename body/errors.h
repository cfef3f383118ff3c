#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "body/thin_place.h"
#include "common/message.h"

// The errors of this library, besides CloudRefused, SolveError, SolveTooLarge and Cancelled. The message of each states
// the fact and the remedies. A remedy names an option by its position in BodyOptions or umtet::Options.
namespace umtet {

/// The call itself is wrong: an option out of range, or options that contradict each other.
struct UsageError : ExplainedError {
  using ExplainedError::ExplainedError;
};

/// There is no mesh of this domain at this h; what() states the status and its evidence.
struct MeshingImpossible : ExplainedError {
  using ExplainedError::ExplainedError;
};

/// There is no mesh because parts of the domain are too thin for this h.
struct TooThin : MeshingImpossible {
  /// The thin parts, and an h that suffices.
  struct Evidence {
    std::vector<ThinPlace> places;   ///< model coordinates, worst first
    double h = 0;                    ///< the h for which they are too thin
    std::optional<double> h_enough;  ///< an h that resolves all of them; empty if unknown
  };
  TooThin(Message message, Evidence evidence) : MeshingImpossible(std::move(message)), evidence(std::move(evidence)) {}
  Evidence evidence;
};

/// The work would need more memory or tets than the caller allows.
struct ResourceLimit : ExplainedError {
  using ExplainedError::ExplainedError;
};

}  // namespace umtet
