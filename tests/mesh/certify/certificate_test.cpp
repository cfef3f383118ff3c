#include "mesh/certify/certificate.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "common/polled_loops.h"
#include "mesh/certify/boundary_surface.h"
#include "mesh/io/tet_mesh_io.h"
#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

/// psi = |x|^2 - 1: its gradient is not a unit vector, so |psi| alone would be a wrong distance.
struct UnitBall {
  double value(const Vec3& x) const { return x.squaredNorm() - 1; }
  Vec3 gradient(const Vec3& x) const { return 2 * x; }
};
const UnitBall kUnitBall;

struct Ball {
  explicit Ball(int levels = 2) { mesh = testing::ball(levels, faces); }
  MeshCertificate certificate() const { return certify({&mesh, 0, &faces, ImplicitFunctionRef(kUnitBall)}); }
  std::vector<std::string> reasons() const { return failures(certificate()); }
  TetMesh mesh;
  std::vector<Triangle> faces;
};

/// True if one of the reasons contains the text; prints them all otherwise.
::testing::AssertionResult says(const std::vector<std::string>& reasons, const std::string& text) {
  auto result = ::testing::AssertionFailure() << "no '" << text << "' among:";
  for (const std::string& r : reasons) {
    if (r.find(text) != std::string::npos) return ::testing::AssertionSuccess();
    result << "\n  " << r;
  }
  return result;
}

TEST(Certificate, ABallPassesAndItsNumbersAreThoseOfTheBall) {
  const Ball ball(4);
  const MeshCertificate c = ball.certificate();
  EXPECT_TRUE(failures(c).empty()) << failures(c).front();
  EXPECT_EQ(c.n_tets, ball.mesh.C.size());
  EXPECT_EQ(c.n_vertices, ball.mesh.V.size());
  EXPECT_EQ(c.n_positive_faces, ball.faces.size());
  EXPECT_EQ(c.boundary.components, 1);
  EXPECT_EQ(c.boundary.euler_characteristic, 2);
  EXPECT_EQ(c.boundary.genus, 0);
  EXPECT_TRUE(c.boundary.closed_manifold);
  EXPECT_TRUE(*c.boundary.equals_positive_faces);
  EXPECT_LE(*c.boundary.max_vertex_distance_over_h, 1e-15 / c.h);
  double sag = 0;
  for (const Triangle& f : ball.faces) {
    sag = std::max(sag, 1 - ((ball.mesh.V[f[0]] + ball.mesh.V[f[1]] + ball.mesh.V[f[2]]) / 3).norm());
  }
  EXPECT_NEAR(*c.boundary.max_centroid_distance_over_h * c.h, sag, 1e-12);
  EXPECT_GT(*c.boundary.min_cos_normal, 0.999);  // an edge of .15 turns the normal by some .05
  EXPECT_EQ(c.boundary.n_cos_below_half, 0u);
}

TEST(Certificate, FacesThatMissMuchOfTheVolumeFail) {
  for (int levels = 0; levels < 5; ++levels) {
    const Ball ball(levels);
    const MeshCertificate c = ball.certificate();
    const double missed = 4 * std::acos(-1.) / 3 / c.volume - 1;
    EXPECT_NEAR(*c.boundary.gap_over_volume, missed, (levels < 2 ? .5 : .05) * missed) << levels;
    EXPECT_EQ(failures(c).empty(), missed < kMostGap) << missed;
    EXPECT_EQ(says(failures(c), "volume_gap"), missed > kMostGap) << missed;
  }
}

TEST(Certificate, AMeshAloneIsJudgedWithoutPsi) {
  const Ball ball;
  const MeshCertificate c = certify({&ball.mesh, 0, nullptr, std::nullopt});
  EXPECT_FALSE(c.boundary.equals_positive_faces || c.boundary.max_vertex_distance_over_h || c.boundary.min_cos_normal);
  EXPECT_TRUE(failures(c).empty());
}

