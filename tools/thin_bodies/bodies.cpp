#include "tools/thin_bodies/bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mesh/expression/expression.h"
#include "tools/star_costs/random.h"

namespace umtet::thin_bodies {
namespace {

constexpr int kPoints = 20000;  // of a surface, some .1 h apart
constexpr double kRoom = 2.6;   // between body and box, more than the two edges that a background needs
// Creases are rounded: log(exp(k a) + exp(k b)) / k for the larger of a and b.
constexpr int kSharpness = 20;

/// In its own frame, where it is thin along z (rods and cones: across it). From each centre every point of one piece is
/// seen.
struct Shape {
  std::string formula;  ///< of X, Y, Z
  Vec3 half;            ///< of a box around all of it
  std::vector<Vec3> centres;
  Vec3 axes;  ///< half, of a piece about its centre
};

std::string larger(const std::string& a, const std::string& b) {
  return fmt::format("log(exp({0}*({1}))+exp({0}*({2})))/{0}", kSharpness, a, b);
}

Shape plate(double t) {
  return {fmt::format("(X/4)^4+(Y/3)^4+(2*Z/{})^4-1", t), {4, 3, t / 2}, {{0, 0, 0}}, {4, 3, t / 2}};
}

/// Two spheres that meet in a circle of radius 4.
Shape blade(double t) {
  const double R = (16 + t * t / 4) / t, c = R - t / 2;
  const auto sphere = [&](const char* sign) { return fmt::format("(X^2+Y^2+(Z{}{})^2-{})/{}", sign, c, R * R, 2 * R); };
  return {larger(sphere("+"), sphere("-")), {4, 4, t / 2}, {{0, 0, 0}}, {4, 4, t / 2}};
}

Shape rod(double t) {
  return {fmt::format("(2*X/{0})^2+(2*Y/{0})^2+(Z/4)^8-1", t), {t / 2, t / 2, 4}, {{0, 0, 0}}, {t / 2, t / 2, 4}};
}

/// Of height 8, on a base of radius t.
Shape cone(double t) {
  return {larger(fmt::format("sqrt(X^2+Y^2+1/10000)-{}*(4-Z)/8", t), "-4-Z"), {t, t, 4}, {{0, 0, -3}}, {t, t, 7}};
}

Shape balls(double t) {
  const double c = 2.5 + t / 2;
  return {fmt::format("((X-{0})^2+Y^2+Z^2-25/4)*((X+{0})^2+Y^2+Z^2-25/4)", c),
          {c + 2.5, 2.5, 2.5},
          {{c, 0, 0}, {-c, 0, 0}},
          {2.5, 2.5, 2.5}};
}

Shape slabs(double t) {
  const double c = 1.5 + t / 2;
  const auto slab = [&](const char* sign) { return fmt::format("((X/4)^4+(Y/3)^4+((Z{}{})*2/3)^4-1)", sign, c); };
  return {slab("+") + "*" + slab("-"), {4, 3, c + 1.5}, {{0, 0, c}, {0, 0, -c}}, {4, 3, 1.5}};
}

Shape shape_of(const std::string& family, double t) {
  if (family == "plate") return plate(t);
  if (family == "blade") return blade(t);
  if (family == "rod") return rod(t);
  if (family == "cone") return cone(t);
  if (family == "balls") return balls(t);
  if (family == "slabs") return slabs(t);
  throw std::invalid_argument("no such family: " + family);
}

/// x of {psi = 0} on the ray from the centre, by bisection.
Vec3 on_surface(const Expression& psi, const Vec3& centre, const Vec3& direction) {
  double inside = 0, outside = 1;
  while (psi.value(centre + outside * direction) < 0) outside *= 1.5;
  for (int k = 0; k < 50; ++k) {
    const double middle = (inside + outside) / 2;
    (psi.value(centre + middle * direction) < 0 ? inside : outside) = middle;
  }
  return centre + inside * direction;
}

/// The formula with each of its frame's coordinates in those of the model.
std::string placed(const std::string& formula, const Mat3& R, const Vec3& at) {
  std::string out;
  for (const char c : formula) {
    if (c < 'X' || c > 'Z') {
      out += c;
      continue;
    }
    const Vec3 r = R.row(c - 'X');
    out += fmt::format("({}*(x-({}))+({})*(y-({}))+({})*(z-({})))", r.x(), at.x(), r.y(), at.y(), r.z(), at.z());
  }
  return out;
}

}  // namespace

const std::vector<std::string>& families() {
  static const std::vector<std::string> all = {"plate", "blade", "rod", "cone", "balls", "slabs"};
  return all;
}

Body random_body(const std::string& family, double least_thickness, double most_thickness, std::uint64_t seed) {
  star_costs::Random random(seed);
  const double t = random.in(least_thickness, most_thickness);
  const Mat3 R = random.rotation();
  const Vec3 at = random.point(.5);
  const Shape shape = shape_of(family, t);
  Body body{family, t, placed(shape.formula, R, at), Box(), static_cast<int>(shape.centres.size()), {}};
  const Vec3 half = R.transpose().cwiseAbs() * shape.half + Vec3::Constant(kRoom);
  body.box = Box(at - half, at + half);
  const Expression psi(body.formula);
  const int n = kPoints / body.n_pieces;
  for (const Vec3& centre : shape.centres) {
    for (int k = 0; k < n; ++k) {
      Vec3 u = random.point(1);
      while (u.squaredNorm() > 1 || u.squaredNorm() < .01) u = random.point(1);
      const Vec3 direction = R.transpose() * (u.normalized().cwiseProduct(shape.axes));
      body.surface.push_back(on_surface(psi, R.transpose() * centre + at, direction));
    }
  }
  return body;
}

}  // namespace umtet::thin_bodies
