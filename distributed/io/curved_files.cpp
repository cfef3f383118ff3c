#include "distributed/io/curved_files.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "distributed/io/ordered_vtu.h"
#include "distributed/io/standard_data.h"
#include "distributed/solver/curved_solver_part.h"
#include "distributed/solver/solver_part.h"
#include "mesh/certify/quality_report.h"
#include "mesh/io/tet_mesh_io.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

/// The nodes that a rank owns: vertices, then mid-sides.
class OwnedNodes {
 public:
  OwnedNodes(MPI_Comm comm, const CurvedPiece& piece, const std::vector<std::uint8_t>& boundary);

  const StandardData& vertices() const { return vertices_; }
  /// Background ids of the owned vertices, followed by ids of the owned mid-sides, which begin at first_mid_side().
  const std::vector<std::int64_t>& ids() const { return ids_; }
  std::int64_t first_mid_side() const { return first_mid_side_; }
  const std::vector<Vec3>& places() const { return V_; }
  const std::vector<std::uint8_t>& boundary() const { return boundary_; }
  /// Numbers in the whole mesh of the nodes of the local mesh.
  const std::vector<std::int64_t>& own_numbers() const { return own_numbers_; }

 private:
  StandardData vertices_;
  std::vector<std::int64_t> ids_, own_numbers_;
  std::int64_t first_mid_side_ = 0;
  std::vector<Vec3> V_;
  std::vector<std::uint8_t> boundary_;
};

OwnedNodes::OwnedNodes(MPI_Comm comm, const CurvedPiece& piece, const std::vector<std::uint8_t>& boundary)
    : vertices_(standard_data(comm, piece.mesh, &boundary)),
      ids_(vertices_.owners.ids()),
      own_numbers_(vertices_.own_number),
      boundary_(vertices_.boundary) {
  std::int64_t n_vertices = static_cast<std::int64_t>(ids_.size());
  MPI_Allreduce(MPI_IN_PLACE, &n_vertices, 1, MPI_INT64_T, MPI_SUM, comm);
  first_mid_side_ = ids_.empty() ? 0 : ids_.back() + 1;
  MPI_Allreduce(MPI_IN_PLACE, &first_mid_side_, 1, MPI_INT64_T, MPI_MAX, comm);
  for (const std::int64_t e : piece.edges.global()) ids_.push_back(first_mid_side_ + e);
  for (const std::int64_t e : piece.edges.exchange().tell(piece.edges.global())) own_numbers_.push_back(n_vertices + e);
  V_ = places_of_owned(vertices_.owners, piece.mesh.mesh);
  V_.resize(ids_.size());
  boundary_.resize(ids_.size());
  const std::size_t first = vertices_.number.size(), n_corners = piece.mesh.mesh.V.size();
  piece.edges.exchange().ask(
      [&](std::size_t e) {
        const Vec3 x = piece.curved.mesh.V[n_corners + e] + piece.shift;
        return std::array{x.x(), x.y(), x.z()};
      },
      [&](std::size_t k, const std::array<double, 3>& x) { V_[first + k] = Vec3(x[0], x[1], x[2]); });
  piece.edges.exchange().ask([&](std::size_t e) { return piece.curved.is_curved[e]; },
                             [&](std::size_t k, char is) { boundary_[first + k] = static_cast<std::uint8_t>(is); });
}

/// Returns the values at the owned nodes. Collective.
template <std::size_t n>
std::vector<std::array<double, n>> values_of(const VertexOwners& owners, std::size_t n_owned,
                                             const VertexValues& of_vertices, std::size_t a,
                                             const MidSideValues& of_mid_sides) {
  auto values = values_of_owned<n>(owners, of_vertices, of_vertices.arrays[a]);
  std::array<double, n> none;
  none.fill(of_vertices.arrays[a].none);
  values.resize(n_owned, none);
  for (std::size_t i = 0; i < of_mid_sides.edges.size(); ++i)
    std::copy_n(of_mid_sides.arrays[a].begin() + static_cast<std::ptrdiff_t>(n * i), n,
                values[owners.ids().size() + of_mid_sides.edges[i]].begin());
  return values;
}

