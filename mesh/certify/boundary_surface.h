#pragma once

#include <cstddef>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// The faces that only one tet has, and what is wrong with the others.
struct BoundaryFaces {
  std::vector<Triangle> triangles;  ///< outward for positively oriented tets; ascending in (tet, local face)
  std::vector<int> tets;            ///< the tet behind each triangle
  std::size_t n_overused = 0;       ///< faces of more than two tets
  std::size_t n_same_side = 0;      ///< faces of two tets on the same side of it: they overlap, or one is inverted
};

/// \throw std::invalid_argument naming the first tet with an index outside 0 .. n_vertices - 1 or a repeated vertex
/// Cost: O(n_tets), 5 bytes per tet while it runs; threads over tets and vertices, result independent of them.
/// @param only  per vertex, whether faces whose least vertex it is are looked at; null: all of them
BoundaryFaces boundary_faces(const std::vector<Tet>& C, std::size_t n_vertices,
                             const std::vector<char>* only = nullptr);

/// One piece of a surface; pieces that touch in a vertex are one.
struct SurfaceComponent {
  std::size_t n_vertices = 0, n_edges = 0, n_faces = 0;
  long euler_characteristic = 0;  ///< n_vertices - n_edges + n_faces
  long genus = 0;                 ///< 1 - chi / 2; meaningful for a closed manifold
  double area = 0;                ///< model units^2
  double volume = 0;              ///< enclosed, model units^3; negative for the wall of a cavity
};

/// Topology and size of a triangle surface, counted from its indices.
struct SurfaceTopology {
  std::vector<SurfaceComponent> components;  ///< ascending in their least vertex
  std::vector<int> component;                ///< of each face
  std::vector<int> vertices;                 ///< used by the faces, ascending
  std::size_t n_edges = 0;
  std::size_t n_nonmanifold_edges = 0;     ///< edges without exactly two faces
  std::size_t n_misoriented_edges = 0;     ///< edges with two faces that run along it in the same direction
  std::size_t n_nonmanifold_vertices = 0;  ///< vertices whose faces form more than one fan
  long euler_characteristic = 0;
  long genus = 0;  ///< sum over components
  double area = 0;
  /// Every edge has two faces, consistently oriented, and every vertex one fan.
  bool closed_manifold = false;
};

double face_area(const Vec3& a, const Vec3& b, const Vec3& c);

/// \throw std::invalid_argument for an index out of range or a face with a repeated vertex
SurfaceTopology surface_topology(const std::vector<Vec3>& V, const std::vector<Triangle>& faces);

}  // namespace umtet
