// swimmer_bench [CELLS_ACROSS or TETS ...]: one Stokes solve around a sphere in the swimmer's channel: tets, CPU
// seconds, iterations, memory, and the drag over that without walls. Grids graded towards the sphere have multiples of
// 8 cells across, at most 1000 (default 16 24 32); a greater number is the tets of a universal mesh.

#include <fmt/format.h>
#include <sys/resource.h>

#include <cstdlib>

#include "examples/swimmer/channel_mesher.h"
#include "examples/swimmer/stokes.h"
#include "tests/support/domains.h"
#include "tests/support/sphere_in_channel.h"

namespace {

double cpu_seconds() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return double(use.ru_utime.tv_sec + use.ru_stime.tv_sec) + 1e-6 * double(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

double peak_gigabytes() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return 1e-6 * double(use.ru_maxrss);
}

/// The channel around a sphere: all tets, those of the fluid, who is held.
struct Channel {
  const std::vector<umtet::Vec3>& V;
  const std::vector<umtet::Tet>& tets;
  const std::vector<int>&fluid, &sphere, &walls;
};

void run(const Channel& channel) {
  const std::vector<umtet::Vec3>& V = channel.V;
  const double start = cpu_seconds();
  umtet::StokesSolver solver(int(V.size()), channel.tets, {});
  const double patterned = cpu_seconds();
  std::vector<int> fixed = channel.walls;
  fixed.insert(fixed.end(), channel.sphere.begin(), channel.sphere.end());
  solver.assemble(V, channel.fluid, fixed);
  const double assembled = cpu_seconds();
  std::vector<umtet::Vec3> velocity(V.size(), umtet::Vec3::Zero());
  for (const int i : channel.sphere) velocity[std::size_t(i)] = umtet::Vec3::UnitZ();
  const umtet::StokesFlow flow = solver.solve(velocity);
  const double solved = cpu_seconds();
  const std::vector<umtet::Vec3> forces = solver.forces(flow);
  double drag = 0;
  for (const int i : channel.sphere) drag -= forces[std::size_t(i)].z() / (6 * std::numbers::pi);
  fmt::print(
      "{:8} tets  pattern {:5.2f} s  assemble {:5.2f} s  solve {:6.2f} s  {:3} iterations  {:5.2f} GB  drag {:.4f}\n",
      channel.fluid.size(), patterned - start, assembled - patterned, solved - assembled, flow.krylov.iterations,
      peak_gigabytes(), drag);
}

void run_grid(int n) {
  const umtet::testing::SphereInChannel c(n);
  run({c.mesh.V, c.mesh.C, c.fluid, c.sphere, c.walls});
}

void run_universal_mesh(double n_tets) {
  const umtet::ChannelMesher mesher(n_tets);
  const auto sphere = umtet::testing::sphere();
  const umtet::FluidMesh fluid = mesher.mesh(umtet::Complement(sphere));
  run({fluid.V, mesher.tets(), fluid.tets, fluid.swimmer, fluid.walls});
}

}  // namespace

int main(int argc, char** argv) {
  fmt::print("published, to first order in a / l: {:.4f}\n", umtet::testing::wall_corrected_drag(1. / 6));
  if (argc == 1) {
    for (const int n : {16, 24, 32}) run_grid(n);
  }
  for (int k = 1; k < argc; ++k) {
    const int n = std::atoi(argv[k]);
    n > 1000 ? run_universal_mesh(n) : run_grid(n);
  }
}
