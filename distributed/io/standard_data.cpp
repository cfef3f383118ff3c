#include "distributed/io/standard_data.h"

#include "distributed/id_order.h"
#include "distributed/part_boundary.h"

namespace umtet {
namespace {

constexpr std::size_t kVerticesPerPiece = 1 << 16;  // half a megabyte

}  // namespace

StandardData standard_data(MPI_Comm comm, const DistributedMesh& mesh) {
  StandardData data{VertexOwners(comm, mesh), {}, {}, {}};
  data.boundary.assign(data.owners.ids().size(), 0);
  std::vector<char> on(mesh.mesh.V.size(), 0);
  for (const Triangle& f : boundary_of_parts(comm, mesh, data.owners).triangles)
    for (const int v : f) on[v] = 1;
  data.owners.ask([&](std::size_t v) { return on[v]; },
                  [&](std::size_t k, char is_on) { data.boundary[k] |= static_cast<std::uint8_t>(is_on); });
  data.number = IdOrder(comm, data.owners.ids(), kVerticesPerPiece).numbers();
  data.own_number = data.owners.tell(data.number);
  return data;
}

}  // namespace umtet
