//                                umtet example 3
//
// Sample runs:  ex3
//               ex3 0.05 20
//
// Description:  A ball that moves and grows, meshed at every instant in one background mesh. Each mesh comes from
//               the one before, with what has changed: the ids of a solver's unknowns are those of the background,
//               and stay.
#include <cstdio>
#include <cstdlib>

#include "mesh/moving_mesh.h"

struct Ball {
  umtet::Vec3 centre;
  double radius;
  double value(const umtet::Vec3& x) const { return (x - centre).squaredNorm() - radius * radius; }
  umtet::Vec3 gradient(const umtet::Vec3& x) const { return 2 * (x - centre); }
  umtet::Mat3 hessian(const umtet::Vec3&) const { return 2 * umtet::Mat3::Identity(); }
};

int main(int argc, char* argv[]) {
  const double h = argc > 1 ? std::atof(argv[1]) : 0.1;
  const int n_steps = argc > 2 ? std::atoi(argv[2]) : 10;

  // 1. One background for all times, and a mesher that remembers.
  const umtet::Box box(umtet::Vec3::Constant(-1), umtet::Vec3(3, 1, 1));
  umtet::UniversalMesh mesher(umtet::BackgroundMesh(umtet::a15(), box, h));

  // 2. The pattern of all matrices of the family: who meets whom in the background.
  const umtet::SparsityPattern pattern = umtet::sparsity_pattern(mesher.background());
  std::printf("%zu background vertices, %zu entries\n", pattern.row_begin.size() - 1, pattern.column.size());

  // 3. The instants.
  for (int step = 0; step <= n_steps; ++step) {
    const double t = static_cast<double>(step) / n_steps;
    const Ball psi{umtet::Vec3(2 * t, 0, 0), .5 + .2 * t};
    const umtet::UmUpdate& update = mesher.update(psi);
    if (update.mesh.status != umtet::UmStatus::Success) {
      std::fprintf(stderr, "t = %g: no mesh: %s\n", t, update.mesh.evidence.what.c_str());
      return 1;
    }
    std::printf("t = %.2f: %zu tets, %zu came, %zu went, %zu vertices moved\n", t, update.mesh.submesh.mesh.C.size(),
                update.tets_entered.size(), update.tets_left.size(), update.vertices_moved.size());
  }
  return 0;
}
