#pragma once

#include <cstddef>
#include <vector>

namespace umtet::detail {

/// Returns all tets, beginning with the n worst ones, ascending in quality and then by number. \pre n is at most their
/// number
std::vector<int> worst_first(const std::vector<double>& quality, std::size_t n);

/// Returns the first n of these tets; all threads search in parallel.
std::vector<int> worst_of(const std::vector<double>& quality, std::size_t n);

}  // namespace umtet::detail
