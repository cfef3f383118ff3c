#include "distributed/io/standard_data.h"

#include <array>

#include "distributed/certify/part_boundary.h"
#include "distributed/exchange/id_order.h"

namespace umtet {
namespace {

constexpr std::size_t kVerticesPerPiece = 1 << 16;  // half a megabyte

std::vector<std::uint8_t> owned_on_boundary(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners) {
  std::vector<std::uint8_t> on(mesh.mesh.V.size(), 0);
  for (const Triangle& f : boundary_of_parts(comm, mesh, owners).triangles)
    for (const int v : f) on[v] = 1;
  return owners.exchange().any_of_owned(on);
}

}  // namespace

StandardData standard_data(MPI_Comm comm, const DistributedMesh& mesh, const std::vector<std::uint8_t>* boundary) {
  StandardData data{VertexOwners(comm, mesh), {}, {}, {}};
  data.boundary =
      boundary ? data.owners.exchange().any_of_owned(*boundary) : owned_on_boundary(comm, mesh, data.owners);
  data.number = IdOrder(comm, data.owners.ids(), kVerticesPerPiece).numbers();
  data.own_number = data.owners.tell(data.number);
  return data;
}

std::vector<std::uint8_t> on_boundary(MPI_Comm comm, const DistributedMesh& mesh) {
  const VertexOwners owners(comm, mesh);
  return owners.tell(owned_on_boundary(comm, mesh, owners));
}

std::vector<Vec3> places_of_owned(const VertexOwners& owners, const TetMesh& mesh) {
  std::vector<Vec3> places(owners.ids().size());
  owners.ask(
      [&](std::size_t v) {
        return std::array{mesh.V[v].x(), mesh.V[v].y(), mesh.V[v].z()};
      },
      [&](std::size_t k, const std::array<double, 3>& x) { places[k] = Vec3(x[0], x[1], x[2]); });
  return places;
}

}  // namespace umtet
