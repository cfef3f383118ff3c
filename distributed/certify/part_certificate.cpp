#include "distributed/certify/part_certificate.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/polled_loops.h"
#include "distributed/certify/part_boundary.h"
#include "distributed/certify/part_meetings.h"
#include "distributed/certify/part_tets.h"
#include "distributed/exchange/collect.h"
#include "distributed/exchange/id_order.h"
#include "distributed/exchange/phase.h"
#include "distributed/exchange/piece_chain.h"
#include "distributed/mesh/vertex_owners.h"
#include "mesh/certify/boundary_surface.h"
#include "mesh/certify/surface_measures.h"
#include "mesh/core/asking_psi.h"

namespace umtet {
namespace {

// A foot point takes about six values of psi: a few hundredths of a second in total for a cheap psi.
constexpr std::size_t kFacesPerPiece = kValuesPerPoll;
// Edge of the cubes in which faces are tested for intersection, in edges of the mesh: a face is in one or two cubes.
constexpr double kEdgesPerCube = 4;

/// A face in the order of ids.
struct OrderedFace {
  std::int64_t id;
  std::int64_t piece;
  double place[3][3];

  Vec3 corner(std::size_t k) const { return {place[k][0], place[k][1], place[k][2]}; }
};

/// An entry of a vertex or a face, with its id, for the lists of a certificate.
struct SentFault {
  std::int64_t is_face, id, kind;
  double where[3], distance;
};
struct SentFoot {
  std::int64_t id;
  double where[3];
};

void put(const Vec3& x, double (&to)[3]) { std::copy_n(x.data(), 3, to); }
Vec3 vector(const double (&x)[3]) { return {x[0], x[1], x[2]}; }

/// Distances from psi = 0 of the vertices and faces that this rank measures.
class OwnDistances {
 public:
  OwnDistances(const MeshCertificate& certificate) : h_(certificate.h), rounding_(certificate.coordinate_rounding) {
    begin_distances(own_);
  }
  void add(std::int64_t id, const Vec3& x, double distance) {
    add_vertex(x, distance, h_, rounding_, own_);
    keep(0, id);
  }
  void add(std::int64_t id, const FaceMeasure& face) {
    add_face(face, h_, own_);
    keep(1, id);
  }
  /// Joins the distances of all ranks. Collective.
  void join(MPI_Comm comm, MeshCertificate::Boundary& boundary) const;

 private:
  void keep(std::int64_t is_face, std::int64_t id) {
    for (const BoundaryFault& f : own_.faults) {
      faults_.push_back({is_face, id, static_cast<std::int64_t>(f.kind), {}, f.distance});
      put(f.where, faults_.back().where);
    }
    for (const Vec3& x : own_.far_feet) {
      feet_.push_back({id, {}});
      put(x, feet_.back().where);
    }
    own_.faults.clear();
    own_.far_feet.clear();
  }

  double h_, rounding_;
  MeshCertificate::Boundary own_;
  std::vector<SentFault> faults_;
  std::vector<SentFoot> feet_;
};

void OwnDistances::join(MPI_Comm comm, MeshCertificate::Boundary& boundary) const {
  // The least cosine has the opposite sign, so that all values are maxima.
  double most[4] = {*own_.max_vertex_distance_over_h, *own_.max_centroid_distance_over_h, own_.max_centroid_distance,
                    -*own_.min_cos_normal};
  MPI_Allreduce(MPI_IN_PLACE, most, 4, MPI_DOUBLE, MPI_MAX, comm);
  std::uint64_t n[2] = {own_.n_cos_below_half, own_.n_unprojected_faces};
  MPI_Allreduce(MPI_IN_PLACE, n, 2, MPI_UINT64_T, MPI_SUM, comm);
  begin_distances(boundary);
  boundary.max_vertex_distance_over_h = most[0];
  boundary.max_centroid_distance_over_h = most[1];
  boundary.max_centroid_distance = most[2];
  boundary.min_cos_normal = -most[3];
  boundary.n_cos_below_half = n[0];
  boundary.n_unprojected_faces = n[1];
  std::vector<SentFault> faults = gathered(comm, faults_);
  std::vector<SentFoot> feet = gathered(comm, feet_);
  broadcast(comm, faults);
  broadcast(comm, feet);
  std::sort(faults.begin(), faults.end(), [](const SentFault& a, const SentFault& b) {
    return std::pair(a.is_face, a.id) < std::pair(b.is_face, b.id);
  });
  std::sort(feet.begin(), feet.end(), [](const SentFoot& a, const SentFoot& b) { return a.id < b.id; });
  for (const SentFault& f : faults)
    boundary.faults.push_back({static_cast<BoundaryFault::Kind>(f.kind), vector(f.where), f.distance});
  for (const SentFoot& f : feet) boundary.far_feet.push_back(vector(f.where));
}

class PartCertificate {
 public:
  PartCertificate(MPI_Comm comm, const DistributedMesh& mesh, std::optional<ImplicitFunctionRef> psi)
      : comm_(comm), mesh_(mesh), psi_(psi), owners_(comm, mesh) {}

