#pragma once

#include <cstddef>
#include <vector>

namespace umtet::detail {

/// All tets, the n worst of them first, ascending in quality and then by number. \pre n is at most their number
std::vector<int> worst_first(const std::vector<double>& quality, std::size_t n);

/// The first n of those, found by all threads.
std::vector<int> worst_of(const std::vector<double>& quality, std::size_t n);

}  // namespace umtet::detail
