#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/polled_loops.h"
#include "distributed/certify/part_boundary.h"
#include "distributed/exchange/collect.h"
#include "distributed/exchange/id_order.h"
#include "distributed/exchange/piece_chain.h"
#include "distributed/second_order/part_second_order.h"
#include "mesh/certify/certificate.h"
#include "mesh/core/asking_psi.h"
#include "mesh/second_order/second_order_measures.h"

namespace umtet {
namespace {

constexpr std::size_t kTetsPerPiece = 128 * kCurvedTetsPerSum;  // a megabyte
constexpr std::size_t kFacesPerPiece = kValuesPerPoll / 4;

struct MeasuredTet {
  std::int64_t id;
  double mean;  ///< JacobianBounds::mean
};

struct OrderedFace {
  std::int64_t id;
  double place[6][3];
};

class CurvedCertificate {
 public:
  CurvedCertificate(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners, const PartEdges& edges,
                    const CurvedParts& curved, ImplicitFunctionRef psi)
      : comm_(comm),
        mesh_(mesh),
        edges_(edges),
        curved_(curved),
        psi_(psi),
        n_corners_(mesh.mesh.V.size()),
        boundary_(boundary_of_parts(comm, mesh, owners)) {}

  SecondOrderCertificate operator()(std::size_t n_owned_vertices, double h, double coordinate_rounding) {
    made_.h = h;
    made_.coordinate_rounding = coordinate_rounding;
    made_.n_nodes = sum(comm_, n_owned_vertices) + static_cast<std::size_t>(edges_.n_all());
    measure_jacobians();
    measure_mid_sides();
    measure_faces();
    return made_;
  }

 private:
  double greatest(double x) const {
    MPI_Allreduce(MPI_IN_PLACE, &x, 1, MPI_DOUBLE, MPI_MAX, comm_);
    return x;
  }
  void measure_jacobians();
  void measure_mid_sides();
  void measure_faces();
  int mid_side(int a, int b) const { return edges_.number()(a, b); }

