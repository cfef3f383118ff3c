#pragma once

#include <cstddef>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Boundary faces of a tet mesh, which belong to exactly one tet, and the numbers of defective faces.
struct BoundaryFaces {
  std::vector<Triangle> triangles;  ///< outward for positively oriented tets; ascending in (tet, local face)
  std::vector<int> tets;            ///< the tet behind each triangle
  std::size_t n_overused = 0;       ///< faces of more than two tets
  std::size_t n_same_side = 0;      ///< faces with both tets on the same side: the tets overlap, or one is inverted
};

/// Lists the boundary faces of a tet mesh.
/// \throw std::invalid_argument naming the first tet with an index outside 0 .. n_vertices - 1 or a repeated vertex
/// Cost: O(n_tets), with 5 bytes of working memory per tet. Uses threads over tets and vertices; the result does not
/// depend on them.
/// @param only  per vertex, whether the faces with this least vertex are examined; null: all faces are
BoundaryFaces boundary_faces(const std::vector<Tet>& C, std::size_t n_vertices,
                             const std::vector<char>* only = nullptr);

/// A connected component of a surface; pieces that touch in a vertex form one component.
struct SurfaceComponent {
  std::size_t n_vertices = 0, n_edges = 0, n_faces = 0;
  long euler_characteristic = 0;  ///< n_vertices - n_edges + n_faces
  long genus = 0;                 ///< 1 - chi / 2; meaningful for a closed manifold
  double area = 0;                ///< model units^2
  double volume = 0;              ///< enclosed, model units^3; negative for the wall of a cavity
};

/// Topology and size of a triangle surface, computed from its indices.
struct SurfaceTopology {
  std::vector<SurfaceComponent> components;  ///< ascending by least vertex
  std::vector<int> component;                ///< component of each face
  std::vector<int> vertices;                 ///< vertices used by the faces, ascending
  std::size_t n_edges = 0;
  std::size_t n_nonmanifold_edges = 0;     ///< edges without exactly two faces
  std::size_t n_misoriented_edges = 0;     ///< edges with two faces that run along it in the same direction
  std::size_t n_nonmanifold_vertices = 0;  ///< vertices whose faces form more than one fan
  long euler_characteristic = 0;
  long genus = 0;  ///< sum over components
  double area = 0;
  /// Every edge has two consistently oriented faces, and the faces of every vertex form one fan.
  bool closed_manifold = false;
};

/// Area of a triangle.
double face_area(const Vec3& a, const Vec3& b, const Vec3& c);

/// Computes the topology of a triangle surface.
/// \throw std::invalid_argument for an index out of range or a face with a repeated vertex
SurfaceTopology surface_topology(const std::vector<Vec3>& V, const std::vector<Triangle>& faces);

}  // namespace umtet
