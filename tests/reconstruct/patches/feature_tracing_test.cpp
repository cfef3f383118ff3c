#include "reconstruct/patches/feature_tracing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tests/support/edged_clouds.h"

namespace umtet {
namespace {

using testing::edged_cloud;
using testing::EdgedCloud;

/// Root mean square distance of the curves from those of the truth with the same patches, in spacings.
double curve_error(const EdgedCloud& cloud, const TracedFeatures& traced) {
  double sum = 0;
  std::size_t n = 0;
  for (const TracedCurve& c : traced.curves)
    for (const Vec3& x : c.points) {
      double least = std::numeric_limits<double>::infinity();
      for (const FeatureCurve& truth : cloud.truth.curves)
        if (truth.patches == c.patches) least = std::min(least, truth.nearest(x).distance);
      sum += least * least;
      ++n;
    }
  return std::sqrt(sum / static_cast<double>(n)) / cloud.patches.spacing;
}

double length(const TracedFeatures& traced) {
  double sum = 0;
  for (const TracedCurve& c : traced.curves)
    for (std::size_t k = 1; k < c.points.size(); ++k) sum += (c.points[k] - c.points[k - 1]).norm();
  return sum;
}

struct Noise {
  double share, tilt_deg, most;  ///< of the diagonal; of normals; curve error in spacings
};

TEST(FeatureTracing, FindsEveryCurveAndCornerOfParts) {
  for (const char* name : {"cube", "L", "cube-ball", "balls", "cylinder", "lens", "bracket", "prism", "wedge45"}) {
    for (const Noise& noise : {Noise{0, 0, .01}, Noise{.0025, 10, .06}}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(noise.share));
      const EdgedCloud cloud = edged_cloud(name, 3000, noise.share, noise.tilt_deg, 1);
      const TracedFeatures traced =
          trace_patch_features(cloud.points, cloud.patches, fit_patches(cloud.points, cloud.patches));
      EXPECT_EQ(traced.curves.size(), cloud.truth.curves.size());
      EXPECT_EQ(traced.corners.size(), cloud.truth.corners.size());
      EXPECT_TRUE(traced.broken.empty());
      EXPECT_LE(curve_error(cloud, traced), noise.most);
      double true_length = 0;
      for (const FeatureCurve& c : cloud.truth.curves) true_length += c.length();
      EXPECT_NEAR(length(traced), true_length, .01 * true_length);
      for (const TracedCurve& c : traced.curves) {
        for (const FeatureCurve& truth : cloud.truth.curves) {
          if (truth.patches != c.patches) continue;
          if (truth.nearest(c.points[c.points.size() / 2]).distance > cloud.patches.spacing) continue;
          EXPECT_EQ(c.is_convex, truth.angle_deg[truth.angle_deg.size() / 2] < 180);
        }
      }
    }
  }
}

TEST(FeatureTracing, PointsAreOnBothPatchesAndCornersOnAll) {
  const EdgedCloud cloud = edged_cloud("cube-ball", 2000, .0025, 10, 2);
  const std::vector<PatchFit> fits = fit_patches(cloud.points, cloud.patches);
  const TracedFeatures traced = trace_patch_features(cloud.points, cloud.patches, fits);
  const double s = cloud.patches.spacing;
  for (const TracedCorner& c : traced.corners)
    for (const int p : c.patches) EXPECT_NEAR(fits[p].evaluate(c.place, nullptr, nullptr), 0, 1e-6 * s);
  for (const TracedCurve& c : traced.curves)
    for (std::size_t k = 0; k < c.points.size(); ++k) {
      for (const int p : c.patches) EXPECT_NEAR(fits[p].evaluate(c.points[k], nullptr, nullptr), 0, 1e-6 * s);
      if (k == 0) continue;
      EXPECT_LE((c.points[k] - c.points[k - 1]).norm(), .5 * s);
    }
}

TEST(FeatureTracing, ABorderThatIsNotSharpHasNoCurve) {
  EdgedCloud cloud = edged_cloud("cylinder", 1500, .001, 5, 1);
  for (auto& border : cloud.patches.borders) border.sharp = false;
  const TracedFeatures traced =
      trace_patch_features(cloud.points, cloud.patches, fit_patches(cloud.points, cloud.patches));
  EXPECT_TRUE(traced.curves.empty() && traced.corners.empty());
}

}  // namespace
}  // namespace umtet
