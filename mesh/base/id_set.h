#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace umtet {

/// Bit set of background ids, with the rank of every member after index().
class IdSet {
 public:
  explicit IdSet(std::int64_t n_ids) : words_(static_cast<std::size_t>((n_ids + 63) / 64), 0) {}

  bool test(std::int64_t id) const { return words_[id >> 6] >> (id & 63) & 1; }
  /// As test(), but returns false for any number that is not an id.
  bool test_any(std::int64_t id) const { return static_cast<std::uint64_t>(id) < 64 * words_.size() && test(id); }
  void insert(std::int64_t id) { words_[id >> 6] |= std::uint64_t{1} << (id & 63); }

  /// As insert(), for threads that may write to the same word at once.
  void insert_shared(std::int64_t id) {
    const std::atomic_ref word(words_[id >> 6]);
    const std::uint64_t bit = std::uint64_t{1} << (id & 63);
    if ((word.load(std::memory_order_relaxed) & bit) == 0) word.fetch_or(bit, std::memory_order_relaxed);
  }
  void erase(std::int64_t id) { words_[id >> 6] &= ~(std::uint64_t{1} << (id & 63)); }

  /// Equality of two sets over the same ids.
  bool operator==(const IdSet& other) const { return words_ == other.words_; }
  std::size_t n_words() const { return words_.size(); }
  std::uint64_t word(std::size_t w) const { return words_[w]; }
  /// Threads may set different words at the same time.
  void set_word(std::size_t w, std::uint64_t bits) { words_[w] = bits; }

  /// True only if the set has no member in first .. end - 1. Examines whole words, so it may return false otherwise.
  bool is_empty_around(std::int64_t first, std::int64_t end) const {
    std::uint64_t any = 0;
    for (std::int64_t w = first >> 6; w <= (end - 1) >> 6; ++w) any |= words_[w];
    return any == 0;
  }

  /// Prepares rank(); call it again after an insertion. Returns the number of members.
  std::size_t index() {
    before_.resize(words_.size());
    std::size_t n = 0;
    for (std::size_t w = 0; w < words_.size(); ++w) {
      before_[w] = static_cast<std::uint32_t>(n);
      n += static_cast<std::size_t>(std::popcount(words_[w]));
    }
    return n;
  }
  /// Number of members below `id`.
  int rank(std::int64_t id) const {
    const std::uint64_t below = (std::uint64_t{1} << (id & 63)) - 1;
    return static_cast<int>(before_[id >> 6]) + std::popcount(words_[id >> 6] & below);
  }

  /// Calls f(id) for every member, ascending.
  template <class F>
  void for_each(F&& f) const {
    for (std::size_t w = 0; w < words_.size(); ++w) {
      for (std::uint64_t bits = words_[w]; bits != 0; bits &= bits - 1) {
        f(static_cast<std::int64_t>(w * 64) + std::countr_zero(bits));
      }
    }
  }

 private:
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> before_;
};

}  // namespace umtet
