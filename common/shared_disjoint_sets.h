#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace umtet {

/// Union-find for concurrent use by several threads. A set is represented by its least member, so the final sets and
/// representatives do not depend on the order of unions.
class SharedDisjointSets {
 public:
  explicit SharedDisjointSets(std::size_t n) : parent_(n) {
    for (std::size_t i = 0; i < n; ++i) parent_[i].store(static_cast<std::uint32_t>(i), std::memory_order_relaxed);
  }

  /// The least member of i's set; while other threads unite sets, some member of it.
  std::uint32_t find(std::uint32_t i) {
    while (true) {
      std::uint32_t parent = parent_[i].load(std::memory_order_relaxed);
      if (parent == i) return i;
      const std::uint32_t above = parent_[parent].load(std::memory_order_relaxed);
      // Shortens paths; if another thread has changed this path, it is already shorter.
      if (above != parent) parent_[i].compare_exchange_weak(parent, above, std::memory_order_relaxed);
      i = above;
    }
  }
  void unite(std::uint32_t i, std::uint32_t j) {
    while (true) {
      i = find(i);
      j = find(j);
      if (i == j) return;
      if (i < j) std::swap(i, j);
      std::uint32_t root = i;  // a parent is less than its children, so there are no cycles
      if (parent_[i].compare_exchange_strong(root, j, std::memory_order_relaxed)) return;
    }
  }

 private:
  std::vector<std::atomic<std::uint32_t>> parent_;
};

}  // namespace umtet
