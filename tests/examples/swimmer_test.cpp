#include "examples/swimmer/swimmer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "examples/swimmer/swim.h"
#include "tests/support/box_tets.h"

namespace umtet {
namespace {

using testing::box_tets;
using testing::tets_where;
using testing::vertices_where;

constexpr double kTimes[] = {-8, -5.3, -2, 0, 1.7, 4, 8};

/// Points of the surface on rays from the axis, all around and along the swimmer.
std::vector<Vec3> surface_points(const Swimmer& swimmer) {
  std::vector<Vec3> all;
  for (int k = -7; k <= 7; ++k) {
    const Vec3 axis(0, 0, swimmer.position() + k), out(std::cos(k), std::sin(k), .1);
    double inside = 0, outside = 6;
    while (outside - inside > 1e-14 * outside) {
      const double middle = (inside + outside) / 2;
      (swimmer.value(axis + middle * out) < 0 ? inside : outside) = middle;
      if (middle == inside && middle == outside) break;
    }
    all.push_back(axis + inside * out);
  }
  return all;
}

TEST(Swimmer, SurfaceIsWhereTheProductOfTheTwoPartsIsOne) {
  // arctan A + arctan B = pi / 2 for A, B > 0 exactly when A B = 1.
  for (const double t : kTimes) {
    const Swimmer swimmer(t, 1.5);
    for (const Vec3& x : surface_points(swimmer)) {
      const double r2 = x.x() * x.x() + x.y() * x.y(), z = x.z() - 1.5;
      const double A = r2 / 2 + z * z / 64 - 1, c = 2.5 * std::cos(std::numbers::pi * t / 16);
      EXPECT_GT(A, 0);
      EXPECT_NEAR(A * (r2 + (z - t) * (z - t) - c * c), 1, 1e-10);
    }
    EXPECT_LT(swimmer.value({0, 0, 1.5}), 0);
    EXPECT_GT(swimmer.value({6, 0, 1.5}), 0);
  }
}

TEST(Swimmer, DerivativesAreThoseOfDifferences) {
  const double e = 1e-5;
  for (const double t : kTimes) {
    const Swimmer swimmer(t, -.4);
    for (const Vec3& x : surface_points(swimmer)) {
      const ImplicitFunctionRef psi = swimmer;
      const Vec3 g = psi.gradient(x);
      const Mat3 H = psi.hessian(x);
      for (int c = 0; c < 3; ++c) {
        const Vec3 d = e * Vec3::Unit(c);
        EXPECT_NEAR(g[c], (swimmer.value(x + d) - swimmer.value(x - d)) / (2 * e), 1e-8);
        EXPECT_LT((H.col(c) - (psi.gradient(x + d) - psi.gradient(x - d)) / (2 * e)).norm(), 1e-7);
      }
      EXPECT_NEAR(swimmer.time_derivative(x), (Swimmer(t + e, -.4).value(x) - Swimmer(t - e, -.4).value(x)) / (2 * e),
                  1e-8);
    }
  }
}

TEST(Swimmer, SurfaceGoesWhereItsVelocitySays) {
  for (const double t : kTimes) {
    const Swimmer swimmer(t, 2);
    for (const Vec3& x : surface_points(swimmer)) {
      const Vec3 v = swimmer.deformation_velocity(x), n = ImplicitFunctionRef(swimmer).gradient(x).normalized();
      EXPECT_LT((v - v.dot(n) * n).norm(), 1e-12 * (1 + v.norm()));
      const double dt = 1e-4;
      const auto left_behind = [&](double s) {
        return std::abs(Swimmer(t + s, 2 + s).value(x + s * (v + Vec3::UnitZ())));
      };
      EXPECT_LT(left_behind(dt), 3e-7);  // second order: a velocity that is 1 % off leaves more
      EXPECT_LT(left_behind(dt / 2), .3 * left_behind(dt) + 1e-13);
    }
  }
}

/// A channel of cubes and a swimmer made of those whose centre it holds: no more than the time loop needs.
struct Blocks {
  TetMesh mesh = box_tets({-4, -4, -12}, {4, 4, 12}, {8, 8, 24});

