#include "mesh/sizes/graded_zero_set.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"
#include "mesh/implicit/cut_tets.h"
#include "mesh/octree/graded_mesh.h"

namespace umtet {
namespace {

// Tets whose vertices are looked at together.
constexpr std::size_t kPart = 1 << 12;

CutTets cut_tets(const GradedMesh& mesh, ImplicitFunctionRef psi, const Context& context) {
  const auto n_vertices = static_cast<std::size_t>(mesh.n_vertices());
  const std::vector<double> value =
      values_at(psi, n_vertices, context, [&](std::size_t v) { return mesh.position(static_cast<std::int64_t>(v)); });
  const auto n_tets = static_cast<std::size_t>(mesh.n_tets());
  std::vector<std::vector<std::array<std::int64_t, 4>>> of_part((n_tets + kPart - 1) / kPart);
  polled_parallel_for(of_part.size(), 64, context, [&](std::size_t part) {
    GradedMesh::Reader reader = mesh.reader();
    for (std::size_t t = part * kPart; t < std::min(n_tets, (part + 1) * kPart); ++t) {
      const auto tet = reader.tet(static_cast<std::int64_t>(t));
      const auto n_inside = std::count_if(tet.begin(), tet.end(), [&](std::int64_t v) { return value[v] < 0; });
      if (n_inside > 0 && n_inside < 4) of_part[part].push_back(tet);
    }
  });
  CutTets cut;
  std::vector<int> number(n_vertices, -1);
  for (const auto& tets : of_part) {
    for (const auto& tet : tets) {
      Tet& corners = cut.tets.emplace_back();
      for (std::size_t k = 0; k < 4; ++k) {
        int& id = number[static_cast<std::size_t>(tet[k])];
        if (id < 0) {
          id = static_cast<int>(cut.x.size());
          cut.x.push_back(mesh.position(tet[k]));
          cut.psi.push_back(value[static_cast<std::size_t>(tet[k])]);
          cut.on_boundary.push_back(mesh.on_boundary(tet[k]) ? 1 : 0);
        }
        corners[k] = id;
      }
    }
  }
  return cut;
}

}  // namespace

ZeroSetTopology graded_zero_set(ImplicitFunctionRef psi, const Box& box, const SizeField& sizes, double share,
                                double finest, double steepest, const Context& context) {
  // A cube without a zero may have tets with one beyond it: a cube's width is left.
  constexpr double kWidthsOff = 1;
  Grading grading{
      .box = box, .finest = share * finest, .size = {}, .tolerance = kSizeTolerance, .transition_sweeps = 0};
  grading.size = [&](const Vec3& x, double half) { return share * cube_size(sizes, x, half); };
  grading.wanted = [&](const Vec3& x, double half) {
    const bool meets_box = ((x - box.center()).cwiseAbs() - .5 * box.sizes()).maxCoeff() < half;
    return meets_box && !(std::abs(psi.value(x)) > steepest * (std::sqrt(3.) + 2 * kWidthsOff) * half);
  };
  return zero_set_topology(cut_tets(GradedMesh(grading), psi, context));
}

}  // namespace umtet
