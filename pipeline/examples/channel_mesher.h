#pragma once

#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"
#include "pipeline/examples/swim.h"

namespace umtet {

/// The fluid around a body in the channel of [Rangarajan2018, Section 4.3], 12 x 12 x 29.16 about the origin, as a
/// part of one universal mesh: A15 with flat walls (a15_box.h), fast mode with BackgroundBoundary::Wall. The end at z = 14.58 is open,
/// the other five faces are walls without slip.
class ChannelMesher {
 public:
  /// @param n_tets  about as many in the background. \throw std::invalid_argument for n_tets <= 0, or too many
  explicit ChannelMesher(double n_tets);

  const BackgroundMesh& background() const { return background_; }
  const std::vector<Tet>& tets() const { return tets_; }  ///< all of the background
  int n_vertices() const { return static_cast<int>(background_.n_vertices()); }

  /// Every mesh is certified, but for the volume that flat faces may miss: FluidMesh::volume_gap tells it.
  /// @param fluid  negative in the fluid: Complement of the body's psi. Vertices of the body are FluidMesh::swimmer
  /// \throw MeshingImpossible with status and place, CertificateFailed with the first reason
  FluidMesh mesh(ImplicitFunctionRef fluid) const;
  FluidMesh operator()(const Swimmer& swimmer) const;  ///< the same; the message has time and place of the swimmer

 private:
  BackgroundMesh background_;
  std::vector<Tet> tets_;
  std::vector<int> no_slip_;  ///< vertices on the five walls
};

}  // namespace umtet
