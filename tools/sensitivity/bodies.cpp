#include "tools/sensitivity/bodies.h"

#include <memory>
#include <utility>

#include "tests/support/bench_domains.h"
#include "tools/star_costs/random.h"
#include "tools/star_costs/random_shape.h"

namespace umtet::sensitivity {
namespace {

constexpr int kRandomShapes = 66;
constexpr int kPoses = 6, kShiftedPoses = 2;
// Enough for features of six edges and more, few enough that a sweep of all values takes minutes.
constexpr double kTets = 10000;

struct Known {
  std::string name;
  testing::AnalyticDomain domain;
  double n_tets;
};

/// The spherical shell (|x| - 1)^2 < r^2; not smooth at the centre, which is far from it.
testing::AnalyticDomain shell(double r) {
  return {"shell", testing::cube_box(1.05 + r), 1, 0, std::nullopt, {}, [r](const Vec3& x, Vec3* g, Mat3* H) {
            const double rho = x.norm();
            const Vec3 n = rho > 0 ? Vec3(x / rho) : Vec3::UnitX();
            const double d = rho - 1, bend = rho > 0 ? d / rho : 0;
            if (g) *g = 2 * d * n;
            if (H) *H = 2 * (n * n.transpose() + bend * (Mat3::Identity() - n * n.transpose()));
            return d * d - r * r;
          }};
}

/// Smooth ones, thin ones, and ones of high genus.
std::vector<Known> known_domains() {
  return {{"ellipsoid", testing::ellipsoid(), kTets},
          {"lens", testing::ellipsoid({1, .9, .25}), kTets},
          {"torus", testing::torus(), kTets},
          {"thin_torus", testing::torus(1, .15), kTets},
          {"shell", shell(.2), kTets},
          {"equation_9", testing::equation_9(), kTets},
          {"equation_13", testing::equation_13(3.2), kTets},
          {"t4", testing::banchoff_chmutov_4(), 2 * kTets},
          {"t6", testing::banchoff_chmutov_6(), 4 * kTets},
          {"plate", testing::perforated_plate(3, 1), 2 * kTets}};
}

/// {psi(R x) < 0}. Outside of the box of the domain |psi| takes the place of psi: sheets there, which a box
/// that is turned would let in, are no boundary of anything.
Body posed(const Known& known, const Mat3& R, const Vec3& offset, std::string name) {
  Box box;
  for (int corner = 0; corner < 8; ++corner) {
    box.extend(R.transpose() * known.domain.box.corner(static_cast<Box::CornerType>(corner)));
  }
  return {std::move(name), box, offset, known.n_tets, [domain = known.domain, R](const Vec3& at, Vec3* g, Mat3* H) {
            const Vec3 x = R * at;
            double value = domain.psi(x, g, H), sign = 1;
            if (value < 0 && !domain.box.contains(x)) sign = -1;
            if (g) *g = sign * R.transpose() * *g;
            if (H) *H = sign * R.transpose() * *H * R;
            return sign * value;
          }};
}

}  // namespace

std::vector<Body> bodies(std::uint64_t seed) {
  std::vector<Body> list;
  // star_costs takes its bodies from seed 1 on: those of the cost tables are not among these.
  const std::uint64_t first = 1'000'000 * (seed + 1);
  for (std::uint64_t s = first; s < first + kRandomShapes; ++s) {
    const auto shape = std::make_shared<star_costs::RandomShape>(s);
    list.push_back({"random_" + std::to_string(s), shape->box(), Vec3::Zero(), kTets,
                    [shape](const Vec3& x, Vec3* g, Mat3* H) { return shape->evaluate(x, g, H); }});
  }
  star_costs::Random random(first);
  for (const Known& known : known_domains()) {
    for (int pose = 0; pose < kPoses; ++pose) {
      const Mat3 R = pose < kShiftedPoses ? Mat3::Identity() : random.rotation();
      list.push_back(posed(known, R, random.point(.5) + Vec3::Constant(.5), known.name + "_" + std::to_string(pose)));
    }
  }
  return list;
}

}  // namespace umtet::sensitivity