/// Adds 0/1 arrays for the nodes of each patch and of the boundary, as in files of `umtet export`.
void add_node_sets(const SolverPart& part, const CurvedSolverPart& curved, const OwnerExchange& nodes,
                   std::map<std::string, FieldValues>& data) {
  std::vector<std::string> names = part.patches;
  names.emplace_back(kWholeBoundary);
  for (std::size_t p = 0; p < names.size(); ++p) {
    std::vector<std::uint8_t> is_in(nodes.n_items(), 0);
    for (std::size_t f = 0; f < curved.boundary.size(); ++f) {
      if (p < part.patches.size() && part.patch[f] != static_cast<int>(p)) continue;
      for (const int node : curved.boundary[f]) is_in[node] = 1;
    }
    data[names[p]] = nodes.any(is_in);
  }
}

/// Adds the values of an array at the nodes of the local mesh.
void add_values(const VertexOwners& owners, const OwnerExchange& nodes, const VertexValues& of_vertices, std::size_t a,
                const MidSideValues& of_mid_sides, std::map<std::string, FieldValues>& data) {
  const VertexValues::Array& array = of_vertices.arrays[a];
  if (array.n_components == 3) {
    std::vector<Vec3> values;
    for (const auto& x : nodes.tell(values_of<3>(owners, nodes.n_owned(), of_vertices, a, of_mid_sides)))
      values.emplace_back(x[0], x[1], x[2]);
    data[array.name] = std::move(values);
  } else {
    data[array.name] = flat(nodes.tell(values_of<1>(owners, nodes.n_owned(), of_vertices, a, of_mid_sides)));
  }
}

}  // namespace

void write_whole_vtu(MPI_Comm comm, const fs::path& path, const CurvedPiece& piece,
                     const std::vector<std::uint8_t>& boundary, const VertexValues& of_vertices,
                     const MidSideValues& of_mid_sides) {
  const OwnedNodes nodes(comm, piece, boundary);
  const auto values = [&](std::size_t a) {
    const VertexOwners& owners = nodes.vertices().owners;
    const std::size_t n = nodes.ids().size();
    return of_vertices.arrays[a].n_components == 3 ? flat(values_of<3>(owners, n, of_vertices, a, of_mid_sides))
                                                   : flat(values_of<1>(owners, n, of_vertices, a, of_mid_sides));
  };
  const auto node = [&](std::size_t t, std::size_t k) { return nodes.own_numbers()[piece.curved.mesh.C[t][k]]; };
  write_ordered_vtu(comm, path,
                    {.ids = nodes.ids(),
                     .first_mid_side = nodes.first_mid_side(),
                     .places = nodes.places(),
                     .boundary = nodes.boundary(),
                     .fields = of_vertices,
                     .values = values,
                     .mesh = piece.mesh,
                     .nodes_per_tet = 10,
                     .node = node});
}

std::vector<fs::path> write_curved_pvtu(MPI_Comm comm, const fs::path& pvtu, const CurvedPiece& piece,
                                        const PieceExtras& extras, const MidSideValues& of_mid_sides) {
  const StandardData data = standard_data(comm, piece.mesh);
  SolverPart part = solver_part(comm, piece.mesh, data.owners);
  divide_part(part, extras);
  QuadraticTetMesh mesh = piece.curved.mesh;
  std::copy(piece.mesh.mesh.V.begin(), piece.mesh.mesh.V.end(), mesh.V.begin());
  for (std::size_t i = piece.mesh.mesh.V.size(); i < mesh.V.size(); ++i) mesh.V[i] += piece.shift;
  const CurvedSolverPart curved = curved_solver_part(comm, piece.mesh, data.owners, piece.edges, piece.curved, part);
  const OwnerExchange nodes = node_exchange(data.owners, piece.edges);
  std::map<std::string, FieldValues> of_nodes = {
      {"global_vertex", curved.global_node},
      {"owner", std::vector<std::int64_t>(curved.owner.begin(), curved.owner.end())}};
  for (std::size_t a = 0; a < extras.values.arrays.size(); ++a)
    add_values(data.owners, nodes, extras.values, a, of_mid_sides, of_nodes);
  add_node_sets(part, curved, nodes, of_nodes);
  const std::map<std::string, FieldValues> of_tets = {{"background_tet", piece.mesh.background_tet},
                                                      {"global_tet", part.global_tet},
                                                      {"mean_ratio", mean_ratios(piece.mesh.mesh)}};
  return write_pvtu(comm, pvtu, !mesh.C.empty(), of_nodes, of_tets,
                    [&](const fs::path& own) { write_vtu(own, mesh, of_nodes, of_tets); });
}

}  // namespace umtet
