#include "distributed/solver/curved_solver_part.h"

namespace umtet {
namespace {

std::vector<std::int64_t> global_nodes(const PartEdges& edges, const SolverPart& part) {
  std::vector<std::int64_t> numbers = part.global_vertex;
  for (const std::int64_t e : edges.exchange().tell(edges.global()))
    numbers.push_back(static_cast<std::int64_t>(part.n_vertices) + e);
  return numbers;
}

std::vector<QuadraticTriangle> curved_faces(const std::vector<Triangle>& faces, const PartEdges& edges,
                                            std::size_t n_vertices) {
  const auto mid_side = [&](int a, int b) { return static_cast<int>(n_vertices) + edges.number()(a, b); };
  std::vector<QuadraticTriangle> curved;
  curved.reserve(faces.size());
  for (const auto& [a, b, c] : faces) curved.push_back({a, b, c, mid_side(a, b), mid_side(b, c), mid_side(c, a)});
  return curved;
}

}  // namespace

CurvedSolverPart curved_solver_part(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners,
                                    const PartEdges& edges, const CurvedParts& curved, const SolverPart& part) {
  const OwnerExchange nodes = node_exchange(owners, edges);
  const std::size_t n_vertices = mesh.mesh.V.size();
  CurvedSolverPart made;
  made.n_nodes = part.n_vertices + static_cast<std::size_t>(edges.n_all());
  made.global_node = global_nodes(edges, part);
  made.sharers = sharers_of(comm, nodes);
  made.owner = first_ranks(comm, nodes.n_items(), made.sharers);
  made.solver_node = numbers_by_rank(comm, made.owner, nodes);
  made.boundary = curved_faces(part.boundary, edges, n_vertices);
  made.boundary_nodes = part.boundary_vertices;
  for (std::size_t e = 0; e < curved.is_curved.size(); ++e)
    if (curved.is_curved[e]) made.boundary_nodes.push_back(static_cast<int>(n_vertices + e));
  return made;
}

OwnerExchange node_exchange(const VertexOwners& owners, const PartEdges& edges) {
  return joined(owners.exchange(), edges.exchange());
}

}  // namespace umtet
