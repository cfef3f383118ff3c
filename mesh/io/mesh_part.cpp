#include "mesh/io/mesh_part.h"

#include <oneapi/tbb/parallel_for.h>

#include <map>
#include <string>
#include <variant>

#include "common/first_touch.h"

namespace umtet {
namespace {

std::map<std::string, FieldValues> chosen(const std::map<std::string, FieldValues>& data,
                                          const std::vector<std::size_t>& which) {
  std::map<std::string, FieldValues> some;
  for (const auto& [name, values] : data) {
    const auto of = [&]<class T>(const std::vector<T>& all) -> FieldValues { return picked<T>(all, which); };
    some[name] = std::visit(of, values);
  }
  return some;
}

}  // namespace

MeshFile part_of(const MeshFile& whole, const std::vector<std::size_t>& tets) {
  MeshFile part;
  part.mesh.C = picked<Tet>(whole.mesh.C, tets);
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
  tbb::parallel_for(std::size_t{0}, part.mesh.C.size(), [&](std::size_t k) {
    for (int& v : part.mesh.C[k]) v = number[v];
  });
  part.mesh.V = picked<Vec3>(whole.mesh.V, vertices);
  part.point_data = chosen(whole.point_data, vertices);
  part.cell_data = chosen(whole.cell_data, tets);
  return part;
}

}  // namespace umtet
