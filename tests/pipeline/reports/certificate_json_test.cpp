#include "pipeline/reports/certificate_json.h"

#include <gtest/gtest.h>

#include "pipeline/case/exit_code.h"
#include "pipeline/reports/stage_reports.h"

namespace umtet {
namespace {

/// Every optional part is there.
Certificate full_certificate() {
  Certificate c;
  c.units = "mm";
  MeshMeasures& m = c.measured;
  m.n_points = 1000;
  m.mesh.n_tets = 12;
  m.mesh.n_positive_faces = 8;
  m.mesh.h = .3;
  m.mesh.volume = 4.1887902047863905;
  m.mesh.quality = {.1, .2, .3, .4, 5, 170, 1};
  m.mesh.boundary.closed_manifold = true;
  m.mesh.boundary.equals_positive_faces = false;
  m.mesh.boundary.genus = -1;
  m.mesh.boundary.max_vertex_distance_over_h = 1e-9;
  m.mesh.boundary.gap_over_volume = .02;
  m.coordinate_rounding_over_h = 1. / 3e15;
  m.domain = {.level_set_spacing = .05,
              .components_of_zero_set = 2,
              .euler_characteristic_of_zero_set = 4,
              .euler_characteristic_of_kept_components = 2,
              .components_kept = 2,
              .components_meshed = 1,
              .euler_characteristic_meshed = -2,
              .counting_spacing = .04,
              .topology = TopologyProof::NotProved,
              .topology_at = Vec3(.1, .2, .3),
              .components_dropped = {"piece"},
              .components_proved = true,
              .support = SupportReport{.3, .25, 101, {{Vec3(1, 2, 3), 4, .1, 1, 10, 7, 2, 1}}, 2, 1}};
  m.cloud = {.noise = .01,
             .rms = .1,
             .max = .7,
             .p99 = .5,
             .missed_beyond = .2,
             .n_beyond_h = 1010,
             .most_over_h = 3,
             .n_missed_places = 101};
  m.cloud->missed = {{Vec3(3, 2, 1), .7, 20}};
  m.resolution = {.9, 1.5, 3, 4, std::vector<ThinPlace>(1)};
  m.resolution.too_thin->front().is_gap = true;
  m.resolution.too_thin->front().box = {Vec3(1, 2, 3), Vec3(4, 5, 6)};
  m.resolution.too_thin->front().thickness = .1;
  m.sizes = {.1, .4, .5, .75, 1.2, .08, .5};
  m.order = 2;
  m.second_order = SecondOrderReport{{}, SecondOrderReport::Repairs{1, 2, 3, 4}};
  m.second_order->certificate.min_scaled_jacobian_upper = .5;
  c.n_tets_asked = 20;
  m.input = InputFacts{true, .1, "psi", .2, .3, .9, .01};
  m.search = SearchReport{2, true, true};
  std::vector<MeshDefect> defects = {
      {.kind = DefectKind::Missed, .where = Vec3(1, 0, 0), .off_over_h = 2, .n = 12},
      {.kind = DefectKind::Folded, .where = Vec3(0, 1, 0), .off_over_h = .1, .feature_over_h = .4, .h_needed = .1}};
  m.defects = report_on(defects);
  c.verdict = {.min_quality_gate = .2,
               .volume_gap_gate = .1,
               .strict = true,
               .accept = "folded,off:0.2",
               .fits_psi = false,
               .fits_input = false,
               .accepted = {"a folded face"},
               .defects = {"a gap"},
               .n_defects = 3,
               .reasons = {"samples are missed"}};
  c.blame = Blame{"h", "h is .3", "a smaller --h"};
  c.run = CertificateRun{{{"cloud", .5}, {"mesh", 2}}, 100., {}, 50, 2, "host", "2026-01-31T12:00:00Z", "00"};
  return c;
}

/// As the file holds it, read back.
Json reread(const Json& json) { return Json::parse(json.dump()); }

TEST(CertificateJson, ACertificateReadBackIsWrittenAlike) {
  Certificate least;
  least.measured.mesh.volume = std::numeric_limits<double>::quiet_NaN();  // null in the file
  least.measured.mesh.h = 1;
  for (const Certificate& c : {full_certificate(), least}) {
    const Json json = to_json(c);
    EXPECT_EQ(to_json(certificate_from(reread(json))).dump(2), json.dump(2));
  }
}

TEST(CertificateJson, WhatIsMissingIsDamage) {
  const Json json = to_json(full_certificate());
  for (const auto& [key, value] : json.items()) {
    Json lacking = json;
    lacking.erase(key);
    // of meshes whose corners alone were measured, that never were in a case, or that have one h
    const bool may_lack = key == "schema" || key == "sizes" || key == "input" || key == "search" || key == "tool" ||
                          key == "verdict" || key == "order" || key == "run";
    if (may_lack) {
      EXPECT_NO_THROW(certificate_from(lacking)) << key;
    } else {
      EXPECT_THROW(certificate_from(lacking), ArtefactDamaged) << key;
    }
  }
}

TEST(StageReports, AReportReadBackIsWrittenAlike) {
  StageRecord record;
  MeshReport mesh{170.5, 12345, full_certificate().measured};
  mesh.measured.reasons = {"a folded face"};
  record.numbers = reread(to_json(mesh));
  EXPECT_EQ(to_json(mesh_report(record)).dump(2), to_json(mesh).dump(2));

  const Json wanted = {{"h", .1}};
  CloudReport cloud;
  cloud.box = {Vec3(0, 0, 0), Vec3(1, 1, 1)};
  cloud.normals = {true, 3, .9, OrientationReport{.9, 1, 5}, 7, 2, 4};
  cloud.notices = {"turned 5"};
  record.numbers = reread(to_json(cloud, wanted));
  EXPECT_EQ(to_json(cloud_report(record), wanted).dump(2), to_json(cloud, wanted).dump(2));

  EXPECT_FALSE(wanted_of(record));
  cloud.merged = MergedReport{1000, 100, .5};
  record.numbers = reread(to_json(cloud, wanted));
  EXPECT_EQ(to_json(cloud_report(record), wanted).dump(2), to_json(cloud, wanted).dump(2));
  EXPECT_EQ(wanted_of(record), wanted);

  LevelSetReport psi;
  psi.shift = {1, 2, 3};
  psi.fit.residuals = {1, .1};
  psi.fit.bands.resize(2);
  psi.thickness = {.1, .2, .3};
  record.numbers = reread(to_json(psi, wanted));
  EXPECT_EQ(to_json(level_set_report(record), wanted).dump(2), to_json(psi, wanted).dump(2));
  EXPECT_FALSE(wanted_of(record));
  psi.left_out_finer = true;
  record.numbers = reread(to_json(psi, wanted));
  EXPECT_EQ(to_json(level_set_report(record), wanted).dump(2), to_json(psi, wanted).dump(2));
  EXPECT_EQ(wanted_of(record), wanted);
  record.numbers.erase("shift");
  EXPECT_THROW(level_set_report(record), ArtefactDamaged);
}

}  // namespace
}  // namespace umtet
