#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace umtet {

/// Insertion-ordered list of a few hundred ids with a hash table. It is meant for parts of a mesh so small that an
/// IdSet, with a bit for every vertex of the background, would cost more than all other work on them.
class IdList {
 public:
  /// The index of an id, which is appended if it is not in the list.
  int add(std::int64_t id) {
    if (2 * ids_.size() >= table_.size()) grow();
    int& at = table_[slot(id)];
    if (at == 0) {
      ids_.push_back(id);
      at = static_cast<int>(ids_.size());
    }
    return at - 1;
  }
  /// The index of an id, or -1 if it is not in the list. The argument need not be a valid id.
  int find(std::int64_t id) const { return table_.empty() ? -1 : table_[slot(id)] - 1; }
  bool test(std::int64_t id) const { return find(id) >= 0; }
  bool test_any(std::int64_t id) const { return test(id); }
  const std::vector<std::int64_t>& ids() const { return ids_; }

 private:
  /// The slot of the id, or the free slot for it.
  std::size_t slot(std::int64_t id) const {
    std::size_t s = static_cast<std::uint64_t>(id) * 0x9e3779b97f4a7c15U >> shift_;  // 2^64 over the golden ratio
    while (table_[s] != 0 && ids_[static_cast<std::size_t>(table_[s] - 1)] != id) s = (s + 1) & (table_.size() - 1);
    return s;
  }
  void grow() {
    --shift_;
    table_.assign(std::size_t{1} << (64 - shift_), 0);
    for (std::size_t k = 0; k < ids_.size(); ++k) table_[slot(ids_[k])] = static_cast<int>(k) + 1;
  }

  std::vector<std::int64_t> ids_;
  std::vector<int> table_;  ///< index + 1, 0 = free; the size is a power of two, and at most half is used
  int shift_ = 64 - 9;      ///< shift from a 64-bit hash to a slot; the first table has 2^10 slots
};

}  // namespace umtet
