#pragma once

#include <cstddef>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// The vertices that some tet uses, numbered from 0 in their order. All other vertices have no number.
class UsedVertices {
 public:
  /// @param n_vertices  the number of all vertices; every id in C is less
  UsedVertices(const std::vector<Tet>& C, std::size_t n_vertices) : number_(n_vertices, -1) {
    for (const Tet& t : C)
      for (const int v : t) number_[v] = 0;
    for (int& v : number_)
      if (v == 0) v = n_++;
  }

  /// The number of used vertices.
  int n() const { return n_; }

  /// The number of a vertex, or -1 if no tet uses it.
  int operator[](int v) const { return number_[v]; }

  /// Removes the values of unused vertices.
  /// @param values  one for each of all vertices
  template <class T>
  void keep(std::vector<T>& values) const {
    for (std::size_t v = 0; v < number_.size(); ++v)
      if (number_[v] >= 0) values[number_[v]] = values[v];
    values.resize(static_cast<std::size_t>(n_));
  }

  /// Replaces vertex ids by their numbers.
  template <class Ids>
  void renumber(Ids& ids) const {
    for (int& v : ids) v = number_[v];
  }

 private:
  std::vector<int> number_;
  int n_ = 0;
};

}  // namespace umtet
