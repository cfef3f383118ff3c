#include "mesh/classification/classification.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <set>

#include "mesh/certify/certificate.h"
#include "mesh/classification/classification_band.h"
#include "mesh/classification/configuration_costs.h"
#include "mesh/sizes/body_size.h"
#include "mesh/submesh/assemble_submesh.h"
#include "mesh/submesh/inside_walk.h"
#include "mesh/submesh/linked_active_layer.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using testing::AnalyticDomain;

struct Classified {
  IdSet plain, chosen;
  ClassificationReport report;
};

Classified choose(const BackgroundMesh& background, const AnalyticDomain& domain,
                  const ClassificationParams& params = {}) {
  std::size_t n = 0;
  const IdSet plain = inside_vertices(background, domain, n);
  Classified result{plain, plain, {}};
  result.report = classify_vertices(background, VertexLinks(background, a15_links()), domain, params, result.chosen);
  return result;
}

BackgroundMesh background_of(const AnalyticDomain& domain, double n_tets) {
  return BackgroundMesh(a15(), domain.box, h_for_tets(domain, domain.box, n_tets));
}

AnalyticDomain raised(const AnalyticDomain& domain, double step) {
  AnalyticDomain result = domain;
  result.psi = [psi = domain.psi, step](const Vec3& x, Vec3* g, Mat3* H) { return psi(x - Vec3(0, 0, step), g, H); };
  return result;
}

MeshCertificate certificate(const Submesh& submesh) {
  CertificateInput input;
  input.mesh = &submesh.mesh;
  input.positive_faces = &submesh.positive_faces;
  return certify(input);
}

/// Costs up to 655 that mean nothing.
StarCostTable dice(std::uint32_t seed = 1) {
  StarCostTable costs = a15_star_costs();
  std::uint32_t state = seed;
  costs.generate([&] { return static_cast<float>((state = state * 1664525u + 1013904223u) >> 16) / 100; });
  return costs;
}

TEST(Classification, ChangesKeepTheEulerCharacteristicWhateverTheCosts) {
  std::size_t n_flips = 0;
  for (const AnalyticDomain& domain : testing::domains()) {
    SCOPED_TRACE(domain.name);
    const BackgroundMesh background = background_of(domain, 15000);
    const StarCostTable any = dice();
    ClassificationParams params;
    params.costs = &any;  // as many for what is no manifold: only the guards hold
    params.reach_out = .5;
    params.shift = .15;
    for (const ClassificationParams& p : {params, ClassificationParams{}}) {
      const Classified classified = choose(background, domain, p);
      n_flips += classified.report.flips;
      EXPECT_TRUE(classified.report.not_manifold.empty());
      const MeshCertificate c = certificate(emit_submesh(background, classified.chosen));
      EXPECT_TRUE(c.boundary.closed_manifold);
      EXPECT_TRUE(c.boundary.equals_positive_faces.value());
      EXPECT_EQ(c.boundary.components, domain.components);
      EXPECT_EQ(c.boundary.euler_characteristic, 2 * domain.components - 2 * domain.genus);
    }
  }
  EXPECT_GT(n_flips, 1000u);
}

TEST(Classification, ThatOfAMeshBeforeStaysWhereAnotherIsNotBetter) {
  const AnalyticDomain before = testing::torus();
  const BackgroundMesh background = background_of(before, 30000);
  const AnalyticDomain after = raised(before, .05 * background.h());
  const IdSet last = choose(background, before).chosen;
  const auto changes = [&](const IdSet& inside) {
    int n = 0;
    for (std::size_t w = 0; w < inside.n_words(); ++w) n += std::popcount(inside.word(w) ^ last.word(w));
    return n;
  };
  std::size_t n = 0;
  IdSet kept = inside_vertices(background, after, n);
  const ClassificationReport report =
      classify_vertices(background, VertexLinks(background, a15_links()), after, {}, kept, {}, &last);
  EXPECT_GT(report.returned, 0u);
  EXPECT_LT(changes(kept), .8 * changes(choose(background, after).chosen));
  const MeshCertificate c = certificate(emit_submesh(background, kept));
  EXPECT_TRUE(c.boundary.closed_manifold);
  EXPECT_EQ(c.boundary.genus, before.genus);
}

