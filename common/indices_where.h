#pragma once

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace umtet {

/// The indices below n that satisfy `holds`, ascending, found by all threads.
template <class Index, class Holds>
std::vector<Index> indices_where(std::size_t n, const Holds& holds) {
  constexpr std::size_t kChunk = 1 << 14;
  std::vector<std::vector<Index>> found((n + kChunk - 1) / kChunk);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t chunk) {
    for (std::size_t i = chunk * kChunk; i < std::min(n, (chunk + 1) * kChunk); ++i)
      if (holds(i)) found[chunk].push_back(static_cast<Index>(i));
  });
  std::size_t n_all = 0;
  for (const std::vector<Index>& some : found) n_all += some.size();
  std::vector<Index> all;
  all.reserve(n_all);
  for (const std::vector<Index>& some : found) all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace umtet
