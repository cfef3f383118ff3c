#include "mesh/second_order/second_order_certificate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "common/formatted.h"
#include "common/polled_loops.h"
#include "mesh/certify/boundary_surface.h"
#include "mesh/certify/certificate.h"
#include "mesh/core/asking_psi.h"
#include "mesh/second_order/jacobian_bounds.h"
#include "mesh/second_order/mid_side_numbers.h"
#include "mesh/second_order/second_order_measures.h"

namespace umtet {
namespace {

constexpr std::size_t kBlocksPerPoll = 1 << 7;

void measure_jacobians(const SecondOrderInput& input, SecondOrderCertificate& certificate) {
  // Sums are taken block by block: threads cannot change a result.
  const QuadraticTetMesh& mesh = *input.mesh;
  const std::size_t n = mesh.C.size(), n_blocks = (n + kCurvedTetsPerSum - 1) / kCurvedTetsPerSum;
  std::vector<JacobianMeasure> blocks(n_blocks);
  polled_parallel_for(n_blocks, kBlocksPerPoll, input.context, [&](std::size_t b) {
    const std::size_t end = std::min(n, (b + 1) * kCurvedTetsPerSum);
    for (std::size_t t = b * kCurvedTetsPerSum; t < end; ++t) blocks[b].add(jacobian_bounds(nodes_of(mesh, mesh.C[t])));
  });
  JacobianMeasure all;
  for (const JacobianMeasure& block : blocks) all.add(block);
  certificate.volume = all.volume;
  certificate.n_nonpositive_jacobians = all.n_nonpositive;
  certificate.min_scaled_jacobian_lower = all.lower;
  certificate.min_scaled_jacobian_upper = all.upper;
}

/// The mid-side of every edge, by number; counts the edges that have several.
std::vector<int> mid_sides(const QuadraticTetMesh& mesh, const MidSideNumbers& number, std::size_t& n_torn) {
  std::vector<int> of_edge(number.n_edges(), -1);
  std::vector<char> torn(number.n_edges(), 0);
  for (const QuadraticTet& tet : mesh.C) {
    for (int k = 0; k < 6; ++k) {
      const int e = number(tet[kMidSideEdge[k][0]], tet[kMidSideEdge[k][1]]);
      if (of_edge[e] < 0) of_edge[e] = tet[4 + k];
      torn[e] |= of_edge[e] != tet[4 + k];
    }
  }
  // A node of two edges tears them as well: they cannot both pass through it as the tets beside them do.
  std::vector<int> sorted = of_edge;
  std::sort(sorted.begin(), sorted.end());
  n_torn = static_cast<std::size_t>(std::count(torn.begin(), torn.end(), 1));
  for (std::size_t i = 1; i < sorted.size(); ++i) n_torn += sorted[i] == sorted[i - 1];
  return of_edge;
}

void measure_distances(const SecondOrderInput& input, const std::vector<QuadraticTriangle>& faces,
                       const std::vector<int>& nodes, SecondOrderCertificate& certificate) {
  const ImplicitFunctionRef psi = *input.psi;
  std::vector<double> at_node(nodes.size());
  std::vector<std::array<double, 4>> at_face(faces.size());
  for_each_asking(psi, nodes.size(), kValuesPerPoll, input.context,
                  [&](std::size_t i) { at_node[i] = slope_distance(psi, input.mesh->V[nodes[i]]); });
  for_each_asking(psi, faces.size(), kValuesPerPoll / 4, input.context, [&](std::size_t i) {
    std::array<Vec3, 6> x;
    for (std::size_t k = 0; k < 6; ++k) x[k] = input.mesh->V[faces[i][k]];
    at_face[i] = curved_face_distances(psi, x, input.h);
  });
  const double tolerance = kVertexTolerance * input.h + input.coordinate_rounding;
  double greatest = 0, greatest_at_face = 0, squares = 0;
  for (const double d : at_node) {
    greatest = std::max(greatest, d);
    certificate.n_mid_sides_off_surface += d > tolerance;
  }
  for (const auto& four : at_face) {
    for (const double d : four) greatest_at_face = std::max(greatest_at_face, d), squares += d * d;
  }
  certificate.max_mid_side_distance_over_h = greatest / input.h;
  certificate.max_face_distance_over_h = greatest_at_face / input.h;
  certificate.rms_face_distance_over_h =
      faces.empty() ? 0 : std::sqrt(squares / (4 * static_cast<double>(faces.size()))) / input.h;
}

std::vector<int> mid_sides_of(const std::vector<QuadraticTriangle>& faces) {
  std::vector<int> nodes;
  for (const QuadraticTriangle& f : faces) nodes.insert(nodes.end(), f.begin() + 3, f.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

Triangle rotated(Triangle f) {
  std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
  return f;
}

}  // namespace

SecondOrderCertificate certify_second_order(const SecondOrderInput& input) {
  if (!input.mesh || input.mesh->C.empty() || !(input.h > 0)) {
    throw std::invalid_argument("certify_second_order: a mesh with tets and a length h > 0 are needed");
  }
  const QuadraticTetMesh& mesh = *input.mesh;
  std::vector<Tet> C(mesh.C.size());
  std::vector<char> used(mesh.V.size(), 0);
  for (std::size_t t = 0; t < C.size(); ++t) {
    std::copy_n(mesh.C[t].begin(), 4, C[t].begin());
    for (const int v : mesh.C[t]) {
      if (v < 0 || v >= static_cast<int>(mesh.V.size())) {
        throw std::invalid_argument("certify_second_order: tet " + std::to_string(t) + " has a node out of range");
      }
      used[v] = 1;
    }
  }
  SecondOrderCertificate certificate;
  certificate.h = input.h;
  certificate.coordinate_rounding = input.coordinate_rounding;
  certificate.n_nodes = static_cast<std::size_t>(std::count(used.begin(), used.end(), 1));
  measure_jacobians(input, certificate);
  input.context.poll();
  const MidSideNumbers number(C, mesh.V.size());
  const std::vector<int> of_edge = mid_sides(mesh, number, certificate.n_torn_edges);
  input.context.poll();

  std::vector<Triangle> walls = input.wall_faces ? *input.wall_faces : std::vector<Triangle>{};
  for (Triangle& f : walls) f = rotated(f);
  std::sort(walls.begin(), walls.end());
  std::vector<QuadraticTriangle> all, fitted;
  for (const Triangle& f : boundary_faces(C, mesh.V.size()).triangles) {
    const auto mid = [&](int k) { return of_edge[number(f[k], f[(k + 1) % 3])]; };
    all.push_back({f[0], f[1], f[2], mid(0), mid(1), mid(2)});
    if (!std::binary_search(walls.begin(), walls.end(), rotated(f))) fitted.push_back(all.back());
  }
  certificate.n_boundary_mid_sides = mid_sides_of(all).size();
  if (input.psi) measure_distances(input, fitted, mid_sides_of(fitted), certificate);
  return certificate;
}

std::vector<std::string> failures(const SecondOrderCertificate& c, std::size_t n_named) {
  std::vector<std::string> reasons;
  if (c.n_nonpositive_jacobians > 0) {
    reasons.push_back(formatted("%zu tets of second order have a Jacobian that is not proved to be positive",
                                c.n_nonpositive_jacobians));
  }
  if (c.n_torn_edges > 0) {
    reasons.push_back(formatted("%zu edges do not have one mid-side that all their tets share", c.n_torn_edges));
  }
  if (c.n_mid_sides_off_surface > n_named) {
    reasons.push_back(formatted("%zu mid-sides of boundary edges are off psi = 0, the farthest %.3g h",
                                c.n_mid_sides_off_surface, *c.max_mid_side_distance_over_h));
  }
  return reasons;
}

}  // namespace umtet