TEST(Classification, IsTheSameWithWhatTheSearchHasEvaluated) {
  const AnalyticDomain domain = testing::torus();
  const BackgroundMesh background = background_of(domain, 20000);
  const Classified without = choose(background, domain);
  InsideWalk walk(background);
  walk.restart(domain);
  EXPECT_TRUE(walk.values().empty());
  walk.update(domain, {});
  IdSet inside = walk.inside();
  const ClassificationReport report = classify_vertices(background, VertexLinks(background, a15_links()), domain, {},
                                                        inside, {}, nullptr, &walk.values());
  EXPECT_TRUE(inside == without.chosen);
  EXPECT_GT(report.flips, 0u);
  EXPECT_EQ(report.psi_evaluations + walk.values().size(), without.report.psi_evaluations);
  // What is said there is believed: a body half an edge smaller would be classified otherwise.
  PsiValues smaller = walk.values();
  for (PsiValue& at : smaller) at.value += .5 * background.h() * at.gradient.norm();
  inside = walk.inside();
  classify_vertices(background, VertexLinks(background, a15_links()), domain, {}, inside, {}, nullptr, &smaller);
  EXPECT_FALSE(inside == without.chosen);
}

TEST(Classification, LowersTheCostOfTheBoundary) {
  const AnalyticDomain domain = testing::torus();
  const BackgroundMesh background = background_of(domain, 15000);
  const auto cost = [&](const IdSet& inside) {
    double sum = 0;
    for (std::int64_t v = 0; v < background.n_vertices(); ++v) {
      if (inside.test(v) || background.on_boundary(v)) continue;
      const int type = background.type(v);
      unsigned mask = 0, k = 0;
      for (const Tiling::Corner& c : background.tiling_tables().link[type]) {
        mask |= static_cast<unsigned>(inside.test(v + background.id_step(type, c))) << k++;
      }
      if (mask != 0) sum += a15_star_costs()(a15_links()[type].site, a15_links()[type].state(mask));
    }
    return sum;
  };
  const Classified classified = choose(background, domain);
  EXPECT_TRUE(classified.report.settled);
  EXPECT_LT(cost(classified.chosen), .8 * cost(classified.plain));
}

/// Flips vertices and computes the cost, without the descent's shortcuts.
class Pricing {
 public:
  /// @param last  classification of a mesh before, or null
  explicit Pricing(ClassificationBand& band, const IdSet* last = nullptr) : band_(band), last_(last) {}

  void take(const IdSet& inside) {
    for (int v = 0; v < static_cast<int>(band_.size()); ++v) {
      if ((band_.is_inside[v] != 0) != inside.test(band_.id[v])) change(v);
    }
  }

  /// How many flips (of a vertex or of two neighbours) would lower the cost, by `keep` where they leave the
  /// classification of last.
  int n_better_singles() {
    int n = 0;
    for (const std::uint32_t v : band_.order) n += is_better({static_cast<int>(v)});
    return n;
  }
  int n_better_pairs() {
    int n = 0;
    for (const std::uint32_t v : band_.order) {
      for (const int w : band_.link(v)) {
        if (band_.movable[w]) n += is_better({static_cast<int>(v), w});
      }
    }
    return n;
  }

 private:
  static constexpr double kRounding = 2e-3;

  void change(int v) {
    band_.is_inside[v] ^= 1;
    for (std::size_t k = 0; k < band_.link(v).size(); ++k) {
      if (const int w = band_.link(v)[k]; w >= 0) {
        band_.mask[w] ^= LinkMask{1} << a15_links()[band_.type[v]].back[k];
      }
    }
  }

  LinkState state(int v) const { return a15_links()[band_.type[v]].state(band_.mask[v]); }

  double cost(int v) const {
    const double phi = band_.phi[v];
    if (band_.is_inside[v]) {
      return params_.inside_weight * std::pow(std::max(0., phi + params_.inside_depth), 2);
    }
    if (band_.mask[v] == 0) return 0;
    return a15_star_costs()(a15_links()[band_.type[v]].site, state(v)) +
           params_.outside_weight * std::pow(phi - params_.outside_height, 2);
  }

