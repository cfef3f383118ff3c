// Figure 18: the time of the mesher grows with the number of positive faces, not with the number of tets.

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "mesh/sizes/body_size.h"
#include "mesh/universal_mesh.h"
#include "tests/support/bench_domains.h"

using namespace umtet;
namespace domains = umtet::testing;

namespace {

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Timed {
  std::size_t tets, positive_faces;
  double seconds;  // the least of three
};

Timed timed(const domains::AnalyticDomain& domain, double h) {
  UmParams params;
  params.submesh.search = SubmeshSearch::Crawl;
  Timed t{0, 0, 1e9};
  const BackgroundMesh background(a15(), domain.box, h);
  for (int run = 0; run < 3; ++run) {
    const double start = cpu_seconds();
    const UmResult r = universal_mesh(background, domain, params, {}, domain.boundary_seeds);
    t.seconds = std::min(t.seconds, cpu_seconds() - start);
    EXPECT_EQ(r.status, UmStatus::Success) << r.evidence.what;
    t.tets = r.submesh.mesh.C.size();
    t.positive_faces = r.submesh.positive_faces.size();
  }
  return t;
}

}  // namespace

TEST(Figure18, TimeGrowsWithThePositiveFaces) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  std::printf("Figure 18, small     tets   positive faces   us per face (larger: tools/docs/figures.py)\n");
  for (const domains::AnalyticDomain& domain : {domains::sphere(), domains::torus(), domains::perforated_plate(3, 1)}) {
    SCOPED_TRACE(domain.name);
    const Timed small = timed(domain, h_for_tets(domain, domain.box, 60000));
    const Timed large = timed(domain, h_for_tets(domain, domain.box, 480000));
    for (const Timed& t : {small, large}) {
      std::printf("  %-12s %10zu %12zu %16.1f\n", domain.name.c_str(), t.tets, t.positive_faces,
                  1e6 * t.seconds / static_cast<double>(t.positive_faces));
    }
    // 8 times the tets, 4 times the faces. Copying the interior is work for every tet, an exponent of 1.5, but little.
    const double exponent =
        std::log(large.seconds / small.seconds) /
        std::log(static_cast<double>(large.positive_faces) / static_cast<double>(small.positive_faces));
    EXPECT_LT(exponent, 1.5);
    EXPECT_LT(large.seconds / static_cast<double>(large.positive_faces), 60e-6);
  }
}

TEST(Figure18, TimeHardlyDependsOnTheSizeOfTheBackground) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  domains::AnalyticDomain domain = domains::torus();
  const double h = h_for_tets(domain, domain.box, 120000);
  const Timed tight = timed(domain, h);
  domain.box = Box(4 * domain.box.min(), 4 * domain.box.max());
  const Timed loose = timed(domain, h);
  std::printf("Figure 18, torus of %zu tets: %.0f ms; in a background 64 times as large: %.0f ms\n", tight.tets,
              1e3 * tight.seconds, 1e3 * loose.seconds);
  EXPECT_LT(loose.seconds, 5 * tight.seconds);  // measured: 2.7
}