TEST(Certificate, StopsWhenItIsTold) {
  // The number of polls is that of the calling thread's share of the work.
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Ball ball(4);
  std::size_t calls = 0;
  CertificateInput input{&ball.mesh, 0, &ball.faces, ImplicitFunctionRef(kUnitBall), 0};
  input.context.cancelled = [&] { return ++calls == 0; };
  certify(input);
  EXPECT_GE(calls, 2 + ball.faces.size() / kValuesPerPoll);
  for (const std::size_t stop : {std::size_t{1}, calls / 2, calls}) {
    std::size_t n = 0;
    input.context.cancelled = [&] { return ++n >= stop; };
    EXPECT_THROW(certify(input), Cancelled) << stop;
    EXPECT_EQ(n, stop);
  }
}

TEST(Certificate, AnInvertedAndAFlatTetFail) {
  Ball ball;
  std::swap(ball.mesh.C[7][0], ball.mesh.C[7][1]);
  EXPECT_EQ(ball.certificate().quality.n_inverted, 1u);
  EXPECT_LT(ball.certificate().quality.min, 0);
  EXPECT_TRUE(says(ball.reasons(), "1 tets are inverted or flat"));
  EXPECT_TRUE(says(ball.reasons(), "both their tets on the same side"));

  TetMesh flat;
  flat.V = {{0.1, 0.1, 0.1}, {0.3, 0.3, 0.1}, {0.7, 0.7, 0.3}, {0.9, 0.9, 0.7}};
  flat.C = {{0, 1, 2, 3}};
  EXPECT_TRUE(says(failures(certify({&flat, 0, nullptr, std::nullopt})), "inverted or flat"));
}

TEST(Certificate, AMissingTetFails) {
  Ball inner;
  inner.mesh.C.erase(inner.mesh.C.begin() + 3);  // one at the centre: a cavity, closed and manifold
  EXPECT_TRUE(inner.certificate().boundary.closed_manifold);
  EXPECT_EQ(inner.certificate().boundary.components, 2);
  EXPECT_TRUE(says(inner.reasons(), "not the set of positive faces"));
  EXPECT_TRUE(says(inner.reasons(), "h from psi = 0"));

  Ball outer;
  outer.mesh.C.erase(outer.mesh.C.begin());  // one with a boundary face
  EXPECT_TRUE(says(outer.reasons(), "not the set of positive faces"));
}

TEST(Certificate, AnExtraTetAndTetsThatTouchFail) {
  Ball twice;
  twice.mesh.C.push_back(twice.mesh.C[2]);
  EXPECT_TRUE(says(twice.reasons(), "faces belong to more than two tets"));

  Ball touching;  // a second tet hangs on vertex 0 alone
  const int n = static_cast<int>(touching.mesh.V.size());
  touching.mesh.V.insert(touching.mesh.V.end(), {{2, 0, 0}, {2, 1, 0}, {2, 0, 1}});
  touching.mesh.C.push_back(testing::oriented(touching.mesh.V, {0, n, n + 1, n + 2}));
  EXPECT_EQ(touching.certificate().boundary.n_nonmanifold_vertices, 1u);
  EXPECT_TRUE(says(touching.reasons(), "more than one fan"));
  EXPECT_TRUE(says(touching.reasons(), "not a closed 2-manifold"));

  const TetMesh edge = testing::cubes(2, [](int i, int j, int k) { return i == j && k == 0; });
  EXPECT_TRUE(says(failures(certify({&edge, 0, nullptr, std::nullopt})), "1 boundary edges"));
}

TEST(Certificate, ABoundaryVertexOffTheSurfaceFails) {
  Ball ball;
  const double h = ball.certificate().h;
  ball.mesh.V[5] *= 1 + 0.9e-8 * h;
  EXPECT_TRUE(ball.reasons().empty());
  ball.mesh.V[5] *= 1 + 0.2e-8 * h;
  EXPECT_TRUE(says(ball.reasons(), "h from psi = 0"));
}

