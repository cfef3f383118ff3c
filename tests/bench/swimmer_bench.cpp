// swimmer_bench [CELLS_ACROSS ...]: one Stokes solve around a sphere in the swimmer's channel: tets, CPU seconds,
// iterations, memory, and the drag over that without walls. Multiples of 8; default 16 24 32.

#include <fmt/format.h>
#include <sys/resource.h>

#include <cstdlib>

#include "pipeline/examples/stokes.h"
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

void run(int n) {
  const umtet::testing::SphereInChannel channel(n);
  const std::vector<umtet::Vec3>& V = channel.mesh.V;
  const double start = cpu_seconds();
  umtet::StokesSolver solver(int(V.size()), channel.mesh.C, {});
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

}  // namespace

int main(int argc, char** argv) {
  fmt::print("published, to first order in a / l: {:.4f}\n", umtet::testing::wall_corrected_drag(1. / 6));
  if (argc == 1) {
    for (const int n : {16, 24, 32}) run(n);
  }
  for (int k = 1; k < argc; ++k) run(std::atoi(argv[k]));
}
