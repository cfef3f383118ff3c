#pragma once

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "mesh/base/id_set.h"

namespace umtet {

/// Words of 64 ids per block, the unit of work of a thread. About a tenth of the ids are in an active layer.
inline constexpr std::size_t kWordsPerBlock = 16;

inline std::size_t n_blocks(const IdSet& set) { return (set.n_words() + kWordsPerBlock - 1) / kWordsPerBlock; }

/// Calls f(state, id) for the members of a set, where state is the result of begin(block) for the id's block.
template <class Begin, class F>
void for_each_in_blocks(const IdSet& set, const Begin& begin, const F& f) {
  tbb::parallel_for(std::size_t{0}, n_blocks(set), [&](std::size_t b) {
    auto state = begin(b);
    const std::size_t end = std::min(set.n_words(), (b + 1) * kWordsPerBlock);
    for (std::size_t w = b * kWordsPerBlock; w < end; ++w) {
      for (std::uint64_t bits = set.word(w); bits != 0; bits &= bits - 1) {
        f(state, static_cast<std::int64_t>(w * 64) + std::countr_zero(bits));
      }
    }
  });
}

/// Calls f(block, id) for the members of a set, with blocks in parallel. The blocks do not depend on the number of
/// threads.
template <class F>
void for_each_in_blocks(const IdSet& set, const F& f) {
  for_each_in_blocks(
      set, [](std::size_t b) { return b; }, f);
}

}  // namespace umtet
