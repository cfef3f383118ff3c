#include "examples/swimmer/swim.h"

#include <fmt/format.h>

#include <stdexcept>

namespace umtet {
namespace {

double force_along_z(const StokesSolver& solver, const StokesFlow& flow, std::span<const int> body) {
  const std::vector<Vec3> forces = solver.forces(flow);
  double sum = 0;
  for (const int i : body) sum += forces[std::size_t(i)].z();
  return sum;
}

}  // namespace

std::vector<std::string> problems(const SwimParams& p) {
  std::vector<std::string> all = problems(p.stokes);
  if (!(p.dt > 0)) all.push_back(fmt::format("dt = {}: must be > 0", p.dt));
  if (p.steps < 1) all.push_back(fmt::format("steps = {}: must be >= 1", p.steps));
  return all;
}

ForceFreeMotion force_free_motion(StokesSolver& solver, std::span<const Vec3> velocity, std::span<const int> body) {
  if (body.empty()) throw std::invalid_argument("a body without vertices");
  std::vector<Vec3> v(velocity.size(), Vec3::Zero()), e_z = v;
  for (const int i : body) {
    v[std::size_t(i)] = velocity[std::size_t(i)];
    e_z[std::size_t(i)] = Vec3::UnitZ();
  }
  ForceFreeMotion motion;
  motion.deformation = solver.solve(v);
  motion.translation = solver.solve(e_z);
  motion.F_deformation = force_along_z(solver, motion.deformation, body);
  motion.F_translation = force_along_z(solver, motion.translation, body);
  if (!(motion.F_translation < 0)) throw std::invalid_argument("a body that no fluid resists");
  motion.velocity = -motion.F_deformation / motion.F_translation;
  return motion;
}

std::vector<SwimStep> swim(int n_vertices, std::span<const Tet> background, const FluidMesher& mesher,
                           const SwimParams& params, const SwimObserver& observer) {
  if (const auto broken = problems(params); !broken.empty()) throw std::invalid_argument(broken.front());
  StokesSolver solver(n_vertices, background, params.stokes);
  std::vector<SwimStep> steps;
  double z0 = 0;
  for (int k = 0; k <= params.steps; ++k) {
    const Swimmer swimmer(params.t0 + k * params.dt, z0);
    const FluidMesh mesh = mesher(swimmer);  // (i)
    std::vector<int> fixed = mesh.walls;
    fixed.insert(fixed.end(), mesh.swimmer.begin(), mesh.swimmer.end());
    solver.assemble(mesh.V, mesh.tets, fixed);
    std::vector<Vec3> v(mesh.V.size(), Vec3::Zero());
    for (const int i : mesh.swimmer) v[std::size_t(i)] = swimmer.deformation_velocity(mesh.V[std::size_t(i)]);
    const ForceFreeMotion motion = force_free_motion(solver, v, mesh.swimmer);  // (ii) to (iv)
    steps.push_back({swimmer.time(), z0, motion.velocity, motion.F_deformation, motion.F_translation});
    if (observer && !observer(steps.back(), mesh, motion)) break;
    z0 += params.dt * motion.velocity;  // (v)
  }
  return steps;
}

}  // namespace umtet
