#include "distributed/io/part_files.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "distributed/exchange/collect.h"
#include "distributed/io/ordered_vtu.h"
#include "distributed/io/standard_data.h"
#include "distributed/io/write_together.h"
#include "distributed/solver/ghost_tets.h"
#include "distributed/solver/solver_part.h"
#include "mesh/certify/quality_report.h"
#include "mesh/io/checked_file.h"
#include "mesh/io/msh_piece.h"
#include "mesh/io/pvtu.h"
#include "mesh/io/tet_mesh_io.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

std::vector<int> ranks_with(MPI_Comm comm, bool has_one) {
  std::vector<int> ranks = gathered(comm, std::vector<int>(has_one ? 1 : 0, rank_in(comm)));
  broadcast(comm, ranks);
  return ranks;
}

/// Adds 0/1 arrays for the vertices of each patch, as in files of `umtet export`.
void add_node_sets(const SolverPart& part, const VertexOwners& owners, std::map<std::string, FieldValues>& data) {
  for (std::size_t p = 0; p < part.patches.size(); ++p) {
    if (part.patches[p] == kWholeBoundary) continue;  // `boundary` exists in any case
    std::vector<std::uint8_t> is_in(part.owner.size(), 0);
    for (std::size_t f = 0; f < part.boundary.size(); ++f) {
      if (part.patch[f] != static_cast<int>(p)) continue;
      for (const int v : part.boundary[f]) is_in[v] = 1;
    }
    data[part.patches[p]] = owners.exchange().any(is_in);
  }
}

/// Adds the values at the vertices of the local mesh, including values that only another rank has.
void add_values(const VertexOwners& owners, const VertexValues& values, std::map<std::string, FieldValues>& data) {
  for (const VertexValues::Array& array : values.arrays) {
    if (array.n_components == 3) {
      std::vector<Vec3> of_mesh;
      for (const auto& x : owners.tell(values_of_owned<3>(owners, values, array)))
        of_mesh.emplace_back(x[0], x[1], x[2]);
      data[array.name] = std::move(of_mesh);
    } else {
      std::vector<double> of_mesh;
      for (const auto& x : owners.tell(values_of_owned<1>(owners, values, array))) of_mesh.push_back(x[0]);
      data[array.name] = std::move(of_mesh);
    }
  }
}

}  // namespace

std::vector<MeshPart> divide_part(SolverPart& part, const PieceExtras& extras) {
  std::vector<MeshPart> patches = extras.patches;
  if (!patches.empty()) {
    part.patches.clear();
    for (const MeshPart& patch : patches) part.patches.push_back(patch.name);
    part.patch = extras.patch_of(part.global_face);
    return patches;
  }
  for (std::size_t p = 0; p < part.patches.size(); ++p) patches.push_back({part.patches[p], static_cast<int>(p) + 2});
  return patches;
}

DistributedMesh some_of(const DistributedMesh& mesh, const std::vector<std::size_t>& tets) {
  DistributedMesh some;
  std::vector<int> number(mesh.mesh.V.size(), -1);
  for (const std::size_t t : tets) {
    some.background_tet.push_back(mesh.background_tet[t]);
    some.mesh.C.push_back(mesh.mesh.C[t]);
    for (const int v : mesh.mesh.C[t]) number[v] = 0;
  }
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(some.mesh.V.size());
    some.mesh.V.push_back(mesh.mesh.V[v]);
    some.background_vertex.push_back(mesh.background_vertex[v]);
    some.owner.push_back(mesh.owner[v]);
  }
  for (Tet& t : some.mesh.C)
    for (int& v : t) v = number[v];
  return some;
}

void write_whole_vtu(MPI_Comm comm, const fs::path& path, const DistributedMesh& mesh,
                     const std::vector<std::uint8_t>* on_boundary, const VertexValues& more) {
  const StandardData data = standard_data(comm, mesh, on_boundary);
  const std::vector<Vec3> places = places_of_owned(data.owners, mesh.mesh);
  const auto values = [&](std::size_t a) {
    const VertexValues::Array& array = more.arrays[a];
    return array.n_components == 3 ? flat(values_of_owned<3>(data.owners, more, array))
                                   : flat(values_of_owned<1>(data.owners, more, array));
  };
  const auto corner = [&](std::size_t t, std::size_t k) { return data.own_number[mesh.mesh.C[t][k]]; };
  write_ordered_vtu(comm, path,
                    {.ids = data.owners.ids(),
                     .first_mid_side = std::numeric_limits<std::int64_t>::max(),
                     .places = places,
                     .boundary = data.boundary,
                     .fields = more,
                     .values = values,
                     .mesh = mesh,
                     .nodes_per_tet = 4,
                     .node = corner});
}