  MPI_Comm comm_;
  const DistributedMesh& mesh_;
  const PartEdges& edges_;
  const CurvedParts& curved_;
  ImplicitFunctionRef psi_;
  const std::size_t n_corners_;
  const PartBoundary boundary_;
  SecondOrderCertificate made_;
};

void CurvedCertificate::measure_jacobians() {
  const IdOrder order(comm_, mesh_.background_tet, kTetsPerPiece);
  PieceChain sums(comm_, 1);
  JacobianMeasure own;
  for (std::size_t round = 0; round < order.n_rounds(); ++round) {
    const std::size_t first = order.begin(round), end = order.begin(round + 1);
    std::vector<JacobianBounds> bounds(end - first);
    polled_parallel_for(bounds.size(), kTetsPerPiece, {}, [&](std::size_t i) {
      bounds[i] = jacobian_bounds(nodes_of(curved_.mesh, curved_.mesh.C[first + i]));
    });
    for (const JacobianBounds& b : bounds) own.add(b);
    const auto piece = order.piece<MeasuredTet>(round, [&](std::size_t t) {
      return MeasuredTet{mesh_.background_tet[t], bounds[t - first].mean};
    });
    std::vector<double> blocks((piece.size() + kCurvedTetsPerSum - 1) / kCurvedTetsPerSum, 0);
    for (std::size_t i = 0; i < piece.size(); ++i) blocks[i / kCurvedTetsPerSum] += piece[i].mean / 6;
    sums.pass([&](std::vector<double>& so_far) {
      for (const double block : blocks) so_far[0] += block;
    });
  }
  made_.volume = sums.end()[0];
  made_.n_nonpositive_jacobians = sum(comm_, own.n_nonpositive);
  made_.min_scaled_jacobian_lower = -greatest(-own.lower);
  made_.min_scaled_jacobian_upper = -greatest(-own.upper);
}

/// The owner of each edge checks that all ranks with the edge have the same mid-side, and measures its distance from
/// psi = 0.
void CurvedCertificate::measure_mid_sides() {
  struct Said {
    char is_on_boundary;
    std::array<double, 3> place;
  };
  std::vector<char> is_on_boundary(edges_.ends().size(), 0);
  for (const Triangle& f : boundary_.triangles) {
    for (int k = 0; k < 3; ++k) is_on_boundary[mid_side(f[k], f[(k + 1) % 3])] = 1;
  }
  std::vector<Said> owned(edges_.owned().size());
  std::vector<char> is_known(owned.size(), 0), is_torn(owned.size(), 0);
  edges_.exchange().ask(
      [&](std::size_t e) {
        const Vec3& x = curved_.mesh.V[n_corners_ + e];
        return Said{is_on_boundary[e], {x.x(), x.y(), x.z()}};
      },
      [&](std::size_t k, const Said& said) {
        is_torn[k] |= is_known[k] && owned[k].place != said.place;
        owned[k].place = said.place;
        owned[k].is_on_boundary |= said.is_on_boundary;
        is_known[k] = 1;
      });
  std::vector<std::size_t> on;
  for (std::size_t k = 0; k < owned.size(); ++k) {
    if (owned[k].is_on_boundary) on.push_back(k);
  }
  std::vector<double> distance(on.size());
  for_each_asking(psi_, on.size(), kValuesPerPoll, {},
                  [&](std::size_t i) { distance[i] = slope_distance(psi_, Vec3(owned[on[i]].place.data())); });
  const double tolerance = kVertexTolerance * made_.h + made_.coordinate_rounding;
  double most = 0;
  std::size_t n_off = 0;
  for (const double d : distance) {
    most = std::max(most, d);
    n_off += d > tolerance;
  }
  made_.n_torn_edges = sum(comm_, static_cast<std::size_t>(std::count(is_torn.begin(), is_torn.end(), 1)));
  made_.n_boundary_mid_sides = sum(comm_, on.size());
  made_.n_mid_sides_off_surface = sum(comm_, n_off);
  made_.max_mid_side_distance_over_h = greatest(most) / made_.h;
}

void CurvedCertificate::measure_faces() {
  const IdOrder order(comm_, boundary_.id, kFacesPerPiece);
  PieceChain squares(comm_, 1);
  double most = 0;
  for (std::size_t round = 0; round < order.n_rounds(); ++round) {
    const auto faces = order.piece<OrderedFace>(round, [&](std::size_t f) {
      const Triangle& t = boundary_.triangles[f];
      OrderedFace face{boundary_.id[f], {}};
      for (std::size_t k = 0; k < 3; ++k) {
        const auto m = static_cast<std::size_t>(mid_side(t[k], t[(k + 1) % 3]));
        std::copy_n(curved_.mesh.V[static_cast<std::size_t>(t[k])].data(), 3, face.place[k]);
        std::copy_n(curved_.mesh.V[n_corners_ + m].data(), 3, face.place[3 + k]);
      }
      return face;
    });
    std::vector<std::array<double, 4>> distances(faces.size());
    for_each_asking(psi_, faces.size(), kFacesPerPiece, {}, [&](std::size_t i) {
      std::array<Vec3, 6> x;
      for (std::size_t k = 0; k < 6; ++k) x[k] = Vec3(faces[i].place[k]);
      distances[i] = curved_face_distances(psi_, x, made_.h);
    });
    squares.pass([&](std::vector<double>& so_far) {
      for (const auto& four : distances) {
        for (const double d : four) most = std::max(most, d), so_far[0] += d * d;
      }
    });
  }
  const double all = squares.end()[0];
  made_.max_face_distance_over_h = greatest(most) / made_.h;
  made_.rms_face_distance_over_h = order.n() == 0 ? 0 : std::sqrt(all / (4 * static_cast<double>(order.n()))) / made_.h;
}

}  // namespace

SecondOrderCertificate certify_curved_parts(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners,
                                            const PartEdges& edges, const CurvedParts& curved, ImplicitFunctionRef psi,
                                            double h, double coordinate_rounding) {
  return CurvedCertificate(comm, mesh, owners, edges, curved, psi)(owners.ids().size(), h, coordinate_rounding);
}

}  // namespace umtet
