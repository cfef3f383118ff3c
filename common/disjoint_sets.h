#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace umtet {

/// Union-find. A set is represented by its least member, so that representatives do not depend on the order of unions.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n = 0) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::size_t size() const { return parent_.size(); }
  /// Adds a set with one member and returns the member.
  int add() {
    parent_.push_back(static_cast<int>(parent_.size()));
    return parent_.back();
  }
  /// The least member of i's set.
  int find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(int i, int j) {
    i = find(i);
    j = find(j);
    if (i != j) parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<int> parent_;
};

}  // namespace umtet