std::vector<fs::path> write_pvtu(MPI_Comm comm, const fs::path& pvtu, const DistributedMesh& mesh,
                                 const PieceExtras& extras) {
  const StandardData data = standard_data(comm, mesh);
  SolverPart part = solver_part(comm, mesh, data.owners);
  divide_part(part, extras);
  MeshFile piece;
  piece.mesh = mesh.mesh;
  piece.point_data = {{"background_vertex", mesh.background_vertex},
                      {"boundary", data.owners.tell(data.boundary)},
                      {"global_vertex", part.global_vertex},
                      {"owner", std::vector<std::int64_t>(part.owner.begin(), part.owner.end())}};
  piece.cell_data = {
      {"background_tet", mesh.background_tet}, {"global_tet", part.global_tet}, {"mean_ratio", mean_ratios(mesh.mesh)}};
  add_values(data.owners, extras.values, piece.point_data);
  add_node_sets(part, data.owners, piece.point_data);
  return write_pvtu(comm, pvtu, !mesh.mesh.C.empty(), piece.point_data, piece.cell_data,
                    [&](const fs::path& own) { write_vtu(own, piece); });
}

std::vector<fs::path> write_pvtu(MPI_Comm comm, const fs::path& pvtu, bool has_piece,
                                 const std::map<std::string, FieldValues>& point_data,
                                 const std::map<std::string, FieldValues>& cell_data,
                                 const std::function<void(const fs::path&)>& write) {
  const auto name_of = [&](int rank) { return pvtu.stem().string() + "_" + std::to_string(rank) + ".vtu"; };
  const fs::path own = pvtu.parent_path() / name_of(rank_in(comm));
  write_together(comm, own, has_piece, [&] { write(own); });
  std::vector<std::string> pieces;
  for (const int rank : ranks_with(comm, has_piece)) pieces.push_back(name_of(rank));
  write_together(comm, pvtu, rank_in(comm) == 0,
                 [&] { CheckedFile(pvtu).text(pvtu_text(point_data, cell_data, pieces)).close(); });
  std::vector<fs::path> files;
  for (const std::string& name : pieces) files.push_back(pvtu.parent_path() / name);
  files.push_back(pvtu);
  return files;
}

std::vector<fs::path> write_msh_pieces(MPI_Comm comm, const fs::path& msh, const DistributedMesh& mesh,
                                       const PieceExtras& extras) {
  const VertexOwners owners(comm, mesh);
  SolverPart part = solver_part(comm, mesh, owners);
  const std::vector<int> ranks = ranks_with(comm, !mesh.mesh.C.empty());
  const auto part_of = [&](int rank) {
    return static_cast<int>(std::lower_bound(ranks.begin(), ranks.end(), rank) - ranks.begin());
  };
  const auto name_of = [&](int number) {
    return msh.parent_path() / (msh.stem().string() + "_" + std::to_string(number + 1) + ".msh");
  };
  MshPiece piece;
  piece.part = part_of(rank_in(comm));
  piece.n_parts = static_cast<int>(ranks.size());
  piece.patches = divide_part(part, extras);
  piece.body.number = extras.body_number;
  piece.n_faces = part.n_faces;
  piece.nodes = mesh.mesh.V;
  piece.node_number = part.global_vertex;
  piece.tets = mesh.mesh.C;
  piece.tet_number = part.global_tet;
  piece.faces = part.boundary;
  piece.face_number = part.global_face;
  piece.face_patch = part.patch;
  add_values(owners, extras.values, piece.boundary_data);
  std::map<std::int64_t, int> node;  // local nodes by number in the whole mesh: shared vertices and vertices of ghosts
  for (const int v : part.sharers.vertex) node[part.global_vertex[v]] = v;
  for (const GhostTet& ghost : ghost_tets(comm, mesh, part)) {
    Tet& tet = piece.ghosts.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      const auto [at, is_new] = node.try_emplace(ghost.corner[k], static_cast<int>(piece.nodes.size()));
      tet[k] = at->second;
      if (!is_new) continue;
      piece.nodes.emplace_back(ghost.place[k][0], ghost.place[k][1], ghost.place[k][2]);
      piece.node_number.push_back(ghost.corner[k]);
    }
    piece.ghost_number.push_back(ghost.tet);
    piece.ghost_part.push_back(part_of(ghost.rank));
  }
  const fs::path own = name_of(piece.part);
  write_together(comm, own, !mesh.mesh.C.empty(), [&] { write_msh41_piece(own, piece); });
  std::vector<fs::path> files;
  files.reserve(static_cast<std::size_t>(piece.n_parts));
  for (int p = 0; p < piece.n_parts; ++p) files.push_back(name_of(p));
  return files;
}

}  // namespace umtet
