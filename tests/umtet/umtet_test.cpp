// The facade and the program are two ways to one mesh: its certificate is the same, field by field.

#include "umtet/umtet.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "pipeline/case/artefact.h"
#include "pipeline/expression/expression.h"
#include "pipeline/reports/certificate_report.h"
#include "pipeline/reports/stage_reports.h"
#include "pipeline/run/run.h"
#include "reconstruct/io/point_cloud_io.h"
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

TEST(Umtet, WhatHasNoMeshIsAnErrorWithEvidence) {
  Options options;
  options.box = Box(Vec3::Constant(-1), Vec3::Constant(1));
  options.body.mesh.h = .2;
  EXPECT_THROW(mesh_body(Expression("z^2 + .001 + x^2"), options), MeshingImpossible);  // psi < 0 nowhere
  EXPECT_THROW(mesh_body(Expression("x"), Options()), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
