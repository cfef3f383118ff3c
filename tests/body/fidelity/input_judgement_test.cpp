// Whether a mesh fits what was given, and which stage is to blame where it does not.

#include "body/fidelity/input_judgement.h"

#include <gtest/gtest.h>

#include <string>

#include "pipeline/case/parameters.h"
#include "pipeline/reports/blame.h"
#include "pipeline/reports/certificate_report.h"

namespace umtet {
namespace {

constexpr double kH = .1;

/// A mesh of 1000 samples that is right, but for what a test changes.
MeshMeasures right() {
  MeshMeasures m;
  m.n_points = 1000;
  m.mesh.h = kH;
  m.mesh.volume = 1;
  m.domain.level_set_spacing = .2;
  m.domain.support = SupportReport{.radius = .3};
  m.cloud = SampleDistances{.noise = 0};
  m.input = InputFacts{.normals_given = true};
  return m;
}

Certificate judged(const MeshMeasures& m) { return verdict_on(m, Parameters()); }

MeshMeasures missing(std::size_t n_samples, double deep_over_h) {
  MeshMeasures m = right();
  m.cloud->n_beyond_h = n_samples;
  m.cloud->most_over_h = deep_over_h;
  return m;
}

MeshMeasures guessing(double share, int n_handles = 0) {
  MeshMeasures m = right();
  m.domain.support->unsupported_area_fraction = share;
  m.domain.support->n_guessed_handles = n_handles;
  return m;
}

/// Not psi = 0 at a place that is not small.
MeshMeasures unlike_psi(std::optional<double> h_needed) {
  MeshMeasures m = right();
  std::vector<MeshDefect> places = {
      {.kind = DefectKind::Thin, .off_over_h = 2, .size_over_h = 5, .feature_over_h = 1, .h_needed = h_needed}};
  m.defects = report_on(places);
  return m;
}

TEST(InputJudgement, AMeshThatHasAllSamplesPasses) {
  const Certificate c = judged(right());
  EXPECT_EQ(c.verdict.word(), "pass");
  EXPECT_TRUE(c.verdict.is_valid && c.verdict.fits_psi && c.verdict.fits_input);
  EXPECT_FALSE(c.blame);
}

TEST(InputJudgement, NoiseThatHidesDetailsIsNamed) {
  MeshMeasures m = right();
  m.cloud->noise = .2 * kH;
  EXPECT_EQ(judged(m).verdict.word(), "pass");
  m.cloud->noise = .3 * kH;
  const Verdict noisy = judged(m).verdict;
  EXPECT_EQ(noisy.word(), "pass with 1 defect named");
  EXPECT_TRUE(noisy.fits_input);
  EXPECT_NE(noisy.defects.at(0).find("noise of the samples is 0.3 h"), std::string::npos) << noisy.defects.at(0);
}

TEST(InputJudgement, NothingWithDeeplyMissedSamplesIsAPlainPass) {
  EXPECT_EQ(judged(missing(9, 2)).verdict.word(), "pass") << "single samples";
  EXPECT_EQ(judged(missing(15, 2)).verdict.word(), "pass with 1 defect named");
  EXPECT_EQ(judged(missing(10, 4)).verdict.word(), "pass with 1 defect named") << "a few outliers";
  const Certificate c = judged(missing(11, 4));
  EXPECT_EQ(c.verdict.word(), "fail");
  EXPECT_TRUE(c.verdict.fits_psi);
  EXPECT_FALSE(c.verdict.fits_input);
  EXPECT_NE(c.verdict.reasons.front().find("11 samples"), std::string::npos) << c.verdict.reasons.front();
}

TEST(InputJudgement, AGuessIsNamedAndABodyThatIsMostlyInventedFails) {
  EXPECT_EQ(judged(guessing(.2)).verdict.word(), "pass");
  EXPECT_EQ(judged(guessing(.21)).verdict.word(), "pass with 1 defect named");
  EXPECT_EQ(judged(guessing(.51)).verdict.word(), "fail");
  EXPECT_EQ(judged(guessing(.95)).blame->stage, "input");
  EXPECT_NE(judged(guessing(.95)).blame->number.find("95 %"), std::string::npos);
}

TEST(InputJudgement, ABodyWhoseOutwardSideIsAGuessFailsWhereNormalsWereTurned) {
  MeshMeasures m = guessing(0);
  m.cloud.emplace();
  m.input.emplace();
  const auto word = [&](double doubtful) {
    m.input->doubtful = doubtful;
    return judged(m).verdict.word();
  };
  EXPECT_EQ(word(.2), "pass");
  EXPECT_EQ(word(1), "pass with 1 defect named");
  m.input->normals_given = true;
  EXPECT_EQ(word(1), "pass") << "an open scan with normals";
  m.input->turned = .3;
  EXPECT_EQ(word(.3), "pass with 1 defect named");
  EXPECT_EQ(word(1), "fail");
  EXPECT_EQ(judged(m).blame->stage, "normals");
  EXPECT_NE(judged(m).verdict.reasons.front().find("100 % of the samples is a guess"), std::string::npos);
}

TEST(InputJudgement, HandlesWithoutSamplesFailWhereMuchIsGuessed) {
  EXPECT_EQ(judged(guessing(.1, 1)).verdict.word(), "pass with 1 defect named");
  const Certificate c = judged(guessing(.4, 6));
  EXPECT_EQ(c.verdict.word(), "fail");
  EXPECT_NE(c.verdict.reasons.front().find("6 handles"), std::string::npos) << c.verdict.reasons.front();
}

/// Of closed triangles around a volume of 1.
MeshMeasures of_triangles(double volume, std::size_t n_pieces = 1, long characteristic = 2) {
  MeshMeasures m = right();
  const TriangleBody given{
      .volume = 1, .n_pieces = 1, .euler_characteristic = 2, .is_closed = true, .is_manifold = true};
  m.triangles = TriangleDistances{};
  m.triangles->body = given;
  m.triangles->mesh = given;
  m.triangles->mesh.volume = volume;
  m.triangles->mesh.n_pieces = n_pieces;
  m.triangles->mesh.euler_characteristic = characteristic;
  return m;
}

TEST(InputJudgement, TheVolumeOfTrianglesIsKeptButForWhatFlatFacesExplain) {
  EXPECT_EQ(judged(of_triangles(.996)).verdict.word(), "pass");
  EXPECT_EQ(judged(of_triangles(.99)).verdict.word(), "pass with 1 defect named");
  EXPECT_EQ(judged(of_triangles(1.03)).verdict.word(), "fail");
  MeshMeasures coarse = of_triangles(.97);
  coarse.mesh.boundary.gap_over_volume = .03;
  EXPECT_EQ(judged(coarse).verdict.word(), "pass");
}

TEST(InputJudgement, PiecesAndHandlesAreThoseOfTheTriangles) {
  EXPECT_NE(judged(of_triangles(1, 2, 4)).verdict.reasons.front().find("2 pieces"), std::string::npos);
  EXPECT_NE(judged(of_triangles(1, 1, 0)).verdict.reasons.front().find("genus 1"), std::string::npos);
  MeshMeasures overlapping = of_triangles(1, 1, 0);
  overlapping.triangles->body->is_manifold = false;
  EXPECT_TRUE(judged(overlapping).verdict.passes()) << "nothing is known of their topology";
}

TEST(InputJudgement, RoundedEdgesAreNamed) {
  MeshMeasures m = of_triangles(1);
  m.triangles->edges = {
      .n_curves = 12, .n_corners = 8, .n_patches = 6, .length = 12, .rounded_length = .1, .max_over_h = .3};
  EXPECT_EQ(judged(m).verdict.word(), "pass");
  m.triangles->edges->rounded_length = 11;
  const Certificate c = judged(m);
  EXPECT_EQ(c.verdict.word(), "pass with 1 defect named");
  EXPECT_NE(c.verdict.defects.front().find("11 of 12, by up to 0.3 h"), std::string::npos) << c.verdict.defects.front();
}

TEST(InputJudgement, OpenTrianglesAreNotMissedWhereTheMeshClosesThem) {
  MeshMeasures m = of_triangles(1);
  m.triangles->max_over_h = 5;
  EXPECT_EQ(judged(m).verdict.word(), "fail");
  m.triangles->body->is_closed = false;
  EXPECT_EQ(judged(m).verdict.word(), "pass");
  m.triangles->max_back_over_h = 2;
  EXPECT_EQ(judged(m).verdict.word(), "pass with 1 defect named");
}

/// Of a segmentation of 1000 voxels in one piece.
MeshMeasures of_labels(double volume) {
  MeshMeasures m;
  m.mesh.h = kH;
  m.labels = LabelVolumeReport{.n_voxels = 1000,
                               .volume_of_voxels = 1000,
                               .volume_of_psi = volume,
                               .volume_of_mesh = volume,
                               .pieces = {1, 1},
                               .cavities = {0, 0},
                               .pieces_of_mesh = 1};
  return m;
}

TEST(InputJudgement, VoxelsKeepTheirVolumePiecesAndSides) {
  EXPECT_EQ(judged(of_labels(1000)).verdict.word(), "pass");
  EXPECT_EQ(judged(of_labels(980)).verdict.word(), "pass with 1 defect named");
  EXPECT_EQ(judged(of_labels(960)).verdict.word(), "fail");
  MeshMeasures m = of_labels(1000);
  m.labels->pieces_of_mesh = 2;
  EXPECT_EQ(judged(m).verdict.word(), "fail");
  m = of_labels(1000);
  m.labels->n_changed_far = 10;
  EXPECT_EQ(judged(m).verdict.word(), "pass with 1 defect named");
  m.labels->n_changed_far = 11;
  EXPECT_EQ(judged(m).verdict.word(), "fail");
}

TEST(Blame, GoesToTheSmoothingOfAMaskThatLosesItsVolume) {
  MeshMeasures m = of_labels(720);
  m.labels->kernel = 1;
  const Blame b = *judged(m).blame;
  EXPECT_EQ(b.stage, "labels");
  EXPECT_NE(b.number.find("-28 %"), std::string::npos) << b.number;
  EXPECT_EQ(b.remedy.find("--part-smooth 0.5"), 0u) << b.remedy;
}

TEST(InputJudgement, StrictNamesNothingAndAcceptTakesItsKinds) {
  Parameters strict;
  strict.set("output.strict=true");
  EXPECT_FALSE(verdict_on(guessing(.3), strict).verdict.passes());
  Parameters accepting;
  accepting.set("output.accept=guessed");
  EXPECT_TRUE(verdict_on(guessing(.9), accepting).verdict.passes());
  EXPECT_FALSE(verdict_on(guessing(.9), accepting).verdict.fits_input) << "accepted is not right";
  accepting.set("output.accept=guessed:.8");
  EXPECT_FALSE(verdict_on(guessing(.9), accepting).verdict.passes());
}

TEST(Judge, AFormulaIsItsOwnInput) {
  MeshMeasures m = unlike_psi(.05);
  m.n_points.reset(), m.cloud.reset(), m.input.reset(), m.domain.support.reset();
  const Verdict v = judge(m, VerdictOptions());
  EXPECT_FALSE(v.fits_psi);
  EXPECT_FALSE(v.fits_input);
}

TEST(Blame, GoesToNormalsBeforeAllThatIsMadeOfThem) {
  MeshMeasures m = unlike_psi(.05);
  m.input = InputFacts{.normals_given = false, .turned = .46, .turned_by = "the winding number"};
  const Blame b = *judged(m).blame;
  EXPECT_EQ(b.stage, "normals");
  EXPECT_EQ(b.number, "46 % of the normals were turned, by the winding number");
  EXPECT_NE(b.remedy.find("--orient-from"), std::string::npos) << b.remedy;
}

TEST(Blame, GoesToNoiseThatHShows) {
  MeshMeasures m = unlike_psi(.05);
  m.cloud->noise = .8 * kH;
  EXPECT_EQ(judged(m).blame->stage, "input");
  EXPECT_EQ(judged(m).blame->remedy.find("--h 0.267"), 0u) << judged(m).blame->remedy;
  // The sizes of a graded mesh end where noise is .3 of them: half of that is said already.
  m.cloud->noise = .2 * kH;
  EXPECT_EQ(judged(m).blame->stage, "h");
  m.sizes = SizesReport{};
  EXPECT_EQ(judged(m).blame->remedy.find("--h-min"), 0u) << judged(m).blame->remedy;
}

TEST(Blame, GoesToHOnlyWhereAThinPlaceNeedsLess) {
  const Blame of_h = *judged(unlike_psi(.05)).blame;
  EXPECT_EQ(of_h.stage, "h");
  EXPECT_EQ(of_h.remedy.find("--h 0.05"), 0u) << of_h.remedy;
  EXPECT_EQ(judged(unlike_psi(std::nullopt)).blame->stage, "mesh");
  MeshMeasures stopped = unlike_psi(.05);
  stopped.search = SearchReport{.at_max_tets = true};
  EXPECT_EQ(judged(stopped).blame->stage, "max_tets");
}

TEST(Blame, GoesToPsiWhereTheMeshIsPsiAndTheSamplesAreElsewhere) {
  const Blame b = *judged(missing(500, 5)).blame;
  EXPECT_EQ(b.stage, "level set");
  EXPECT_EQ(b.remedy.find("--spacing 0.1"), 0u) << b.remedy;
}

TEST(Blame, OfAGateIsTheMesh) {
  MeshMeasures m = right();
  m.mesh.quality.min = .7;
  Parameters gate;
  gate.set("output.min_quality=.8");
  EXPECT_EQ(verdict_on(m, gate).blame->stage, "mesh");
}

}  // namespace
}  // namespace umtet
