#pragma once

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace umtet {

/// An empty vector with capacity for n values, whose memory pages have been touched by all threads. The first touch of
/// a page costs more than later writes to it, and a growing vector is filled by one thread.
template <class T>
std::vector<T> reserved(std::size_t n) {
  constexpr std::size_t kPage = 4096, kPagesPerTask = 512;  // a huge page if the system has them
  std::vector<T> room;
  room.reserve(n);
  auto* const begin = reinterpret_cast<unsigned char*>(room.data());
  const std::size_t n_pages = n * sizeof(T) / kPage;
  tbb::parallel_for(std::size_t{0}, (n_pages + kPagesPerTask - 1) / kPagesPerTask, [&](std::size_t task) {
    for (std::size_t page = task * kPagesPerTask; page < n_pages && page < (task + 1) * kPagesPerTask; ++page)
      *static_cast<volatile unsigned char*>(begin + page * kPage) = 0;
  });
  return room;
}

/// A vector of n values, in memory touched by all threads.
template <class T>
std::vector<T> touched(std::size_t n) {
  std::vector<T> values = reserved<T>(n);
  values.resize(n);
  return values;
}

/// Copies values with all threads.
template <class T>
std::vector<T> copied(std::span<const T> values) {
  constexpr std::size_t kValuesPerTask = 1 << 16;
  std::vector<T> copy = touched<T>(values.size());
  tbb::parallel_for(std::size_t{0}, (values.size() + kValuesPerTask - 1) / kValuesPerTask, [&](std::size_t task) {
    const std::size_t first = task * kValuesPerTask, n = std::min(kValuesPerTask, values.size() - first);
    std::copy_n(values.data() + first, n, copy.data() + first);
  });
  return copy;
}

/// Gathers values[which[k]] for every k, with all threads.
template <class T>
std::vector<T> picked(std::span<const T> values, std::span<const std::size_t> which) {
  std::vector<T> some = touched<T>(which.size());
  tbb::parallel_for(std::size_t{0}, which.size(), [&](std::size_t k) { some[k] = values[which[k]]; });
  return some;
}

}  // namespace umtet
