#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "mesh/io/solver_mesh.h"
#include "reconstruct/triangles/triangle_mesh.h"

// Conversion between half-edge meshes of OpenMesh and meshes of umtet.
namespace umtet {

/// Name of the face property with the number of a patch.
inline constexpr const char* kOpenMeshPatch = "patch";
/// Name of the vertex property with the index of a node of the tet mesh.
inline constexpr const char* kOpenMeshNode = "node";

struct OpenMeshTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
/// A triangle mesh in double precision.
using OpenMeshSurface = OpenMesh::TriMesh_ArrayKernelT<OpenMeshTraits>;

/// Returns the triangles of a half-edge mesh, without elements that are marked as deleted. Labels are the values of the
/// face property `patch` if it exists.
/// @tparam HalfEdges  a TriMesh_ArrayKernelT with any traits
template <class HalfEdges>
TriangleMesh from_openmesh(const HalfEdges& mesh) {
  TriangleMesh made;
  std::vector<int> id(mesh.n_vertices(), -1);
  for (auto v = mesh.vertices_sbegin(); v != mesh.vertices_end(); ++v) {
    id[static_cast<std::size_t>(v->idx())] = static_cast<int>(made.V.size());
    const auto& x = mesh.point(*v);
    made.V.emplace_back(x[0], x[1], x[2]);
  }
  OpenMesh::FPropHandleT<int> patch;
  const bool has_patches = mesh.get_property_handle(patch, kOpenMeshPatch);
  for (auto f = mesh.faces_sbegin(); f != mesh.faces_end(); ++f) {
    Triangle corners{};
    int k = 0;
    for (auto v = mesh.cfv_iter(*f); v.is_valid() && k < 3; ++v)
      corners[static_cast<std::size_t>(k++)] = id[static_cast<std::size_t>(v->idx())];
    made.F.push_back(corners);
    if (has_patches) made.labels.push_back(mesh.property(patch, *f));
  }
  return made;
}

/// Returns the boundary of a tet mesh as half-edges. Its vertices are the nodes that faces use as corners, in their
/// order. The property `patch` of a face is the number of its patch, and `node` of a vertex is its index in mesh.nodes.
/// \throw std::invalid_argument if the boundary is not a 2-manifold, or if require_consistent() throws it
inline OpenMeshSurface to_openmesh(const SolverMesh& mesh) {
  require_consistent(mesh);
  OpenMeshSurface made;
  OpenMesh::FPropHandleT<int> patch;
  OpenMesh::VPropHandleT<int> node;
  made.add_property(patch, kOpenMeshPatch);
  made.add_property(node, kOpenMeshNode);
  std::vector<OpenMesh::VertexHandle> handle(mesh.nodes.size());
  std::vector<char> is_used(mesh.nodes.size(), 0);
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    const std::array<int, 6> ids = mesh.face(f);
    for (std::size_t k = 0; k < 3; ++k) is_used[static_cast<std::size_t>(ids[k])] = 1;
  }
  for (std::size_t v = 0; v < mesh.nodes.size(); ++v) {
    if (!is_used[v]) continue;
    const Vec3& x = mesh.nodes[v];
    handle[v] = made.add_vertex({x.x(), x.y(), x.z()});
    made.property(node, handle[v]) = static_cast<int>(v);
  }
  std::size_t n_refused = 0;
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    const std::array<int, 6> ids = mesh.face(f);
    const auto corner = [&](std::size_t k) { return handle[static_cast<std::size_t>(ids[k])]; };
    const OpenMesh::FaceHandle face = made.add_face(corner(0), corner(1), corner(2));
    if (face.is_valid()) {
      made.property(patch, face) = mesh.patches[static_cast<std::size_t>(mesh.face_patch[f])].number;
    } else {
      ++n_refused;
    }
  }
  if (n_refused > 0) {
    throw std::invalid_argument("to_openmesh: " + std::to_string(n_refused) + " faces do not fit a manifold");
  }
  return made;
}

}  // namespace umtet
