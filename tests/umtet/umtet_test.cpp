// The facade and the program are two ways to one mesh: its certificate is the same, field by field.

#include "umtet/umtet.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "body/option_names.h"
#include "pipeline/case/artefact.h"
#include "mesh/expression/expression.h"
#include "mesh/features/formula_domain.h"
#include "pipeline/reports/certificate_report.h"
#include "pipeline/reports/stage_reports.h"
#include "pipeline/run/run.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/io/triangle_mesh_io.h"
#include "tests/reconstruct/triangles/solids.h"
#include "tests/support/clouds.h"

namespace umtet {
namespace {
namespace fs = std::filesystem;

/// A folder that goes with the object.
struct Folder {
  const fs::path path = fs::temp_directory_path() / ("umtet_facade_" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

/// What the record of the mesh has that the program makes of this request.
Json measured_by_program(const fs::path& folder, RunRequest request) {
  request.case_folder = folder / "case";
  Progress quiet(ProgressMode::None, Verbosity::Quiet);
  run_case(request, quiet);
  return to_json(mesh_report(read_record(CasePaths{request.case_folder}, Stage::Mesh))).at("measured");
}

Json measured_by(const Mesh& mesh) { return to_json(MeshReport{0, 0, mesh.measures}).at("measured"); }

TEST(Umtet, TheCertificateOfACloudIsThatOfTheProgram) {
  const Folder folder;
  const fs::path file = folder.path / "cloud.ply";
  const OrientedPointCloud cloud = test::torus_cloud(6000);
  {
    std::ofstream out(file, std::ios::binary);
    write_ply(out, cloud);
  }
  RunRequest request;
  request.source = file;
  request.parameters.set("cloud.file", file.string(), ParamSource::Flag, "test");
  const Json program = measured_by_program(folder.path, request);
  const Mesh mesh = mesh_body(cloud);
  EXPECT_EQ(measured_by(mesh).dump(1), program.dump(1));
  EXPECT_TRUE(mesh.verdict.passes()) << mesh.verdict.reasons.front();
  EXPECT_EQ(mesh.tets.size(), mesh.measures.mesh.n_tets);
}

TEST(Umtet, TheCertificateOfTrianglesIsThatOfTheProgram) {
  const Folder folder;
  const fs::path file = folder.path / "torus.ply";
  const TriangleMesh torus = test::torus();
  {
    std::ofstream out(file, std::ios::binary);
    write_ply(out, torus);
  }
  RunRequest request;
  request.source = file;
  request.parameters.set("cloud.file", file.string(), ParamSource::Flag, "test");
  request.parameters.set("mesh.h", ".12", ParamSource::Flag, "test");
  const Json program = measured_by_program(folder.path, request);
  Options options;
  options.body.mesh.h = .12;
  const FittedBody body = fit_body(torus, options);
  EXPECT_EQ(body.triangles.value().n_triangles, torus.F.size());
  const Mesh mesh = mesh_body(body, options);
  EXPECT_EQ(measured_by(mesh).dump(1), program.dump(1));
  EXPECT_TRUE(mesh.verdict.passes()) << mesh.verdict.reasons.front();
}

TEST(Umtet, BoundaryFacesHaveTheLabelsOfTheSamples) {
  OrientedPointCloud cloud = test::torus_cloud(6000);
  EXPECT_TRUE(mesh_body(cloud).labels.empty());
  for (const Vec3& x : cloud.points) cloud.labels.push_back(x.x() > 0 ? 7 : 3);
  Options options;
  options.body.mesh.h = .12;
  const Mesh mesh = mesh_body(cloud, options);
  ASSERT_EQ(mesh.labels.size(), mesh.boundary.size());
  for (std::size_t f = 0; f < mesh.boundary.size(); ++f) {
    const auto& [a, b, c] = mesh.boundary[f];
    const double x = (mesh.points[a].x() + mesh.points[b].x() + mesh.points[c].x()) / 3;
    if (std::abs(x) > .12) {
      EXPECT_EQ(mesh.labels[f], x > 0 ? 7 : 3) << x;
    }
  }
}

TEST(Umtet, TrianglesThatAreNoneAreRefused) {
  TriangleMesh mesh = test::torus();
  mesh.F.front()[1] = static_cast<int>(mesh.V.size());
  EXPECT_THROW(mesh_body(mesh), std::invalid_argument);
  mesh = test::torus();
  mesh.labels = {1};
  EXPECT_THROW(mesh_body(mesh), std::invalid_argument);
}

TEST(Umtet, AnErrorNamesTheOptionThatHelps) {
  Options options;
  options.box = Box(Vec3::Constant(-2), Vec3::Constant(2));
  options.body.mesh.h = .001;
  try {
    mesh_body(Expression("x^2 + y^2 + z^2 - 1"), options);
    ADD_FAILURE() << "a mesh of more tets than max_tets";
  } catch (const ResourceLimit& e) {
    ASSERT_EQ(e.message.remedies.size(), 1u);
    EXPECT_EQ(e.message.remedies.front().change, Change::Raise);
    EXPECT_EQ(e.message.remedies.front().setting.option, option::max_tets);
    EXPECT_NE(std::string(e.what()).find("raise mesh.max_tets"), std::string::npos) << e.what();
  }
}

TEST(Umtet, TheCertificateOfAFormulaIsThatOfTheProgram) {
  const Folder folder;
  const std::string ellipsoid = "x^2 + (y/.8)^2 + (z/.6)^2 - 1";
  RunRequest request;
  request.from = Stage::Mesh;
  request.parameters.set("mesh.implicit", ellipsoid, ParamSource::Flag, "test");
  request.parameters.set("mesh.box", "-1.4,-1.4,-1.4,1.4,1.4,1.4", ParamSource::Flag, "test");
  request.parameters.set("mesh.h", ".1", ParamSource::Flag, "test");
  const Json program = measured_by_program(folder.path, request);
  Options options;
  options.box = Box(Vec3::Constant(-1.4), Vec3::Constant(1.4));
  options.body.mesh.h = .1;
  const Mesh mesh = mesh_body(Expression(ellipsoid), options);
  EXPECT_EQ(measured_by(mesh).dump(1), program.dump(1));
  EXPECT_EQ(mesh.verdict.word(), "pass");
}

TEST(Umtet, ABodyWithSharpEdgesHasThemAndItsCertificateIsThatOfTheProgram) {
  const Folder folder;
  const std::string can = "max(x^2+y^2-1,abs(z)-1)";
  Options options;
  options.box = Box(Vec3::Constant(-1.5), Vec3::Constant(1.5));
  options.body.mesh.h = .25;
  const Mesh mesh = mesh_body(domain_of_formula(can), options);
  EXPECT_EQ(mesh.verdict.word(), "pass");
  ASSERT_EQ(mesh.patches.size(), mesh.boundary.size());
  EXPECT_EQ(*std::min_element(mesh.patches.begin(), mesh.patches.end()), 0);
  EXPECT_EQ(*std::max_element(mesh.patches.begin(), mesh.patches.end()), 2);
  ASSERT_EQ(mesh.curves.size(), 2U);
  for (const std::vector<int>& curve : mesh.curves) {
    ASSERT_GT(curve.size(), 10U);
    EXPECT_EQ(curve.front(), curve.back());
    for (const int v : curve) {
      EXPECT_NEAR(mesh.points[v].head<2>().norm(), 1, 1e-9);
      EXPECT_NEAR(std::abs(mesh.points[v].z()), 1, 1e-9);
    }
  }
  RunRequest request;
  request.from = Stage::Mesh;
  request.parameters.set("mesh.implicit", can, ParamSource::Flag, "test");
  request.parameters.set("mesh.box", "-1.5,-1.5,-1.5,1.5,1.5,1.5", ParamSource::Flag, "test");
  request.parameters.set("mesh.h", ".25", ParamSource::Flag, "test");
  EXPECT_EQ(measured_by(mesh).dump(1), measured_by_program(folder.path, request).dump(1));
}

TEST(Umtet, WhatHasNoMeshIsAnErrorWithEvidence) {
  Options options;
  options.box = Box(Vec3::Constant(-1), Vec3::Constant(1));
  options.body.mesh.h = .2;
  EXPECT_THROW(mesh_body(Expression("z^2 + .001 + x^2"), options), MeshingImpossible);  // psi < 0 nowhere
  EXPECT_THROW(mesh_body(Expression("x"), Options()), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