  bool is_better(std::initializer_list<int> vertices) {
    double least = kRounding;
    for (const int v : vertices) {
      const bool as_before = last_ && (band_.is_inside[v] != 0) == last_->test(band_.id[v]);
      if (as_before) least = params_.keep + kRounding;
    }
    return gain(vertices) > least;
  }

  /// Minus the change of cost; 0 where the topology of inside, outside or boundary would change.
  double gain(std::initializer_list<int> vertices) {
    std::set<int> touched(vertices);
    for (const int v : vertices) touched.insert(band_.link(v).begin(), band_.link(v).end());
    const auto sum = [&] {
      double costs = 0;
      for (const int v : touched) costs += cost(v);
      return costs;
    };
    const auto manifold = [&](int v) { return band_.is_inside[v] || band_.mask[v] == 0 || state(v).manifold; };
    const double before = sum();
    bool keeps_topology = true;
    for (const int v : vertices) {
      keeps_topology &= state(v).simple;
      change(v);
      keeps_topology &= std::all_of(touched.begin(), touched.end(), manifold);
    }
    const double after = sum();
    for (const int v : vertices) change(v);
    return keeps_topology ? before - after : 0;
  }

  ClassificationParams params_;
  ClassificationBand& band_;
  const IdSet* last_;
};

TEST(Classification, NoChangeOfOneOrOfTwoNeighboursIsBetter) {
  for (const AnalyticDomain& domain : {testing::sphere(), testing::torus()}) {
    SCOPED_TRACE(domain.name);
    const BackgroundMesh background = background_of(domain, 6000);
    const Classified classified = choose(background, domain);
    ASSERT_EQ(classified.report.thin, 0u);
    const ClassificationParams params;
    const VertexLinks links(background, a15_links());
    ClassificationBand band(background, links, domain, params, classified.plain, {});
    Pricing pricing(band);
    EXPECT_GT(pricing.n_better_singles(), 50);
    EXPECT_GT(pricing.n_better_pairs(), 50);
    pricing.take(classified.chosen);
    EXPECT_EQ(pricing.n_better_singles(), 0);
    EXPECT_EQ(pricing.n_better_pairs(), 0);
  }
}

TEST(Classification, NoChangeIsBetterByMoreThanKeepWhereItLeavesTheOneBefore) {
  const AnalyticDomain before = testing::torus();
  const BackgroundMesh background = background_of(before, 60000);
  const AnalyticDomain after = raised(before, .2 * background.h());
  const IdSet last = choose(background, before).chosen;
  const ClassificationParams params;
  const IdSet plain = choose(background, after).plain;
  IdSet inside = plain;
  classify_vertices(background, VertexLinks(background, a15_links()), after, params, inside, {}, &last);
  const VertexLinks links(background, a15_links());
  ClassificationBand band(background, links, after, params, plain, {});
  Pricing with_keep(band, &last), without(band);
  with_keep.take(inside);
  EXPECT_EQ(with_keep.n_better_singles(), 0);
  EXPECT_EQ(with_keep.n_better_pairs(), 0);
  EXPECT_GT(without.n_better_singles() + without.n_better_pairs(), 0);
}

TEST(Classification, StaysNearTheBoundary) {
  const AnalyticDomain domain = testing::sphere();
  const BackgroundMesh background = background_of(domain, 60000);
  const Classified classified = choose(background, domain);
  std::size_t outwards = 0;
  for (std::int64_t v = 0; v < background.n_vertices(); ++v) {
    if (classified.plain.test(v) == classified.chosen.test(v)) continue;
    const double d = (background.position(v).norm() - 1) / background.h();
    EXPECT_GE(d, -.9 - 1e-3);
    EXPECT_LE(d, .2 + 1e-3);
    outwards += classified.chosen.test(v);
  }
  EXPECT_GT(outwards, 0u);
}

