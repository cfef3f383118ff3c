// Thin places of formulas whose thickness is known, and what they need.

#include "body/sizing/too_thin.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <numbers>

#include "body/sizing/deviation.h"
#include "mesh/implicit/curvature.h"
#include "mesh/expression/expression.h"
#include "pipeline/meshing/defect_files.h"

namespace umtet {
namespace {

namespace fs = std::filesystem;

Domain domain_of(const std::string& formula, const Vec3& corner) {
  Domain domain;
  domain.formula = shared_function(Expression(formula));
  domain.box = Box(-corner, corner);
  domain.diagonal = domain.box.diagonal().norm();
  return domain;
}

ThinPlaces thin_places(const Domain& domain, double h) {
  return find_thin_places(domain, choose_components(domain, h), h);
}

// Half axes 1, 1 and .15: .3 thick in the middle, thinner towards the rim.
const char* const kLens = "x^2+y^2+(z/0.15)^2-1";
// Two unit balls .1 apart.
const char* const kTwins = "((x-1.05)^2+y^2+z^2-1)*((x+1.05)^2+y^2+z^2-1)";

TEST(ThinPlaces, ABodyThickerThanHHasNone) {
  EXPECT_TRUE(thin_places(domain_of("x^2+y^2+z^2-1", {1.3, 1.3, 1.3}), .2).empty());
  EXPECT_TRUE(thin_places(domain_of("x^2+y^2+(z/0.15)^2-1", {1.2, 1.2, .4}), .03).empty());
}

TEST(ThinPlaces, ALensIsOnePlaceAndNeedsWhatItSays) {
  const Domain lens = domain_of(kLens, {1.6, 1.6, .9});
  const ThinPlaces thin = thin_places(lens, .25);  // .3 is less than 1.25 h
  ASSERT_EQ(thin.places.size(), 1u);
  const ThinPlace& place = thin.places[0];
  EXPECT_FALSE(place.is_gap);
  EXPECT_LT(place.centre.norm(), .05);
  EXPECT_GT(place.box.sizes().x(), 1.7);  // from rim to rim, as far as samples .25 apart see it
  EXPECT_NEAR(place.area, 2 * std::numbers::pi, .8);
  EXPECT_LT(place.h_needed, .2);
  // Where it says so, the middle is no longer too thin; of the rim, thinner still, less than a tenth of it all is.
  double left = 0;
  for (const ThinPlace& p : thin_places(lens, .9 * place.h_needed).places) left += p.area;
  EXPECT_LT(left, .1 * place.area);
}

TEST(ThinPlaces, AGapIsToldFromABodyAndMeasuredWhereItIs) {
  const ThinPlaces thin = thin_places(domain_of(kTwins, {2.6, 1.4, 1.4}), .2);
  ASSERT_EQ(thin.places.size(), 1u);
  EXPECT_TRUE(thin.places[0].is_gap);
  EXPECT_NEAR(thin.places[0].thickness, .1, .01);
  EXPECT_LT(thin.places[0].centre.norm(), .05);
  for (const double t : thin.thickness) EXPECT_LT(t, kLeastEdgesAcross * thin.h);
}

TEST(ThinPlaces, AFewSamplesAreNoPlace) {
  // At r from the axis the gap is .1 + r^2 wide: thinner than 1.25 h on two caps of pi (1.25 h - .1), each .18 h^2 at
  // h = .0803 and 1.7 h^2 at h = .083; they are more than an edge apart, so they are two places.
  const Domain twins = domain_of(kTwins, {.4, .4, .4});
  const ZeroSetChoice fine = choose_components(twins, .02);
  EXPECT_TRUE(find_thin_places(twins, fine, .0803).empty());
  EXPECT_EQ(find_thin_places(twins, fine, .083).places.size(), 2u);
}

TEST(ThinPlaces, AreReadBackAsPolydataInModelCoordinates) {
  const ThinPlaces thin = thin_places(domain_of(kTwins, {2.6, 1.4, 1.4}), .2);
  const fs::path file = fs::temp_directory_path() / ("umtet_thin_" + std::to_string(::getpid()) + ".vtp");
  write_thin_places(file, thin, Vec3(10, 20, 30));
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  fs::remove(file);
  vtkPolyData* read = reader->GetOutput();
  ASSERT_EQ(read->GetNumberOfPoints(), static_cast<vtkIdType>(thin.points.size()));
  EXPECT_EQ(read->GetNumberOfVerts(), read->GetNumberOfPoints());
  Vec3 x;
  read->GetPoint(3, x.data());
  EXPECT_EQ(x, thin.points[3] + Vec3(10, 20, 30));
  for (const char* name : {"thickness", "h_needed", "place", "gap"}) {
    ASSERT_NE(read->GetPointData()->GetArray(name), nullptr) << name;
  }
  EXPECT_EQ(read->GetPointData()->GetArray("thickness")->GetTuple1(3), thin.thickness[3]);
  EXPECT_EQ(read->GetPointData()->GetArray("gap")->GetTuple1(3), 1);
}

TEST(PrincipalCurvatures, OfATorusAreThoseOfItsTube) {
  // R = 1, r = .4: at (1.4, 0, 0) 1 / .4 and 1 / 1.4; at (.6, 0, 0) 1 / .4 and -1 / .6.
  const Domain torus = domain_of("(x^2+y^2+z^2+.84)^2-4*(x^2+y^2)", {1.6, 1.6, .6});
  EXPECT_TRUE(principal_curvatures(torus.psi(), {1.4, 0, 0}).isApprox(Eigen::Vector2d(1 / .4, 1 / 1.4), 1e-9));
  EXPECT_TRUE(principal_curvatures(torus.psi(), {.6, 0, 0}).isApprox(Eigen::Vector2d(1 / .4, 1 / .6), 1e-9));
}

}  // namespace
}  // namespace umtet
