#include "distributed/solver/solver_part.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <numeric>

#include "distributed/certify/part_boundary.h"
#include "distributed/exchange/collect.h"
#include "distributed/exchange/id_order.h"

namespace umtet {
namespace {

constexpr std::size_t kPerPiece = 1 << 16;  // half a megabyte

/// A face in a message to rank 0.
struct MeasuredFace {
  std::int64_t id;
  double area;
  int piece;
};

/// Sorts the pieces of the boundary by area, the largest first. Areas are sums in the order of faces, as in
/// smooth_pieces(). Among equal areas, the piece with the first face is first.
/// @return the position of each piece in this order
std::vector<int> places_by_area(MPI_Comm comm, const DistributedMesh& mesh, const PartBoundary& boundary,
                                const BoundaryTopology& topology) {
  std::vector<MeasuredFace> faces;
  for (std::size_t f = 0; f < boundary.triangles.size(); ++f) {
    const Triangle& t = boundary.triangles[f];
    const Vec3 &a = mesh.mesh.V[t[0]], &b = mesh.mesh.V[t[1]], &c = mesh.mesh.V[t[2]];
    faces.push_back({boundary.id[f], (b - a).cross(c - a).norm() / 2, topology.piece[f]});
  }
  faces = gathered(comm, faces);
  std::sort(faces.begin(), faces.end(), [](const MeasuredFace& a, const MeasuredFace& b) { return a.id < b.id; });
  const std::size_t n = topology.pieces.size();
  std::vector<double> area(n, 0);
  for (const MeasuredFace& f : faces) area[static_cast<std::size_t>(f.piece)] += f.area;
  std::vector<int> order(n), place(n);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return area[a] != area[b] ? area[a] > area[b] : topology.pieces[a].first_face < topology.pieces[b].first_face;
  });
  for (std::size_t k = 0; k < n; ++k) place[order[k]] = static_cast<int>(k);
  MPI_Bcast(place.data(), static_cast<int>(n), MPI_INT, 0, comm);
  return place;
}

std::vector<int> vertices_on(const std::vector<Triangle>& boundary, std::size_t n_vertices,
                             const VertexOwners& owners) {
  std::vector<std::uint8_t> is_on(n_vertices, 0);
  for (const Triangle& f : boundary)
    for (const int v : f) is_on[v] = 1;
  is_on = owners.exchange().any(is_on);
  std::vector<int> vertices;
  for (std::size_t v = 0; v < n_vertices; ++v)
    if (is_on[v]) vertices.push_back(static_cast<int>(v));
  return vertices;
}

void divide(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners, SolverPart& part) {
  const PartBoundary boundary = boundary_of_parts(comm, mesh, owners);
  BoundaryTopology topology = topology_of_parts(comm, mesh, owners, boundary);
  part.boundary = boundary.triangles;
  part.boundary_vertices = vertices_on(part.boundary, mesh.mesh.V.size(), owners);
  const IdOrder faces(comm, boundary.id, kPerPiece);
  part.n_faces = faces.n();
  part.global_face = faces.numbers();
  part.patches = {"boundary"};
  part.patch.assign(part.boundary.size(), 0);
  if (topology.pieces.size() < 2) return;
  const std::vector<int> place = places_by_area(comm, mesh, boundary, topology);
  part.patches.clear();
  for (std::size_t p = 0; p < place.size(); ++p) part.patches.push_back("boundary_" + std::to_string(p + 1));
  for (std::size_t f = 0; f < part.patch.size(); ++f) part.patch[f] = place[topology.piece[f]];
}

}  // namespace

SolverPart solver_part(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners) {
  SolverPart part;
  const IdOrder vertices(comm, owners.ids(), kPerPiece), tets(comm, mesh.background_tet, kPerPiece);
  part.n_vertices = vertices.n();
  part.n_tets = tets.n();
  part.global_vertex = owners.tell(vertices.numbers());
  part.global_tet = tets.numbers();
  part.sharers = sharers_of(comm, owners.exchange());
  part.owner = first_ranks(comm, mesh.owner.size(), part.sharers);
  part.solver_vertex = numbers_by_rank(comm, part.owner, owners.exchange());
  divide(comm, mesh, owners, part);
  return part;
}

SolverPart solver_part(MPI_Comm comm, const DistributedMesh& mesh) {
  return solver_part(comm, mesh, VertexOwners(comm, mesh));
}

}  // namespace umtet
