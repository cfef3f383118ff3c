#include "distributed/certify/part_certificate.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <vector>

#include "mesh/sizes/body_size.h"
#include "mesh/universal_mesh.h"
#include "tests/distributed/ranks.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using testing::AnalyticDomain;
using testing::rank;

/// Every number of a certificate, bit by bit.
std::vector<std::uint64_t> bits(const MeshCertificate& c) {
  std::vector<std::uint64_t> all;
  const auto real = [&](double x) { all.push_back(std::bit_cast<std::uint64_t>(x)); };
  const auto count = [&](auto n) { all.push_back(static_cast<std::uint64_t>(n)); };
  const auto place = [&](const Vec3& x) { real(x[0]), real(x[1]), real(x[2]); };
  const auto maybe = [&](const std::optional<double>& x) { count(x.has_value()), real(x.value_or(0)); };
  count(c.n_tets), count(c.n_vertices), count(c.n_positive_faces), count(c.n_wall_faces);
  real(c.volume);
  const auto& q = c.quality;
  real(q.min), real(q.p001), real(q.p01), real(q.mean), real(q.dihedral_min_deg), real(q.dihedral_max_deg);
  count(q.n_inverted);
  const auto& b = c.boundary;
  count(b.n_faces), count(b.n_overused_faces), count(b.n_same_side_faces);
  count(b.n_nonmanifold_edges), count(b.n_nonmanifold_vertices), count(b.closed_manifold);
  count(b.n_self_intersections), count(b.n_wrongly_nested);
  count(b.equals_positive_faces.has_value()), count(b.equals_positive_faces.value_or(false));
  count(b.n_moved_wall_vertices), count(b.components), count(b.euler_characteristic), count(b.genus);
  real(b.area);
  maybe(b.max_vertex_distance_over_h), maybe(b.max_centroid_distance_over_h), real(b.max_centroid_distance);
  maybe(b.min_cos_normal), maybe(b.gap_over_volume);
  count(b.n_cos_below_half), count(b.n_unprojected_faces);
  count(b.faults.size());
  for (const BoundaryFault& f : b.faults) count(f.kind), place(f.where), real(f.distance);
  count(b.far_feet.size());
  for (const Vec3& x : b.far_feet) place(x);
  real(c.h), real(c.coordinate_rounding);
  return all;
}

/// What happens to a mesh before it is certified, by ids of the background.
struct Damage {
  std::function<Vec3(std::int64_t vertex, const Vec3& x)> place = [](std::int64_t, const Vec3& x) { return x; };
  std::function<bool(std::int64_t tet)> is_lost = [](std::int64_t) { return false; };
  std::function<bool(std::int64_t tet)> is_turned = [](std::int64_t) { return false; };
};

/// Tets, their faces and their places go, turn or move. Vertices stay, whether a tet uses them or not.
void damage(const Damage& by, const std::vector<std::int64_t>& vertex, std::vector<std::int64_t>& tet, TetMesh& mesh,
            std::vector<Triangle>& faces, std::vector<int>& face_tets) {
  for (std::size_t v = 0; v < mesh.V.size(); ++v) mesh.V[v] = by.place(vertex[v], mesh.V[v]);
  std::vector<int> number(tet.size(), -1);
  std::size_t n = 0;
  for (std::size_t t = 0; t < tet.size(); ++t) {
    if (by.is_lost(tet[t])) continue;
    number[t] = static_cast<int>(n);
    tet[n] = tet[t];
    mesh.C[n] = mesh.C[t];
    if (by.is_turned(tet[n])) std::swap(mesh.C[n][0], mesh.C[n][1]);
    ++n;
  }
  tet.resize(n);
  mesh.C.resize(n);
  std::size_t m = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const int t = number[static_cast<std::size_t>(face_tets[f])];
    if (t < 0) continue;
    faces[m] = faces[f];
    face_tets[m++] = t;
  }
  faces.resize(m);
  face_tets.resize(m);
}

