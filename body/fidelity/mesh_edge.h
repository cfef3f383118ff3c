#pragma once

#include <memory>
#include <vector>

#include "common/vec3.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"

namespace umtet {

/// The edge length h of a mesh as a function of position: a constant, or the edge length of the background at the
/// nearest vertex of the boundary.
class MeshEdge {
 public:
  MeshEdge(double h) : nominal_(h), least_(h) {}  // NOLINT(google-explicit-constructor): a number is an edge length
  /// @param nominal  edge length that reports state
  /// @param h        edge length at each vertex, model units
  /// \throw std::invalid_argument  no vertices
  MeshEdge(double nominal, const std::vector<Vec3>& vertices, std::vector<double> h);

  bool is_uniform() const { return !tree_; }
  double at(const Vec3& x) const;
  double nominal() const { return nominal_; }
  double least() const { return least_; }
  /// Returns at() for each point.
  std::vector<double> at(const std::vector<Vec3>& points) const;

 private:
  double nominal_, least_;
  std::shared_ptr<const NeighbourTree> tree_;
  std::vector<double> of_vertex_;
};

}  // namespace umtet