TEST(Certificate, AFoldedSurfaceFailsThoughEveryTetIsPositive) {
  // A tet on top of a boundary face, its fourth vertex on the sphere beyond the edge b c but within the face's
  // circumscribed circle: then it is above the face, and the side b c d hangs over the neighbour, facing inwards.
  Ball ball;
  const auto [a, b, c] = ball.faces[20];
  const Vec3 middle = 0.5 * (ball.mesh.V[b] + ball.mesh.V[c]);
  ball.mesh.V.push_back((middle + 0.2 * (middle - ball.mesh.V[a])).normalized());
  ball.mesh.C.push_back({a, b, c, static_cast<int>(ball.mesh.V.size()) - 1});
  const MeshCertificate certificate = certify({&ball.mesh, 0, nullptr, ImplicitFunctionRef(kUnitBall)});
  EXPECT_EQ(certificate.quality.n_inverted, 0u);
  EXPECT_TRUE(certificate.boundary.closed_manifold);
  EXPECT_EQ(certificate.boundary.euler_characteristic, 2);
  EXPECT_LT(*certificate.boundary.min_cos_normal, -0.1);
  EXPECT_GT(certificate.boundary.n_cos_below_half, 0u);
  const auto reasons = failures(certificate);
  EXPECT_EQ(reasons.size(), 1u);
  EXPECT_TRUE(says(reasons, "folded"));
}

/// A function without a zero and without a gradient.
struct Constant {
  double value(const Vec3&) const { return 1; }
  Vec3 gradient(const Vec3&) const { return Vec3::Zero(); }
};

TEST(Certificate, AFunctionWithoutAZeroSetFailsInsteadOfPassingByNaN) {
  const Ball ball;
  const Constant psi;
  const MeshCertificate c = certify({&ball.mesh, 0, nullptr, ImplicitFunctionRef(psi)});
  EXPECT_EQ(c.boundary.n_unprojected_faces, ball.faces.size());
  EXPECT_TRUE(says(failures(c), "no point of psi = 0"));
  EXPECT_TRUE(says(failures(c), "h from psi = 0"));

  Ball broken;
  broken.mesh.V[3].x() = std::nan("");
  EXPECT_TRUE(says(broken.reasons(), "inverted or flat"));
}

/// Ellipsoid with a level function that is no distance: the centroid's foot point must still be the closest one.
struct Ellipsoid {
  Vec3 w{1, 1 / 0.64, 1 / 0.16};
  double value(const Vec3& x) const { return w.dot(x.cwiseProduct(x)) - 1; }
  Vec3 gradient(const Vec3& x) const { return 2 * w.cwiseProduct(x); }
};

TEST(Certificate, CentroidDistanceIsTheDistanceToTheClosestPoint) {
  TetMesh mesh;
  std::vector<Triangle> faces;
  mesh = testing::ball(3, faces);
  const Ellipsoid psi;
  for (Vec3& x : mesh.V) x = x.cwiseQuotient(psi.w.cwiseSqrt());
  const MeshCertificate c = certify({&mesh, 0, &faces, ImplicitFunctionRef(psi)});
  EXPECT_TRUE(failures(c).empty());
  // The same by bisection on the multiplier: y = x / (1 + 2 s w) with psi(y) = 0 is the closest point of an ellipsoid.
  double greatest = 0;
  for (const Triangle& f : faces) {
    const Vec3 x = (mesh.V[f[0]] + mesh.V[f[1]] + mesh.V[f[2]]) / 3;
    double lo = -0.04, hi = 0;  // the centroids are inside; 1 + 2 s w stays positive down to s = -.08
    Vec3 y = x;
    for (int i = 0; i < 100; ++i) {
      const double s = 0.5 * (lo + hi);
      y = x.cwiseQuotient(Vec3::Ones() + 2 * s * psi.w);
      (psi.value(y) > 0 ? lo : hi) = s;
    }
    greatest = std::max(greatest, (x - y).norm());
  }
  EXPECT_NEAR(*c.boundary.max_centroid_distance_over_h * c.h, greatest, 1e-6 * greatest);
}

TEST(Certificate, DoesNotDependOnTheNumberOfThreads) {
  Ball ball(4);
  testing::perturb(ball.mesh, 0.002, 9);
  MeshCertificate c[2];
  for (const int threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    c[threads - 1] = ball.certificate();
  }
  EXPECT_EQ(c[0].quality.mean, c[1].quality.mean);
  EXPECT_EQ(c[0].volume, c[1].volume);
  EXPECT_EQ(c[0].h, c[1].h);
  EXPECT_EQ(c[0].boundary.min_cos_normal, c[1].boundary.min_cos_normal);
  EXPECT_EQ(c[0].boundary.max_centroid_distance_over_h, c[1].boundary.max_centroid_distance_over_h);
}