  FluidMesh around(const Swimmer& swimmer) const {
    FluidMesh fluid{mesh.V, {}, {}, {}};
    const auto in_fluid = [&](const Vec3& x) { return swimmer.value(x.array().floor() + .5) > 0; };
    fluid.tets = tets_where(mesh, in_fluid);
    std::vector<char> is_fluid(mesh.C.size(), 0), of_fluid(mesh.V.size(), 0), of_body = of_fluid;
    for (const int t : fluid.tets) is_fluid[std::size_t(t)] = 1;
    for (std::size_t t = 0; t < mesh.C.size(); ++t) {
      for (const int i : mesh.C[t]) (is_fluid[t] ? of_fluid : of_body)[std::size_t(i)] = 1;
    }
    for (std::size_t i = 0; i < mesh.V.size(); ++i) {
      if (of_fluid[i] && of_body[i]) fluid.swimmer.push_back(int(i));
    }
    fluid.walls =
        vertices_where(mesh, [](const Vec3& x) { return x.head<2>().cwiseAbs().maxCoeff() == 4 || x.z() == -12; });
    return fluid;
  }
};

TEST(Swim, DeformationThatIsATranslationIsUndone) {
  const Blocks blocks;
  const FluidMesh fluid = blocks.around(Swimmer(0, 0));
  StokesSolver solver(int(fluid.V.size()), blocks.mesh.C, {});
  std::vector<int> fixed = fluid.walls;
  fixed.insert(fixed.end(), fluid.swimmer.begin(), fluid.swimmer.end());
  solver.assemble(fluid.V, fluid.tets, fixed);
  EXPECT_NEAR(force_free_motion(solver, std::vector<Vec3>(fluid.V.size(), Vec3(0, 0, .7)), fluid.swimmer).velocity, -.7,
              1e-6);
  EXPECT_THROW(force_free_motion(solver, std::vector<Vec3>(fluid.V.size(), Vec3(0, 0, 1)), {}), std::invalid_argument);
}

TEST(Swim, EveryStepIsFreeOfForceAndFollowsTheOneBefore) {
  const Blocks blocks;
  const SwimParams params{.t0 = -3, .dt = .5, .steps = 2, .stokes = {.viscosity = .8, .tolerance = 1e-9}};
  int seen = 0;
  const SwimObserver observer = [&](const SwimStep& step, const FluidMesh& fluid, const ForceFreeMotion& motion) {
    ++seen;
    EXPECT_LT(motion.F_translation, 0);
    // What the two flows sum to, solved at once, leaves no axial force.
    StokesSolver solver(int(fluid.V.size()), blocks.mesh.C, params.stokes);
    std::vector<int> fixed = fluid.walls;
    fixed.insert(fixed.end(), fluid.swimmer.begin(), fluid.swimmer.end());
    solver.assemble(fluid.V, fluid.tets, fixed);
    const Swimmer swimmer(step.t, step.z0);
    std::vector<Vec3> velocity(fluid.V.size(), Vec3::Zero());
    for (const int i : fluid.swimmer) {
      const std::size_t s = std::size_t(i);
      velocity[s] = swimmer.deformation_velocity(fluid.V[s]) + step.velocity * Vec3::UnitZ();
    }
    const StokesFlow flow = solver.solve(velocity);
    const std::vector<Vec3> forces = solver.forces(flow);
    double force = 0, by_reciprocity = 0;
    const std::vector<Vec3> of_translation = solver.forces(motion.translation);
    for (const int i : fluid.swimmer) {
      const std::size_t s = std::size_t(i);
      force += forces[s].z();
      by_reciprocity += of_translation[s].dot(swimmer.deformation_velocity(fluid.V[s]));
    }
    EXPECT_LT(std::abs(force), 1e-6 * std::abs(motion.F_translation));
    // Lorentz: the force of one flow does the same work on the other's velocity.
    EXPECT_NEAR(by_reciprocity, motion.F_deformation, 1e-6 * std::abs(motion.F_translation));
    return seen < 3;
  };
  const std::vector<SwimStep> steps = swim(
      int(blocks.mesh.V.size()), blocks.mesh.C, [&](const Swimmer& s) { return blocks.around(s); }, params, observer);
  ASSERT_EQ(steps.size(), 3u);
  EXPECT_EQ(steps[0].t, -3);
  EXPECT_EQ(steps[0].z0, 0);
  for (std::size_t k = 1; k < steps.size(); ++k) {
    EXPECT_DOUBLE_EQ(steps[k].z0, steps[k - 1].z0 + .5 * steps[k - 1].velocity);
    EXPECT_DOUBLE_EQ(steps[k].t, steps[k - 1].t + .5);
  }
  for (const SwimStep& s : steps) std::printf("t = %.1f: z0 = %.4f, z0' = %.4f\n", s.t, s.z0, s.velocity);
  SwimParams backwards;
  backwards.dt = -1;
  EXPECT_THROW(swim(1, {}, {}, backwards), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
