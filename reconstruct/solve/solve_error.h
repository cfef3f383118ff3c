#pragma once

#include <stdexcept>

namespace umtet {

/// The solve cannot go on; what() has the size, the parameter and what the solver said.
struct SolveError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace umtet
