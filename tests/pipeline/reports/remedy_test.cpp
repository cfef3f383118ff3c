// What a failed certificate tells its reader to try.

#include <gtest/gtest.h>

#include "pipeline/case/parameters.h"
#include "pipeline/reports/certificate_report.h"

namespace umtet {
namespace {

/// Of a graded mesh that fails, with this noise of its samples.
MeshMeasures failing(double noise_over_h) {
  MeshMeasures m;
  m.mesh.h = .1;
  m.reasons = {"it is wrong"};
  m.cloud = SampleDistances{.noise = noise_over_h * m.mesh.h};
  m.sizes = SizesReport{};
  return m;
}

std::string remedy(const MeshMeasures& m) { return verdict_on(m, Parameters()).remedy.value_or(""); }

TEST(Remedy, IsAFinerMeshWhereTheSamplesShowMore) {
  EXPECT_EQ(remedy(failing(.05)).find("a smaller --h (this was 0.1)"), 0u) << remedy(failing(.05));
}

TEST(Remedy, IsACoarserMeshWhereItHasGoneDownToTheNoise) {
  EXPECT_EQ(remedy(failing(.25)).find("a larger --h-min"), 0u) << remedy(failing(.25));
  // With one h what is as thin as the noise does not show anyway.
  MeshMeasures one_h = failing(.25);
  one_h.sizes.reset();
  EXPECT_EQ(remedy(one_h).find("a smaller --h"), 0u) << remedy(one_h);
}

}  // namespace
}  // namespace umtet
