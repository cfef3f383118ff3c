#include "reconstruct/triangles/patch_primitive.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace umtet {
namespace {

// Facets of a curved surface: two lie on a cylinder wherever they are.
constexpr std::size_t kFewestFacets = 3;
// Cosine of the angle between the normals of two facets, for the count: one degree.
constexpr double kOneFacet = .99985;
// |n . a| of a cylinder: its facets are parallel to the axis.
constexpr double kCylinder = 1e-4;
// |n . a| of a cone is between that of 3 and of 87 degrees: others are cylinders or planes.
constexpr double kLeastCone = .05, kMostCone = .9986;

double patch_area(const TriangleMesh& patch) {
  double area = 0;
  for (std::size_t f = 0; f < patch.F.size(); ++f) area += patch.area_vector(f).norm();
  return area;
}

Vec3 centre_of(const TriangleMesh& patch) {
  Vec3 centre = Vec3::Zero();
  for (std::size_t f = 0; f < patch.F.size(); ++f) centre += patch.area_vector(f).norm() * patch.centroid(f);
  return centre / patch_area(patch);
}

/// None where normals cancel, as all around a cylinder.
std::optional<PatchPrimitive> plane_of(const TriangleMesh& patch) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t f = 0; f < patch.F.size(); ++f) sum += patch.area_vector(f);
  if (!(sum.norm() > kOneFacet * patch_area(patch))) return std::nullopt;
  PatchPrimitive plane;
  plane.axis = sum.normalized();
  plane.point = centre_of(patch);
  return plane;
}

/// Least squares for |x|^2 = 2 c . x + (R^2 - |c|^2) in the coordinates of the columns of B around `origin`.
template <int N>
bool fit_circle(const TriangleMesh& patch, const Vec3& origin, const Eigen::Matrix<double, 3, N>& B,
                PatchPrimitive& made) {
  using Row = Eigen::Matrix<double, N + 1, 1>;
  Eigen::Matrix<double, N + 1, N + 1> A = Eigen::Matrix<double, N + 1, N + 1>::Zero();
  Row b = Row::Zero();
  for (const Vec3& x : patch.V) {
    Row row;
    row << 2 * (B.transpose() * (x - origin)), 1;
    A += row * row.transpose();
    b += (B.transpose() * (x - origin)).squaredNorm() * row;
  }
  const Eigen::ColPivHouseholderQR<decltype(A)> solver(A);
  if (solver.rank() < N + 1) return false;
  const Row s = solver.solve(b);
  const Eigen::Matrix<double, N, 1> centre = s.template head<N>();
  const double r2 = s[N] + centre.squaredNorm();
  if (!(r2 > 0)) return false;
  made.radius = std::sqrt(r2);
  made.point = origin + B * centre;
  return true;
}

/// Direction in which the normals vary least, and the mean of n . a.
struct NormalAxis {
  Vec3 axis;
  double mean;
};
NormalAxis normal_axis(const TriangleMesh& patch) {
  Mat3 M = Mat3::Zero();
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (std::size_t f = 0; f < patch.F.size(); ++f) {
    const Vec3 a = patch.area_vector(f);
    const double size = a.norm();
    if (!(size > 0)) continue;
    M += a * a.transpose() / size;
    sum += a;
    area += size;
  }
  M -= sum * sum.transpose() / area;
  const Vec3 axis = Eigen::SelfAdjointEigenSolver<Mat3>(M).eigenvectors().col(0);
  return {axis, axis.dot(sum) / area};
}

std::optional<PatchPrimitive> cylinder_of(const TriangleMesh& patch, const NormalAxis& normals) {
  PatchPrimitive made;
  made.kind = PatchPrimitive::Kind::Cylinder;
  made.axis = normals.axis;
  Eigen::Matrix<double, 3, 2> B;
  B.col(0) = made.axis.unitOrthogonal();
  B.col(1) = made.axis.cross(B.col(0));
  if (!fit_circle<2>(patch, centre_of(patch), B, made)) return std::nullopt;
  return made;
}

std::optional<PatchPrimitive> sphere_of(const TriangleMesh& patch) {
  PatchPrimitive made;
  made.kind = PatchPrimitive::Kind::Sphere;
  if (!fit_circle<3>(patch, centre_of(patch), Mat3::Identity(), made)) return std::nullopt;
  return made;
}

