#include "distributed/io/standard_data.h"

#include "distributed/id_order.h"
#include "distributed/part_boundary.h"

namespace umtet {
namespace {

constexpr std::size_t kVerticesPerPiece = 1 << 16;  // half a megabyte

}  // namespace

StandardData standard_data(MPI_Comm comm, const DistributedMesh& mesh, const std::vector<std::uint8_t>* boundary) {
  StandardData data{VertexOwners(comm, mesh), {}, {}, {}};
  data.boundary.assign(data.owners.ids().size(), 0);
  std::vector<std::uint8_t> on;
  if (!boundary) {
    on.assign(mesh.mesh.V.size(), 0);
    for (const Triangle& f : boundary_of_parts(comm, mesh, data.owners).triangles)
      for (const int v : f) on[v] = 1;
    boundary = &on;
  }
  data.owners.ask([&](std::size_t v) { return (*boundary)[v]; },
                  [&](std::size_t k, std::uint8_t is_on) { data.boundary[k] |= is_on; });
  data.number = IdOrder(comm, data.owners.ids(), kVerticesPerPiece).numbers();
  data.own_number = data.owners.tell(data.number);
  return data;
}

std::vector<std::uint8_t> on_boundary(MPI_Comm comm, const DistributedMesh& mesh) {
  const StandardData data = standard_data(comm, mesh);
  return data.owners.tell(data.boundary);
}

}  // namespace umtet
