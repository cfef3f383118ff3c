#pragma once

#include <functional>
#include <span>
#include <vector>

#include "examples/swimmer/stokes.h"
#include "examples/swimmer/swimmer.h"

namespace umtet {

/// The result of a mesher for the time loop: the channel around a swimmer, in numbers of the background.
struct FluidMesh {
  std::vector<Vec3> V;       ///< all vertices of the background; vertices of the fluid at their current positions
  std::vector<int> tets;     ///< tets of the background in the fluid
  std::vector<int> swimmer;  ///< vertices on the swimmer's surface
  std::vector<int> walls;    ///< vertices on the channel's no-slip faces
  double volume_gap =
      0;  ///< volume between the swimmer's flat faces and psi = 0, relative to the volume within the faces
};
using FluidMesher = std::function<FluidMesh(const Swimmer&)>;

/// The two flows of eq. (20) around a body, and the velocity along z that leaves it free of force along z.
struct ForceFreeMotion {
  StokesFlow deformation;  ///< (u^phi, p^phi): the surface moves as it deforms
  StokesFlow translation;  ///< (u^z, p^z): the body moves with e_z
  double F_deformation;    ///< force of the fluid on the body, along z; eq. (21)
  double F_translation;    ///< < 0
  double velocity;         ///< -F_deformation / F_translation
};

/// @param velocity velocity of deformation, by vertex; read at vertices of the body.
/// @param body     vertices, fixed in the solver's last assemble().
/// \throw StokesError; std::invalid_argument  there is no vertex, or the body meets no resistance
ForceFreeMotion force_free_motion(StokesSolver& solver, std::span<const Vec3> velocity, std::span<const int> body);

struct SwimParams {
  double t0 = -8;  ///< the bulge is at the tail
  double dt = 1;   ///< > 0; "approximately one unit"
  int steps = 16;  ///< >= 1: one stroke
  StokesParams stokes;
};

/// Returns every broken constraint, not just the first.
std::vector<std::string> problems(const SwimParams&);

struct SwimStep {
  double t, z0, velocity, F_deformation, F_translation;
};

/// Receives every step with its mesh and flows; returns false to stop.
using SwimObserver = std::function<bool(const SwimStep&, const FluidMesh&, const ForceFreeMotion&)>;

/// Performs steps (i) to (v) of [Rangarajan2018, Section 4.3]: mesh, two flows, forces, z0' and a forward Euler step.
///
/// @param background all tets of the universal mesh of the channel: one sparsity pattern for all steps.
/// @return one row per time t0, t0 + dt, ...; steps + 1 rows unless the observer stopped.
/// \throw StokesError, std::invalid_argument, and the exceptions of the mesher
std::vector<SwimStep> swim(int n_vertices, std::span<const Tet> background, const FluidMesher& mesher,
                           const SwimParams& params, const SwimObserver& observer = {});

}  // namespace umtet
