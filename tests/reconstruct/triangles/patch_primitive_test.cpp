#include "reconstruct/triangles/patch_primitive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/reconstruct/triangles/solids.h"

namespace umtet {
namespace {

constexpr PrimitiveTolerances kTolerances{1e-9, .05};

/// A grid of n x m quadrilaterals on a surface x(u, v), u and v in [0, 1].
TriangleMesh sheet(int n, int m, const std::function<Vec3(double u, double v)>& at) {
  TriangleMesh mesh;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) mesh.V.push_back(at(static_cast<double>(i) / n, static_cast<double>(j) / m));
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.F.push_back({a, b, d});
      mesh.F.push_back({a, d, c});
    }
  }
  return mesh;
}

/// A rigid motion, so that no axis is special.
Vec3 moved(const Vec3& x) {
  static const Mat3 R = Eigen::AngleAxisd(.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  return R * x + Vec3(5, -3, 2);
}

void expect_zero_at(const PatchPrimitive& p, const TriangleMesh& mesh) {
  for (const Vec3& x : mesh.V) EXPECT_NEAR(p.evaluate(x, nullptr, nullptr), 0, 1e-9);
}

/// The gradient is that of the values, has unit length, and points to the outer side of the triangles.
void expect_outward_gradient(const PatchPrimitive& p, const TriangleMesh& mesh) {
  for (std::size_t f = 0; f < mesh.F.size(); ++f) {
    const Vec3 x = mesh.centroid(f);
    Vec3 g;
    Mat3 H;
    p.evaluate(x, &g, &H);
    EXPECT_NEAR(g.norm(), 1, 1e-12);
    EXPECT_GT(g.dot(mesh.area_vector(f)), 0);
    for (int k = 0; k < 3; ++k) {
      const Vec3 step = 1e-6 * Vec3::Unit(k);
      EXPECT_NEAR((p.evaluate(x + step, nullptr, nullptr) - p.evaluate(x - step, nullptr, nullptr)) / 2e-6, g[k], 1e-8);
      Vec3 after, before;
      p.evaluate(x + step, &after, nullptr);
      p.evaluate(x - step, &before, nullptr);
      EXPECT_LT(((after - before) / 2e-6 - H.col(k)).norm(), 1e-6);
    }
  }
}

struct Case {
  const char* name;
  PatchPrimitive::Kind kind;
  std::function<Vec3(double, double)> at;
};

const Case kCases[] = {{"plane", PatchPrimitive::Kind::Plane, [](double u, double v) { return Vec3(u, 2 * v, 0); }},
                       {"cylinder", PatchPrimitive::Kind::Cylinder,
                        [](double u, double v) { return Vec3(std::cos(2 * u), std::sin(2 * u), 3 * v); }},
                       {"whole_cylinder", PatchPrimitive::Kind::Cylinder,
                        [](double u, double v) { return Vec3(std::cos(2 * M_PI * u), std::sin(2 * M_PI * u), 3 * v); }},
                       {"hole", PatchPrimitive::Kind::Cylinder,
                        [](double u, double v) { return Vec3(std::cos(2 * u), -std::sin(2 * u), 3 * v); }},
                       {"cone", PatchPrimitive::Kind::Cone,
                        [](double u, double v) {
                          const double r = 2 - v;
                          return Vec3(r * std::cos(2 * u), r * std::sin(2 * u), 2 * v);
                        }},
                       {"sphere", PatchPrimitive::Kind::Sphere, [](double u, double v) {
                          const double a = 2 * u, b = v - .5;
                          return Vec3(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b));
                        }}};

TEST(PatchPrimitive, EachSurfaceIsRecognisedFromItsFacets) {
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.name);
    const TriangleMesh mesh = sheet(16, 5, [&](double u, double v) { return moved(c.at(u, v)); });
    const auto found = fit_primitive(mesh, kTolerances);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->kind, c.kind);
    expect_zero_at(*found, mesh);
    expect_outward_gradient(*found, mesh);
  }
}

TEST(PatchPrimitive, OtherSurfacesAreNone) {
  const auto torus = [](double u, double v) {
    const double a = 2 * u, b = 2 * v, r = 3 + std::cos(b);
    return Vec3(r * std::cos(a), r * std::sin(a), std::sin(b));
  };
  EXPECT_FALSE(fit_primitive(sheet(20, 20, torus), kTolerances));
  // An elliptic cylinder, and a saddle.
  EXPECT_FALSE(fit_primitive(
      sheet(16, 4, [](double u, double v) { return Vec3(2 * std::cos(2 * u), std::sin(2 * u), v); }), kTolerances));
  EXPECT_FALSE(fit_primitive(sheet(8, 8, [](double u, double v) { return Vec3(u, v, u * v); }), kTolerances));
}

TEST(PatchPrimitive, FacetsThatAreFarFromTheSurfaceStayFacets) {
  // The facets of an octagon are .08 radii from the circle.
  const auto octagon = [](double u, double v) { return Vec3(std::cos(2 * M_PI * u), std::sin(2 * M_PI * u), v); };
  EXPECT_FALSE(fit_primitive(sheet(8, 1, octagon), {1e-9, .01}));
  EXPECT_TRUE(fit_primitive(sheet(8, 1, octagon), {1e-9, .1}));
}

TEST(PatchPrimitive, TwoFacetsAreNoCylinder) {
  const auto bend = [](double u, double v) { return Vec3(u, v, std::abs(u - .5) * .2); };
  EXPECT_FALSE(fit_primitive(sheet(2, 1, bend), {1e-9, 1}));
}

TEST(PatchPrimitive, AConeWithItsApexIsNone) {
  const auto tip = [](double u, double v) {
    const double r = 1 - v;
    return Vec3(r * std::cos(2 * u), r * std::sin(2 * u), v);
  };
  TriangleMesh mesh = sheet(16, 5, tip);
  std::erase_if(mesh.F, [&](const Triangle& t) {
    return (mesh.V[t[1]] - mesh.V[t[0]]).cross(mesh.V[t[2]] - mesh.V[t[0]]).norm() < 1e-12;
  });
  EXPECT_FALSE(fit_primitive(mesh, kTolerances));
}

}  // namespace
}  // namespace umtet
