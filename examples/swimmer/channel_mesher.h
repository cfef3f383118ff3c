#pragma once

#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"
#include "examples/swimmer/swim.h"

namespace umtet {

/// The fluid around a body in the channel of [Rangarajan2018, Section 4.3], 12 x 12 x 29.16 about the origin, as a part
/// of one universal mesh: A15 with flat walls (a15_box.h), fast mode with BackgroundBoundary::Wall. The end at z =
/// 14.58 is open; the other five faces are no-slip walls.
class ChannelMesher {
 public:
  /// @param n_tets  approximate number of tets in the background. \throw std::invalid_argument  n_tets <= 0, or too
  ///   many
  explicit ChannelMesher(double n_tets);

  const BackgroundMesh& background() const { return background_; }
  const std::vector<Tet>& tets() const { return tets_; }  ///< all tets of the background
  int n_vertices() const { return static_cast<int>(background_.n_vertices()); }

  /// Makes a mesh. Every mesh is certified, except for the volume between flat faces and the surface, which
  /// FluidMesh::volume_gap contains.
  /// @param fluid  negative in the fluid: Complement of the body's psi. Vertices of the body are FluidMesh::swimmer
  /// \throw MeshingImpossible  with status and position, CertificateFailed  with the first reason
  FluidMesh mesh(ImplicitFunctionRef fluid) const;
  FluidMesh operator()(
      const Swimmer& swimmer) const;  ///< the same; the message contains time and position of the swimmer

 private:
  BackgroundMesh background_;
  std::vector<Tet> tets_;
  std::vector<int> no_slip_;  ///< vertices on the five walls
};

}  // namespace umtet