TEST(Certificate, RefusesAMeshThatIsNone) {
  const TetMesh empty;
  EXPECT_THROW(certify({&empty, 0, nullptr, std::nullopt}), std::invalid_argument);
  EXPECT_THROW(certify({nullptr, 0, nullptr, std::nullopt}), std::invalid_argument);
  TetMesh wrong;
  wrong.V = {{0, 0, 0}};
  wrong.C = {{0, 1, 2, 3}};
  EXPECT_THROW(certify({&wrong, 0, nullptr, std::nullopt}), std::invalid_argument);
}

/// The number behind "key": in a line of JSON, NaN when the key is not there.
double json_number(const std::string& line, const std::string& key) {
  const auto at = line.find("\"" + key + "\": ");
  return at == std::string::npos ? std::nan("") : std::atof(line.c_str() + at + key.size() + 4);
}

TEST(Certificate, AgreesWithAnIndependentChecker) {
  const char* const shared = std::getenv("UMTET_SHARED");
  const std::filesystem::path checker =
      std::filesystem::path(shared ? shared : UMTET_SOURCE_DIR "/../shared") / "check.py";
  if (!std::filesystem::exists(checker)) GTEST_SKIP() << checker << " is not here";
  if (std::system("/usr/bin/python3 -c 'import numpy, scipy, meshio' 2>/dev/null") != 0) {
    GTEST_SKIP() << "the checker needs numpy, scipy and meshio";
  }

  // A jagged ball of cubes, bent; a smooth one; one with inverted tets; pieces that touch.
  const auto jagged = [](int i, int j, int k) { return Vec3(i - 5.5, j - 5.5, k - 5.5).norm() < 5.2; };
  TetMesh meshes[4] = {testing::cubes(12, jagged), Ball(3).mesh, testing::cubes(12, jagged),
                       testing::cubes(4, [](int i, int j, int k) { return (i + j + k) % 2 == 0; })};
  testing::perturb(meshes[0], 0.12, 1);
  testing::perturb(meshes[2], 0.4, 2);
  testing::perturb(meshes[3], 0.05, 3);
  for (const TetMesh& mesh : meshes) {
    const auto path = std::filesystem::path(::testing::TempDir()) / "umtet_check.vtu";
    write_vtu(path, with_standard_data(mesh, {}, {}));
    FILE* pipe = popen(("/usr/bin/python3 " + checker.string() + " " + path.string() + " 2>/dev/null").c_str(), "r");
    char line[4096] = "";
    const bool answered = std::fgets(line, sizeof line, pipe) != nullptr;
    pclose(pipe);
    std::filesystem::remove(path);
    ASSERT_TRUE(answered) << "the checker said nothing of this mesh";

    const MeshCertificate c = certify({&mesh, 0, nullptr, std::nullopt});
    const auto expect = [&](const char* key, double ours, double scale = 1) {
      EXPECT_NEAR(ours, json_number(line, key), 1e-9 * scale) << key;
    };
    expect("n_tets", static_cast<double>(c.n_tets));
    expect("n_vertices", static_cast<double>(c.n_vertices));
    expect("q_min", c.quality.min);
    expect("q_p01", c.quality.p01);
    expect("q_mean", c.quality.mean);
    expect("dihedral_min", c.quality.dihedral_min_deg, 180);
    expect("dihedral_max", c.quality.dihedral_max_deg, 180);
    expect("n_inverted", static_cast<double>(c.quality.n_inverted));
    expect("volume", c.volume, c.volume);
    expect("mean_edge", c.h);
    expect("n_boundary_faces", static_cast<double>(c.boundary.n_faces));
    expect("nonmanifold_edges", static_cast<double>(c.boundary.n_nonmanifold_edges));
    expect("faces_shared_by_more_than_two", static_cast<double>(c.boundary.n_overused_faces));
    expect("components", c.boundary.components);
    expect("euler", static_cast<double>(c.boundary.euler_characteristic));
  }
}

}  // namespace
}  // namespace umtet
