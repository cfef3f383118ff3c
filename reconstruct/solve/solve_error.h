#pragma once

#include <stdexcept>

namespace umtet {

/// Error of a solver; what() contains the size, the parameter and the solver's message.
struct SolveError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace umtet
