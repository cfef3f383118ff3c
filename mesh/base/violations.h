#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <cstddef>
#include <limits>

namespace umtet {

/// Violations of a rule: the number of the first object that breaks it, and their count.
struct Violations {
  std::size_t first = std::numeric_limits<std::size_t>::max(), count = 0;
};

/// Finds the i < n with bad(i). Uses threads over i; the result does not depend on them.
template <class Predicate>
Violations find_violations(std::size_t n, Predicate&& bad) {
  constexpr std::size_t kPerTask = 4096;  // a predicate takes tens of nanoseconds
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, n, kPerTask), Violations{},
      [&](const auto& range, Violations o) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          if (bad(i)) o.first = std::min(o.first, i), ++o.count;
        }
        return o;
      },
      [](const Violations& a, const Violations& b) {
        return Violations{std::min(a.first, b.first), a.count + b.count};
      });
}

}  // namespace umtet
