#include "distributed/program/boundary_values.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <string>
#include <variant>
#include <vector>

#include "distributed/exchange/all_to_all.h"
#include "distributed/exchange/collect.h"

namespace umtet {
namespace {

/// The description of an array, without its name and values.
struct Head {
  std::int64_t n_characters, n_components;
  double none;
};

/// Returns the arrays of rank 0 without values on all ranks. Collective.
VertexValues without_values(MPI_Comm comm, const BoundaryData& data) {
  std::vector<Head> heads;
  std::vector<char> names;
  for (const BoundaryData::Array& a : data.arrays) {
    heads.push_back({static_cast<std::int64_t>(a.name.size()),
                     std::holds_alternative<std::vector<Vec3>>(a.values) ? 3 : 1, a.none});
    names.insert(names.end(), a.name.begin(), a.name.end());
  }
  broadcast(comm, heads);
  broadcast(comm, names);
  VertexValues made;
  auto at = names.begin();
  for (const Head& h : heads) {
    made.arrays.push_back({std::string(at, at + h.n_characters), static_cast<std::size_t>(h.n_components), h.none, {}});
    at += h.n_characters;
  }
  return made;
}

/// Returns the values of an array at these vertices, in this order.
std::vector<double> picked(const BoundaryData::Array& array, const std::vector<std::size_t>& vertices) {
  std::vector<double> list;
  for (const std::size_t v : vertices) {
    if (const auto* vectors = std::get_if<std::vector<Vec3>>(&array.values)) {
      list.insert(list.end(), (*vectors)[v].begin(), (*vectors)[v].end());
    } else {
      list.push_back(std::get<std::vector<double>>(array.values)[v]);
    }
  }
  return list;
}

/// Returns the patches of faces, which are given by their numbers in the whole mesh. Collective.
std::vector<int> patches_of(MPI_Comm comm, const PieceData& data, const std::vector<std::int64_t>& faces) {
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  std::vector<std::vector<std::int64_t>> asked(static_cast<std::size_t>(n_ranks));
  asked[0] = faces;
  std::vector<std::vector<int>> answers;
  for (const auto& numbers : all_to_all(comm, asked)) {
    std::vector<int>& patches = answers.emplace_back();
    for (const std::int64_t f : numbers) patches.push_back(data.face_patch.at(static_cast<std::size_t>(f)));
  }
  return all_to_all(comm, answers).front();
}

}  // namespace

VertexValues shared_values(MPI_Comm comm, const DistributedMesh& mesh, const BoundaryData& data) {
  VertexValues made = without_values(comm, data);
  if (made.arrays.empty()) return made;
  made.has.assign(mesh.mesh.V.size(), 0);
  for (const Triangle& f : mesh.positive_faces)
    for (const int v : f) made.has[v] = 1;
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  std::vector<std::vector<std::int64_t>> asked(static_cast<std::size_t>(n_ranks));
  for (std::size_t v = 0; v < made.has.size(); ++v)
    if (made.has[v]) asked[0].push_back(mesh.background_vertex[v]);
  std::vector<std::vector<std::size_t>> wanted;  // for each rank, indices into data.vertices
  for (const auto& ids : all_to_all(comm, asked)) {
    std::vector<std::size_t>& places = wanted.emplace_back();
    for (const std::int64_t id : ids)
      places.push_back(static_cast<std::size_t>(std::lower_bound(data.vertices.begin(), data.vertices.end(), id) -
                                                data.vertices.begin()));
  }
  for (std::size_t a = 0; a < made.arrays.size(); ++a) {
    VertexValues::Array& array = made.arrays[a];
    std::vector<std::vector<double>> answers(wanted.size());
    for (std::size_t r = 0; r < wanted.size() && !data.arrays.empty(); ++r)
      answers[r] = picked(data.arrays[a], wanted[r]);
    const std::vector<double> told = all_to_all(comm, answers).front();
    const std::size_t n = array.n_components;
    array.values.resize(n * made.has.size());
    std::size_t at = 0;
    for (std::size_t v = 0; v < made.has.size(); ++v)
      for (std::size_t k = 0; made.has[v] && k < n; ++k) array.values[n * v + k] = told[at++];
  }
  return made;
}

MidSideValues shared_mid_side_values(MPI_Comm comm, const std::vector<std::size_t>& edges,
                                     const std::vector<std::size_t>& n_of_rank, const BoundaryData& data) {
  MidSideValues made{edges, {}};
  const std::size_t n_arrays = without_values(comm, data).arrays.size();
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  for (std::size_t a = 0; a < n_arrays; ++a) {
    std::vector<std::vector<double>> answers(static_cast<std::size_t>(n_ranks));
    std::size_t first = data.vertices.size();  // on rank 0, the only rank with arrays
    for (std::size_t r = 0; r < n_of_rank.size() && !data.arrays.empty(); ++r) {
      std::vector<std::size_t> places(n_of_rank[r]);
      std::iota(places.begin(), places.end(), first);
      first += n_of_rank[r];
      answers[r] = picked(data.arrays[a], places);
    }
    made.arrays.push_back(all_to_all(comm, answers).front());
  }
  return made;
}

PieceExtras piece_extras(MPI_Comm comm, const DistributedMesh& mesh, const PieceData& data) {
  PieceExtras made;
  std::vector<std::int64_t> numbers = {data.body_number};
  std::vector<char> names;  // each with a 0 behind it
  for (const MeshPart& patch : data.patches) {
    numbers.push_back(patch.number);
    names.insert(names.end(), patch.name.begin(), patch.name.end());
    names.push_back('\0');
  }
  broadcast(comm, numbers);
  broadcast(comm, names);
  made.body_number = static_cast<int>(numbers.front());
  const char* name = names.data();
  for (std::size_t p = 1; p < numbers.size(); ++p) {
    made.patches.push_back({name, static_cast<int>(numbers[p])});
    name += made.patches.back().name.size() + 1;
  }
  made.patch_of = [comm, &data](const std::vector<std::int64_t>& faces) { return patches_of(comm, data, faces); };
  made.values = shared_values(comm, mesh, data.of_vertices);
  return made;
}

}  // namespace umtet