TEST(Classification, NoneChangesWhereProjectionWouldStretchTheBoundary) {
  // A ball of 2.5 edges and its complement in a larger one: 1.2 is met .42 edges deep, or as far outside the hollow.
  const double h = .4;
  const AnalyticDomain ball = testing::sphere();
  AnalyticDomain hollow = ball;
  hollow.psi = [](const Vec3& x, Vec3* g, Mat3* H) {
    const double side = x.norm() > 2 ? 1 : -1;
    if (g) *g = side * 2 * x;
    if (H) *H = side * 2 * Mat3::Identity();
    return side > 0 ? x.squaredNorm() - 9 : 1 - x.squaredNorm();
  };
  ClassificationParams free;
  free.inside_weight = free.outside_weight = 0;
  free.most_stretch = 1e9;
  free.reach_out = .9;
  ClassificationParams held = free;
  held.most_stretch = 1.2;
  const auto n_far_changes = [&](const AnalyticDomain& domain, const ClassificationParams& params) {
    std::size_t n = 0;
    const BackgroundMesh background(a15(), testing::cube_box(3.7), h);
    const Classified classified = choose(background, domain, params);
    for (std::int64_t v = 0; v < background.n_vertices(); ++v) {
      n += background.position(v).norm() < 1 - .5 * h && classified.plain.test(v) != classified.chosen.test(v);
    }
    return n;
  };
  for (const AnalyticDomain& domain : {ball, hollow}) {
    std::size_t n_free = 0;
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
      const StarCostTable any = dice(seed);
      free.costs = held.costs = &any;
      n_free += n_far_changes(domain, free);
      EXPECT_EQ(n_far_changes(domain, held), 0u);
    }
    EXPECT_GT(n_free, 0u);
  }
}

TEST(Classification, NoneChangesWhereTheBodyOrAGapIsThin) {
  const AnalyticDomain disc = testing::ellipsoid({1, 1, .08});
  const BackgroundMesh background(a15(), testing::cube_box(1.3), .09);  // 1.8 edges thick
  ClassificationParams guarded;
  guarded.least_thickness = 2;
  const Classified thin = choose(background, disc, guarded);
  EXPECT_GT(thin.report.thin, 0u);
  // At the edge of the disc the normal points into it, where it is a diameter thick.
  const auto n_inner_changes = [](const BackgroundMesh& mesh, const Classified& classified) {
    std::size_t n = 0;
    for (std::int64_t v = 0; v < mesh.n_vertices(); ++v) {
      const Vec3 x = mesh.position(v);
      n += std::hypot(x.x(), x.y()) < .9 && std::abs(x.z()) < .3 &&
           classified.plain.test(v) != classified.chosen.test(v);
    }
    return n;
  };
  EXPECT_EQ(n_inner_changes(background, thin), 0u);
  ClassificationParams unguarded;
  unguarded.least_thickness = 0;
  EXPECT_GT(n_inner_changes(background, choose(background, disc, unguarded)), 0u);

  // The same disc as a cavity of a ball: a gap of that thickness.
  AnalyticDomain gap = disc;
  gap.psi = [disc](const Vec3& x, Vec3* g, Mat3* H) {
    const double value = disc.psi(x, g, H);
    if (x.squaredNorm() > 1.2 * 1.2) {
      if (g) *g = 2 * x;
      if (H) *H = 2 * Mat3::Identity();
      return x.squaredNorm() - 1.25 * 1.25;
    }
    if (g) *g = -*g;
    if (H) *H = -*H;
    return -value;
  };
  const BackgroundMesh around(a15(), testing::cube_box(1.5), .09);
  EXPECT_EQ(n_inner_changes(around, choose(around, gap, guarded)), 0u);
  EXPECT_GT(n_inner_changes(around, choose(around, gap, unguarded)), 0u);
}

TEST(Classification, DoesNotDependOnThreads) {
  const AnalyticDomain domain = testing::banchoff_chmutov_4();
  const BackgroundMesh background = background_of(domain, 40000);
  const auto with = [&](std::size_t n) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, n);
    return choose(background, domain);
  };
  const Classified one = with(1), three = with(3);
  EXPECT_EQ(one.report.flips, three.report.flips);
  EXPECT_EQ(one.report.psi_evaluations, three.report.psi_evaluations);
  for (std::size_t w = 0; w < one.chosen.n_words(); ++w) ASSERT_EQ(one.chosen.word(w), three.chosen.word(w));
}

TEST(Classification, BrokenParamsAreAllNamed) {
  ClassificationParams params;
  EXPECT_TRUE(problems(params).empty());
  params.shift = .2;
  params.reach_in = -1;
  params.outside_weight = -1;
  params.outside_height = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(problems(params).size(), 4u);
}

}  // namespace
}  // namespace umtet
