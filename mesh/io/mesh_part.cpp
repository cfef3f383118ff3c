#include "mesh/io/mesh_part.h"

#include <map>
#include <string>
#include <variant>

namespace umtet {
namespace {

template <class T>
std::vector<T> chosen(const std::vector<T>& all, const std::vector<std::size_t>& which) {
  std::vector<T> some;
  some.reserve(which.size());
  for (const std::size_t i : which) some.push_back(all[i]);
  return some;
}

std::map<std::string, FieldValues> chosen(const std::map<std::string, FieldValues>& data,
                                          const std::vector<std::size_t>& which) {
  std::map<std::string, FieldValues> some;
  for (const auto& [name, values] : data) {
    some[name] = std::visit([&](const auto& all) -> FieldValues { return chosen(all, which); }, values);
  }
  return some;
}

}  // namespace

MeshFile part_of(const MeshFile& whole, const std::vector<std::size_t>& tets) {
  MeshFile part;
  part.mesh.C = chosen(whole.mesh.C, tets);
  std::vector<int> number(whole.mesh.V.size(), -1);
  for (const Tet& t : part.mesh.C) {
    for (const int v : t) number[v] = 0;
  }
  std::vector<std::size_t> vertices;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(vertices.size());
    vertices.push_back(v);
  }
  for (Tet& t : part.mesh.C) {
    for (int& v : t) v = number[v];
  }
  part.mesh.V = chosen(whole.mesh.V, vertices);
  part.point_data = chosen(whole.point_data, vertices);
  part.cell_data = chosen(whole.cell_data, tets);
  return part;
}

}  // namespace umtet