/// Vertices that no tet has any more go.
void drop_unused(DistributedMesh& part) {
  std::vector<int> number(part.mesh.V.size(), -1);
  for (const Tet& t : part.mesh.C)
    for (const int v : t) number[v] = 0;
  std::size_t n = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(n);
    part.mesh.V[n] = part.mesh.V[v];
    part.background_vertex[n] = part.background_vertex[v];
    part.owner[n++] = part.owner[v];
  }
  part.mesh.V.resize(n);
  part.background_vertex.resize(n);
  part.owner.resize(n);
  for (Tet& t : part.mesh.C)
    for (int& v : t) v = number[v];
  for (Triangle& f : part.positive_faces)
    for (int& v : f) v = number[v];
}

struct Case {
  BackgroundMesh background;
  AnalyticDomain domain;
  FastParams params = {};
  double h = 0;
  bool with_psi = true;
  double rounding = 0;
};

/// @return that of all ranks, compared with that of one process on rank 0
MeshCertificate expect_same(const Case& c, const Damage& by = {}) {
  DistributedMesh part = distributed_mesh(MPI_COMM_WORLD, c.background, c.domain, c.params);
  EXPECT_EQ(part.status, PartsStatus::Success);
  damage(by, part.background_vertex, part.background_tet, part.mesh, part.positive_faces, part.positive_tets);
  drop_unused(part);
  const ImplicitFunctionRef psi(c.domain);
  const std::optional<ImplicitFunctionRef> asked = c.with_psi ? std::optional(psi) : std::nullopt;
  const MeshCertificate made = certify_parts(MPI_COMM_WORLD, part, c.h, asked, c.rounding);
  if (rank() != 0) return made;
  UmResult one = universal_mesh(c.background, c.domain, {.fast = c.params});
  TetMesh mesh{one.final, one.submesh.mesh.C};
  damage(by, one.submesh.background_vertex, one.submesh.background_tet, mesh, one.submesh.positive_faces,
         one.submesh.positive_tets);
  CertificateInput input;
  input.mesh = &mesh;
  input.h = c.h;
  input.positive_faces = &one.submesh.positive_faces;
  input.psi = asked;
  input.coordinate_rounding = c.rounding;
  const MeshCertificate whole = certify(input);
  const std::vector<std::uint64_t> a = bits(made), b = bits(whole);
  EXPECT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    EXPECT_EQ(a[k], b[k]) << c.domain.name << ": number " << k << ": " << std::bit_cast<double>(a[k]) << " is not "
                          << std::bit_cast<double>(b[k]);
  EXPECT_EQ(invalidities(made), invalidities(whole));
  return made;
}

BackgroundMesh lattice_for(const AnalyticDomain& domain, double h) {
  const Vec3 more = Vec3::Constant(3 * h);
  return {a15(), Box(domain.box.min() - more, domain.box.max() + more), h};
}

/// Balls around points, the first of which is hollow.
AnalyticDomain balls(std::vector<Vec3> centres, double radius, double cavity) {
  AnalyticDomain domain = testing::sphere();
  domain.name = "balls";
  Box box;
  for (const Vec3& c : centres) box.extend(Box(c - Vec3::Constant(radius), c + Vec3::Constant(radius)));
  domain.box = box;
  domain.psi = [centres, radius, cavity](const Vec3& x, Vec3* g, Mat3* H) {
    const auto nearest = std::min_element(centres.begin(), centres.end(), [&](const Vec3& a, const Vec3& b) {
      return (x - a).squaredNorm() < (x - b).squaredNorm();
    });
    const Vec3 d = x - *nearest;
    const bool is_in_cavity = nearest == centres.begin() && d.norm() < .5 * (radius + cavity);
    const double sign = is_in_cavity ? -1 : 1, r = is_in_cavity ? cavity : radius;
    if (g) *g = sign * 2 * d;
    if (H) *H = sign * 2 * Mat3::Identity();
    return sign * (d.squaredNorm() - r * r);
  };
  return domain;
}

TEST(PartCertificate, IsThatOfOneProcessToTheBit) {
  for (const AnalyticDomain& domain : {testing::sphere(), testing::ellipsoid(), testing::torus()}) {
    const MeshCertificate c = expect_same({lattice_for(domain, .07), domain, {}, .07});
    EXPECT_TRUE(failures(c).empty()) << failures(c).front();
    EXPECT_EQ(c.boundary.components, 1);
  }
}

