#pragma once

#include <cstddef>
#include <limits>
#include <stdexcept>

namespace umtet {

/// Converts a size to a count for MPI, which uses int.
/// \throw std::length_error above 2^31 - 1, with the message `what`
inline int mpi_count(std::size_t n, const char* what = "an exchange of more than 2^31 - 1 members") {
  if (n > static_cast<std::size_t>(std::numeric_limits<int>::max())) throw std::length_error(what);
  return static_cast<int>(n);
}

}  // namespace umtet
