#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <cstddef>
#include <limits>

namespace umtet::detail {

/// The first of those that break a rule, by number, and how many there are.
struct Offenders {
  std::size_t first = std::numeric_limits<std::size_t>::max(), count = 0;
};

/// The i < n for which bad(i). Threads over i; the result does not depend on them.
template <class Predicate>
Offenders find_offenders(std::size_t n, Predicate&& bad) {
  constexpr std::size_t kPerTask = 4096;  // a predicate takes tens of nanoseconds
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, n, kPerTask), Offenders{},
      [&](const auto& range, Offenders o) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          if (bad(i)) o.first = std::min(o.first, i), ++o.count;
        }
        return o;
      },
      [](const Offenders& a, const Offenders& b) {
        return Offenders{std::min(a.first, b.first), a.count + b.count};
      });
}

}  // namespace umtet::detail
