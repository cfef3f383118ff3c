#pragma once

#include "mesh/io/solver_mesh.h"

namespace umtet::detail {

/// All node data, with 0/1 arrays for every patch, for all patches and for every curve, which replace data with the
/// same name.
inline std::map<std::string, FieldValues> with_node_sets(const SolverMesh& mesh) {
  std::map<std::string, FieldValues> arrays = mesh.point_data;
  arrays.insert(mesh.boundary_data.begin(), mesh.boundary_data.end());
  const auto add = [&](const std::string& name, const std::vector<int>& nodes) {
    std::vector<std::uint8_t> is_in(mesh.nodes.size(), 0);
    for (const int i : nodes) is_in[i] = 1;
    arrays.insert_or_assign(name, std::move(is_in));
  };
  const std::vector<std::vector<int>> nodes = patch_nodes(mesh);
  for (std::size_t p = 0; p < nodes.size(); ++p) add(mesh.patches[p].name, nodes[p]);
  add(kWholeBoundary, boundary_nodes(mesh));
  for (const MeshCurve& curve : mesh.curves) add(curve.part.name, curve_nodes(curve));
  return arrays;
}

/// The patch number of every face.
inline std::vector<std::int64_t> patch_numbers(const SolverMesh& mesh) {
  std::vector<std::int64_t> numbers;
  numbers.reserve(mesh.n_faces());
  for (const int p : mesh.face_patch) numbers.push_back(mesh.patches[p].number);
  return numbers;
}

}  // namespace umtet::detail
