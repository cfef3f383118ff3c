#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace umtet {

/// Checks the vertex indices of simplices.
/// \throw std::invalid_argument naming the first simplex with a vertex that is out of range or repeated
/// @param name  name of a simplex in the message
template <std::size_t N>
void check_indices(const std::vector<std::array<int, N>>& simplices, std::size_t n_vertices, const char* name) {
  const auto is_good = [n_vertices](const std::array<int, N>& simplex) {
    bool good = true;
    for (std::size_t k = 0; k < N; ++k) {
      good &= simplex[k] >= 0 && static_cast<std::size_t>(simplex[k]) < n_vertices;
      for (std::size_t j = 0; j < k; ++j) good &= simplex[j] != simplex[k];
    }
    return good;
  };
  for (std::size_t s = 0; s < simplices.size(); ++s) {
    if (is_good(simplices[s])) continue;
    for (std::size_t k = 0; k < N; ++k) {
      const int v = simplices[s][k];
      if (v < 0 || static_cast<std::size_t>(v) >= n_vertices || std::count(&simplices[s][0], &simplices[s][0] + k, v)) {
        throw std::invalid_argument(std::string(name) + " " + std::to_string(s) + ": vertex " + std::to_string(v) +
                                    " is out of range or repeated (" + std::to_string(n_vertices) + " vertices)");
      }
    }
  }
}

}  // namespace umtet