TEST(PartCertificate, IsThatOfOneProcessWithoutPsiOrAnEdgeLength) {
  const AnalyticDomain domain = testing::torus();
  EXPECT_FALSE(expect_same({lattice_for(domain, .1), domain, {}, 0, false}).boundary.gap_over_volume);
  EXPECT_GT(expect_same({lattice_for(domain, .1), domain, {}, 0, true, 1e-7}).h, .05);
}

TEST(PartCertificate, PiecesAreJoinedAcrossBorders) {
  std::vector<Vec3> centres;
  for (int k = 0; k < 12; ++k) centres.emplace_back(2.6 * (k % 3), 2.6 * (k / 3 % 2), 2.6 * (k / 6));
  const AnalyticDomain domain = balls(centres, 1, .5);
  const MeshCertificate c = expect_same({lattice_for(domain, .16), domain, {}, .16});
  EXPECT_EQ(c.boundary.components, 13);
  EXPECT_EQ(c.boundary.euler_characteristic, 26);
  EXPECT_EQ(c.boundary.n_wrongly_nested, 0U);
  EXPECT_TRUE(c.is_embedded());
}

TEST(PartCertificate, PiecesMayLieWithinEachOther) {
  const AnalyticDomain domain = testing::sphere();
  const BackgroundMesh background = lattice_for(domain, .06);
  Damage hollow;  // a ball, and a shell around it
  hollow.is_lost = [&](std::int64_t t) {
    const double r = background.position(background.tet(t)[0]).norm();
    return r > .5 && r < .75;
  };
  EXPECT_EQ(expect_same({background, domain, {}, .06}, hollow).boundary.components, 3);
  Damage turned;
  turned.is_turned = [](std::int64_t) { return true; };
  EXPECT_EQ(expect_same({background, domain, {}, .06}, turned).boundary.n_wrongly_nested, 1U);
}

TEST(PartCertificate, WhatIsWrongIsCountedAsInOneProcess) {
  const AnalyticDomain domain = testing::torus();
  const BackgroundMesh background = lattice_for(domain, .09);
  const auto hash = [](std::int64_t id) { return static_cast<std::uint64_t>(id) * 0x9e3779b97f4a7c15u >> 40; };
  Damage lost, turned, moved;
  lost.is_lost = [&](std::int64_t t) { return hash(t) % 50 == 0; };
  turned.is_turned = [&](std::int64_t t) { return hash(t) % 40 == 0; };
  moved.place = [&](std::int64_t v, const Vec3& x) -> Vec3 {
    if (hash(v) % 6 != 0) return x;
    return x + .12 * Vec3(hash(v) % 7 - 3., hash(v) % 11 - 5., hash(v) % 5 - 2.) / 5;
  };
  const MeshCertificate a = expect_same({background, domain, {}, .09}, lost);
  EXPECT_GT(a.boundary.n_nonmanifold_edges, 0U);
  EXPECT_GT(a.boundary.n_nonmanifold_vertices, 0U);
  EXPECT_EQ(a.boundary.equals_positive_faces, false);
  const MeshCertificate b = expect_same({background, domain, {}, .09}, turned);
  EXPECT_GT(b.boundary.n_same_side_faces, 0U);
  EXPECT_GT(b.quality.n_inverted, 0U);
  const MeshCertificate c = expect_same({background, domain, {}, .09}, moved);
  EXPECT_GT(c.boundary.n_self_intersections, 100U);
  EXPECT_GT(c.boundary.faults.size(), 100U);
  EXPECT_GT(c.boundary.far_feet.size(), 10U);
}

TEST(PartCertificate, IsThatOfOneProcessWhereHBarelyShowsTheBody) {
  FastParams without_repair;
  without_repair.repair.max_tries = 0;
  for (const double h : {.15, .22, .3}) {
    for (const AnalyticDomain& domain : {testing::torus(1, .3), testing::ellipsoid({1, .4, .2})})
      expect_same({lattice_for(domain, h), domain, without_repair, h});
  }
}

TEST(PartCertificate, ABodyOnFewRanksHasOneToo) {
  AnalyticDomain small = testing::sphere();
  small.box = Box(Vec3::Constant(-1.5), Vec3::Constant(12));
  expect_same({{a15(), small.box, .4}, small, {}, .4});
}

TEST(PartCertificate, WithoutATetThereIsNone) {
  EXPECT_THROW(certify_parts(MPI_COMM_WORLD, {}, 1, std::nullopt), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
