#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "distributed/mesh/vertex_owners.h"

namespace umtet {

/// Point data of some vertices. All ranks have the same arrays.
struct VertexValues {
  struct Array {
    std::string name;
    std::size_t n_components;    ///< 1 or 3
    double none;                 ///< value of vertices without data on any rank
    std::vector<double> values;  ///< n_components per vertex of the local mesh; read where `has` is set
  };
  std::vector<Array> arrays;
  std::vector<char> has;  ///< for each vertex of the local mesh, whether it has data
};

/// Returns the values of an array at owned vertices, from any rank that has them. Collective.
template <std::size_t n>
std::vector<std::array<double, n>> values_of_owned(const VertexOwners& owners, const VertexValues& all,
                                                   const VertexValues::Array& array) {
  struct Said {
    char has;
    std::array<double, n> value;
  };
  std::array<double, n> none;
  none.fill(array.none);
  std::vector<std::array<double, n>> owned(owners.ids().size(), none);
  owners.ask(
      [&](std::size_t v) {
        Said said{all.has[v], none};
        for (std::size_t k = 0; said.has && k < n; ++k) said.value[k] = array.values[n * v + k];
        return said;
      },
      [&](std::size_t k, const Said& said) {
        if (said.has) owned[k] = said.value;
      });
  return owned;
}

/// Concatenates arrays.
template <std::size_t n>
std::vector<double> flat(const std::vector<std::array<double, n>>& values) {
  std::vector<double> list;
  list.reserve(n * values.size());
  for (const auto& x : values) list.insert(list.end(), x.begin(), x.end());
  return list;
}

}  // namespace umtet