std::optional<PatchPrimitive> cone_of(const TriangleMesh& patch, const NormalAxis& normals) {
  PatchPrimitive made;
  made.kind = PatchPrimitive::Kind::Cone;
  const Vec3 origin = centre_of(patch);
  Mat3 A = Mat3::Zero();
  Vec3 b = Vec3::Zero();
  for (std::size_t f = 0; f < patch.F.size(); ++f) {
    const Vec3 a = patch.area_vector(f), n = a.normalized();
    A += a.norm() * n * n.transpose();
    b += a.norm() * n.dot(patch.corner(f, 0) - origin) * n;
  }
  const Eigen::ColPivHouseholderQR<Mat3> solver(A);
  if (solver.rank() < 3) return std::nullopt;
  made.point = origin + solver.solve(b);
  // The axis points to the triangles; the normals, outward or inward, then make the angle 90 degrees + alpha with it.
  made.axis = (origin - made.point).dot(normals.axis) < 0 ? Vec3(-normals.axis) : normals.axis;
  // Facets are chords: their planes have another angle than the cone through the vertices.
  double rz = 0, zz = 0;
  for (const Vec3& x : patch.V) {
    const double z = (x - made.point).dot(made.axis), r = (x - made.point - z * made.axis).norm();
    rz += r * z;
    zz += z * z;
  }
  const double angle = std::atan2(rz, zz);
  made.sine = std::sin(angle);
  made.cosine = std::cos(angle);
  return made;
}

/// Turns f so that it grows outward.
void choose_side(const TriangleMesh& patch, PatchPrimitive& made) {
  double sum = 0;
  for (std::size_t f = 0; f < patch.F.size(); ++f) {
    Vec3 g;
    made.evaluate(patch.centroid(f), &g, nullptr);
    sum += patch.area_vector(f).dot(g);
  }
  if (sum < 0) made.side = -made.side;
}

bool fits(const TriangleMesh& patch, const PatchPrimitive& made, const PrimitiveTolerances& tolerances) {
  const auto is_on = [&](const Vec3& x, double tolerance) {
    return std::abs(made.evaluate(x, nullptr, nullptr)) <= tolerance;
  };
  if (!std::all_of(patch.V.begin(), patch.V.end(), [&](const Vec3& x) { return is_on(x, tolerances.vertex); }))
    return false;
  for (std::size_t f = 0; f < patch.F.size(); ++f) {
    bool is_near = is_on(patch.centroid(f), tolerances.facet);
    for (int k = 0; k < 3; ++k)
      is_near = is_near && is_on((patch.corner(f, k) + patch.corner(f, (k + 1) % 3)) / 2, tolerances.facet);
    if (!is_near) return false;
  }
  return true;
}

bool has_facets(const TriangleMesh& patch) {
  std::vector<Vec3> normals;
  for (std::size_t f = 0; f < patch.F.size() && normals.size() < kFewestFacets; ++f) {
    const Vec3 n = patch.area_vector(f).normalized();
    if (std::none_of(normals.begin(), normals.end(), [&](const Vec3& m) { return m.dot(n) > kOneFacet; }))
      normals.push_back(n);
  }
  return normals.size() >= kFewestFacets;
}

}  // namespace

double PatchPrimitive::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  if (kind == Kind::Plane) {
    if (gradient) *gradient = side * axis;
    if (hessian) hessian->setZero();
    return side * axis.dot(x - point);
  }
  const Vec3 d = x - point;
  const double z = kind == Kind::Sphere ? 0 : d.dot(axis);
  const Vec3 across = d - z * axis;
  const double r = across.norm();
  const Vec3 out = r > 0 ? Vec3(across / r) : Vec3(Vec3::Zero());
  if (gradient) *gradient = side * (cosine * out - sine * axis);
  if (hessian) {
    Mat3 P = Mat3::Identity() - out * out.transpose();
    if (kind != Kind::Sphere) P -= axis * axis.transpose();
    *hessian = r > 0 ? Mat3(side * cosine / r * P) : Mat3(Mat3::Zero());
  }
  return side * (cosine * r - sine * z - radius);
}

std::optional<PatchPrimitive> fit_primitive(const TriangleMesh& patch, const PrimitiveTolerances& tolerances) {
  const auto checked = [&](std::optional<PatchPrimitive> made) -> std::optional<PatchPrimitive> {
    if (!made) return std::nullopt;
    choose_side(patch, *made);
    return fits(patch, *made, tolerances) ? made : std::nullopt;
  };
  if (auto plane = checked(plane_of(patch))) return plane;
  if (!has_facets(patch)) return std::nullopt;
  if (auto sphere = checked(sphere_of(patch))) return sphere;
  const NormalAxis normals = normal_axis(patch);
  const double along = std::abs(normals.mean);
  if (along < kCylinder) return checked(cylinder_of(patch, normals));
  if (!(along > kLeastCone && along < kMostCone)) return std::nullopt;
  std::optional<PatchPrimitive> cone = checked(cone_of(patch, normals));
  const auto is_apex = [&](const Vec3& x) { return (x - cone->point).norm() <= tolerances.facet; };
  if (cone && std::any_of(patch.V.begin(), patch.V.end(), is_apex)) return std::nullopt;
  return cone;
}

}  // namespace umtet
