#pragma once

#include <cstddef>
#include <set>
#include <vector>

#include "common/disjoint_sets.h"

namespace umtet {

/// Sets of patches, some of which must not be united.
class PatchMergers {
 public:
  explicit PatchMergers(std::size_t count) : sets_(count), apart_(count) {}

  void keep_apart(int a, int b) {
    apart_[static_cast<std::size_t>(a)].insert(b);
    apart_[static_cast<std::size_t>(b)].insert(a);
  }
  /// @return true if they were in two sets and are now in one
  bool unite(int a, int b) {
    a = sets_.find(a);
    b = sets_.find(b);
    if (a == b || apart_[static_cast<std::size_t>(a)].count(b)) return false;
    sets_.unite(a, b);
    const int root = sets_.find(a), other = a + b - root;
    for (const int c : apart_[static_cast<std::size_t>(other)]) {
      apart_[static_cast<std::size_t>(c)].erase(other);
      keep_apart(root, c);
    }
    apart_[static_cast<std::size_t>(other)].clear();
    return true;
  }
  int find(int a) { return sets_.find(a); }

 private:
  DisjointSets sets_;
  std::vector<std::set<int>> apart_;  ///< by root: the roots of other sets
};

}  // namespace umtet