  MeshCertificate operator()(double h, double coordinate_rounding);

 private:
  void compare_with_positive_faces();
  void measure_faces(OwnDistances* distances);
  void measure_vertices(OwnDistances& distances) const;

  MPI_Comm comm_;
  const DistributedMesh& mesh_;
  const std::optional<ImplicitFunctionRef> psi_;
  const VertexOwners owners_;
  PartBoundary boundary_;
  BoundaryTopology topology_;
  std::vector<ComponentVolume> volumes_;  ///< volumes of the pieces of the boundary
  MeshCertificate certificate_;
};

/// Compares both as sets of triples. A boundary face has one tet, and each tet is on one rank, so the sets are equal if
/// they are equal on each rank.
void PartCertificate::compare_with_positive_faces() {
  using Face = std::pair<std::int64_t, Triangle>;
  const auto face = [](std::int64_t id, Triangle f) {
    std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
    return Face(id, f);
  };
  std::vector<Face> positive, single;
  for (std::size_t f = 0; f < mesh_.positive_faces.size(); ++f) {
    const Triangle& t = mesh_.positive_faces[f];
    positive.push_back(face(face_id(mesh_, static_cast<std::size_t>(mesh_.positive_tets[f]), t), t));
  }
  std::sort(positive.begin(), positive.end());
  for (std::size_t f = 0; f < boundary_.id.size(); ++f) single.push_back(face(boundary_.id[f], boundary_.triangles[f]));
  certificate_.boundary.equals_positive_faces = sum(comm_, positive == single ? 0 : 1) == 0;
  certificate_.n_positive_faces = sum(comm_, positive.size());
}

/// Measures areas and volumes, and distances if there is a psi, in the order of the faces.
void PartCertificate::measure_faces(OwnDistances* distances) {
  const std::size_t n_pieces = topology_.pieces.size();
  const IdOrder order(comm_, boundary_.id, kFacesPerPiece);
  PieceChain sums(comm_, 1 + 3 * n_pieces);  // the gap; area, volume and its magnitude of each piece
  for (std::size_t round = 0; round < order.n_rounds(); ++round) {
    const std::vector<OrderedFace> faces = order.piece<OrderedFace>(round, [&](std::size_t f) {
      OrderedFace face{boundary_.id[f], topology_.piece[f], {}};
      for (std::size_t k = 0; k < 3; ++k) put(mesh_.mesh.V[boundary_.triangles[f][k]], face.place[k]);
      return face;
    });
    std::vector<FaceMeasure> measures(faces.size());
    if (distances) {
      for_each_asking(*psi_, faces.size(), kFacesPerPiece, {}, [&](std::size_t i) {
        measures[i] = measure_face(*psi_, faces[i].corner(0), faces[i].corner(1), faces[i].corner(2), certificate_.h);
      });
      for (std::size_t i = 0; i < faces.size(); ++i) distances->add(faces[i].id, measures[i]);
    }
    sums.pass([&](std::vector<double>& so_far) {
      for (std::size_t i = 0; i < faces.size(); ++i) {
        const Vec3 a = faces[i].corner(0), b = faces[i].corner(1), c = faces[i].corner(2);
        const auto piece = static_cast<std::size_t>(faces[i].piece);
        double* const of_piece = &so_far[1 + 3 * piece];
        of_piece[0] += face_area(a, b, c);
        ComponentVolume volume{of_piece[1], of_piece[2]};
        volume.add(vector(topology_.pieces[piece].corner), a, b, c);
        of_piece[1] = volume.sum;
        of_piece[2] = volume.magnitude;
        if (distances && measures[i].found) add_gap(measures[i], so_far[0]);
      }
    });
  }
  const std::vector<double>& all = sums.end();
  for (std::size_t p = 0; p < n_pieces; ++p) {
    certificate_.boundary.area += all[1 + 3 * p];
    volumes_.push_back({all[2 + 3 * p], all[3 + 3 * p]});
  }
  if (distances) certificate_.boundary.gap_over_volume = all[0] / certificate_.volume;
}

void PartCertificate::measure_vertices(OwnDistances& distances) const {
  struct Place {
    double x[3];
  };
  std::vector<Vec3> V(owners_.ids().size());
  owners_.ask(
      [&](std::size_t v) {
        Place place{};
        put(mesh_.mesh.V[v], place.x);
        return place;
      },
      [&](std::size_t k, const Place& place) { V[k] = vector(place.x); });
  std::vector<std::size_t> on;
  for (std::size_t k = 0; k < V.size(); ++k) {
    if (topology_.is_on_boundary[k]) on.push_back(k);
  }
  std::vector<double> distance(on.size());
  for_each_asking(*psi_, on.size(), kValuesPerPoll, {},
                  [&](std::size_t i) { distance[i] = vertex_distance(*psi_, V[on[i]]); });
  for (std::size_t i = 0; i < on.size(); ++i) distances.add(owners_.ids()[on[i]], V[on[i]], distance[i]);
}

MeshCertificate PartCertificate::operator()(double h, double coordinate_rounding) {
  certificate_.coordinate_rounding = coordinate_rounding;
  measure_tets_of_parts(comm_, mesh_, h, certificate_);
  certificate_.n_vertices = sum(comm_, owners_.ids().size());
  boundary_ = boundary_of_parts(comm_, mesh_, owners_);
  topology_ = topology_of_parts(comm_, mesh_, owners_, boundary_);
  MeshCertificate::Boundary& b = certificate_.boundary;
  b.n_faces = sum(comm_, boundary_.id.size());
  b.n_overused_faces = boundary_.n_overused;
  b.n_same_side_faces = boundary_.n_same_side;
  b.n_nonmanifold_edges = topology_.n_nonmanifold_edges;
  b.n_nonmanifold_vertices = topology_.n_nonmanifold_vertices;
  b.closed_manifold = b.n_nonmanifold_edges == 0 && topology_.n_misoriented_edges == 0 &&
                      b.n_nonmanifold_vertices == 0 && b.n_overused_faces == 0 && b.n_same_side_faces == 0;
  b.components = static_cast<int>(topology_.pieces.size());
  b.euler_characteristic = topology_.euler_characteristic;
  b.genus = topology_.genus;
  compare_with_positive_faces();
  if (psi_) {
    OwnDistances distances(certificate_);
    measure_vertices(distances);
    measure_faces(&distances);
    distances.join(comm_, b);
  } else {
    measure_faces(nullptr);
  }
  b.n_self_intersections = meetings_of_parts(comm_, mesh_, boundary_, kEdgesPerCube * certificate_.h);
  if (b.closed_manifold && b.n_self_intersections == 0)
    b.n_wrongly_nested = wrongly_nested_of_parts(comm_, mesh_, boundary_, topology_, volumes_);
  return std::move(certificate_);
}

}  // namespace

MeshCertificate certify_parts(MPI_Comm comm, const DistributedMesh& mesh, double h,
                              std::optional<ImplicitFunctionRef> psi, double coordinate_rounding) {
  begin_phase("certify");
  std::uint64_t n_tets = mesh.mesh.C.size();
  MPI_Allreduce(MPI_IN_PLACE, &n_tets, 1, MPI_UINT64_T, MPI_SUM, comm);
  if (n_tets == 0) throw std::invalid_argument("certify: a mesh with tets is needed");
  return PartCertificate(comm, mesh, psi)(h, coordinate_rounding);
}

}  // namespace umtet
