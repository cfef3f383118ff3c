// The facade and the program are two ways to one mesh: its certificate is the same, field by field.

#include "umtet/umtet.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "body/option_names.h"
#include "mesh/expression/expression.h"
#include "mesh/features/formula_domain.h"
#include "mesh/io/surface_files.h"
#include "pipeline/case/artefact.h"
#include "pipeline/output/export_case.h"
#include "pipeline/reports/certificate_report.h"
#include "pipeline/reports/stage_reports.h"
#include "pipeline/run/run.h"
#include "reconstruct/io/grid_io.h"
#include "reconstruct/io/image_io.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/io/triangle_mesh_io.h"
#include "reconstruct/level_set/grid_fit.h"
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

/// The patch of each boundary face in a MEDIT file, by its vertices (from 0, ascending).
std::map<Triangle, int> patches_of_medit(const fs::path& file) {
  std::ifstream in(file);
  std::map<Triangle, int> patches;
  for (std::string word; in >> word && word != "Triangles";) continue;
  std::size_t n = 0;
  in >> n;
  for (std::size_t k = 0; k < n; ++k) {
    Triangle f;
    int patch = 0;
    in >> f[0] >> f[1] >> f[2] >> patch;
    for (int& v : f) --v;
    std::sort(f.begin(), f.end());
    patches[f] = patch;
  }
  return patches;
}

std::map<Triangle, int> patches_of(const Mesh& mesh) {
  std::vector<Triangle> faces = mesh.boundary;
  faces.insert(faces.end(), mesh.walls.begin(), mesh.walls.end());
  EXPECT_EQ(mesh.face_patch.size(), faces.size());
  std::map<Triangle, int> patches;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    std::sort(faces[k].begin(), faces[k].end());
    patches[faces[k]] = mesh.patches.at(static_cast<std::size_t>(mesh.face_patch[k])).number;
  }
  return patches;
}

TEST(Umtet, ThePatchesOfASurfaceAreThoseOfTheExport) {
  const Folder folder;
  const fs::path file = folder.path / "cube.stl";
  const TriangleMesh cube = test::cube();
  write_surface(file, cube.V, cube.F, SurfaceFormat::Stl);
  RunRequest request;
  request.case_folder = folder.path / "case";
  request.source = file;
  request.parameters.set("cloud.file", file.string(), ParamSource::Flag, "test");
  request.parameters.set("mesh.h", ".08", ParamSource::Flag, "test");
  request.parameters.set("reconstruct.edges", "off", ParamSource::Flag, "test");  // the facade rounds them
  Progress quiet(ProgressMode::None, Verbosity::Quiet);
  run_case(request, quiet);
  Options options;
  options.body.mesh.h = .08;
  const FittedBody body = fit_body(read_triangles(file).mesh, options);
  struct Division {
    const char* key;
    double degrees;
    std::size_t n_least;  // patches
  };
  for (const Division& d : {Division{"output.patch_planar", 5, 7}, {"output.patch_angle", 12, 2}, {"", 0, 1}}) {
    Parameters parameters = request.parameters;
    options.patches = {};
    if (d.degrees > 0) {
      parameters.set(d.key, std::to_string(d.degrees), ParamSource::Flag, "test");
      (std::string(d.key) == "output.patch_planar" ? options.patches.planar : options.patches.angle) = d.degrees;
    }
    const std::vector<fs::path> exported = export_case(CasePaths{request.case_folder}, {"mesh"}, parameters, quiet);
    const Mesh mesh = mesh_body(body, options);
    EXPECT_GE(mesh.patches.size(), d.n_least) << d.key;
    EXPECT_EQ(patches_of(mesh), patches_of_medit(exported.front())) << d.key;
  }
}

TEST(Umtet, TheClosedHolesOfAScanAreThePatchOfTheExport) {
  const Folder folder;
  const fs::path file = folder.path / "cloud.ply";
  OrientedPointCloud cloud;
  for (int i = 0; i < 4000; ++i) {
    const double z = 1 - (2 * i + 1) / 4000., r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
    const Vec3 x(r * std::cos(a), r * std::sin(a), z);
    if (x.x() > std::cos(.6)) continue;
    cloud.points.push_back(x);
    cloud.normals.push_back(x);
  }
  {
    std::ofstream out(file, std::ios::binary);
    write_ply(out, cloud);
  }
  RunRequest request;
  request.case_folder = folder.path / "case";
  request.source = file;
  request.parameters.set("cloud.file", file.string(), ParamSource::Flag, "test");
  request.parameters.set("mesh.h", ".1", ParamSource::Flag, "test");
  Progress quiet(ProgressMode::None, Verbosity::Quiet);
  run_case(request, quiet);
  const std::vector<fs::path> exported =
      export_case(CasePaths{request.case_folder}, {"mesh"}, request.parameters, quiet);
  Options options;
  options.body.mesh.h = .1;
  const Mesh mesh = mesh_body(cloud, options);
  ASSERT_EQ(mesh.patches.size(), 2u);
  EXPECT_EQ(mesh.patches[1].name, "closed_holes");
  EXPECT_EQ(patches_of(mesh), patches_of_medit(exported.front()));
}

TEST(Umtet, PatchesFollowLabelsAndWalls) {
  OrientedPointCloud cloud = test::torus_cloud(6000);
  for (const Vec3& x : cloud.points) cloud.labels.push_back(x.x() > 0 ? 7 : 3);
  Options options;
  options.body.mesh.h = .12;
  options.patches.names = {{7, "right"}};
  const Mesh mesh = mesh_body(cloud, options);
  ASSERT_EQ(mesh.patches.size(), 2u);
  EXPECT_EQ(mesh.patches[0].name + mesh.patches[1].name, "patch_3right");
  for (std::size_t f = 0; f < mesh.boundary.size(); ++f) {
    EXPECT_EQ(mesh.patches[mesh.face_patch[f]].number, mesh.labels[f]);
  }

  Options fluid;
  fluid.box = Box(Vec3::Constant(-2), Vec3::Constant(2));
  fluid.body.mesh.h = .3;
  fluid.body.mesh.box_walls = fluid.body.mesh.complement = true;
  const Mesh around = mesh_body(Expression("x^2 + y^2 + z^2 - 1"), fluid);
  ASSERT_EQ(around.patches.size(), 2u);
  EXPECT_EQ(around.patches[1].name, "walls");
  ASSERT_FALSE(around.walls.empty());
  for (std::size_t f = 0; f < around.face_patch.size(); ++f) {
    EXPECT_EQ(around.face_patch[f], f < around.boundary.size() ? 0 : 1);
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

TEST(Umtet, TheCertificateOfAGridIsThatOfTheProgram) {
  const Folder folder;
  const fs::path file = folder.path / "psi.vti";
  Image image{{41, 37, 33}, {-1.4, -1.26, -1.12}, Vec3::Constant(.07), {{"psi", {}}}};
  for (int k = 0; k < image.n[2]; ++k) {
    for (int j = 0; j < image.n[1]; ++j) {
      for (int i = 0; i < image.n[0]; ++i) {
        const Vec3 x = image.origin + image.spacing.cwiseProduct(Vec3(i, j, k));
        image.values[0].second.push_back(static_cast<float>(.6 * (x.cwiseQuotient(Vec3(1, .8, .6)).norm() - 1)));
      }
    }
  }
  write_image(file, image);
  RunRequest request;
  request.from = Stage::Mesh;
  request.parameters.set("mesh.level_set", file.string(), ParamSource::Flag, "test");
  request.parameters.set("mesh.h", ".12", ParamSource::Flag, "test");
  const Json program = measured_by_program(folder.path, request);
  const GridLevelSet psi = interpolate(read_grid(file));
  Options options;
  options.box = psi.box();
  options.body.mesh.h = .12;
  const Mesh mesh = mesh_body(psi, options);
  EXPECT_EQ(measured_by(mesh).dump(1), program.dump(1));
  EXPECT_EQ(mesh.verdict.word(), "pass");
}

TEST(Umtet, PatchesThatCannotBeAreRefusedBeforeTheMesh) {
  Options options;
  options.box = Box(Vec3::Constant(-2), Vec3::Constant(2));
  options.context.progress = [](const char*, double) { ADD_FAILURE() << "work has begun"; };
  options.patches.planar = 90;
  EXPECT_THROW(mesh_body(Expression("x^2 + y^2 + z^2 - 1"), options), std::invalid_argument);
  options.patches = {.angle = 181};
  EXPECT_THROW(mesh_body(Expression("x^2 + y^2 + z^2 - 1"), options), std::invalid_argument);
}

TEST(Umtet, ABodyWithSharpEdgesHasThemAndItsCertificateIsThatOfTheProgram) {
  const Folder folder;
  const std::string can = "max(x^2+y^2-1,abs(z)-1)";
  Options options;
  options.box = Box(Vec3::Constant(-1.5), Vec3::Constant(1.5));
  options.body.mesh.h = .25;
  const Mesh mesh = mesh_body(domain_of_formula(can), options);
  EXPECT_EQ(mesh.verdict.word(), "pass");
  ASSERT_EQ(mesh.patches.size(), 3U);
  for (int p = 0; p < 3; ++p) EXPECT_EQ(mesh.patches[p].name, "patch_" + std::to_string(p + 1));
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
  Progress quiet(ProgressMode::None, Verbosity::Quiet);
  const std::vector<fs::path> exported =
      export_case(CasePaths{folder.path / "case"}, {"mesh"}, request.parameters, quiet);
  EXPECT_EQ(patches_of(mesh), patches_of_medit(exported.front()));
}

TEST(Umtet, BordersOfLabelsAndLinesAreExactInTheMesh) {
  Options options;
  options.body.mesh.h = .1;
  options.patches.names = {{1, "wall"}, {2, "inlet"}};
  TriangleMesh labelled = test::cube_with_imprint();
  TriangleMesh lined = labelled;
  lined.labels.clear();
  lined.lines = {{8, 9}, {9, 10}, {10, 11}, {11, 8}};
  for (const TriangleMesh& given : {labelled, lined}) {
    const Mesh mesh = mesh_body(given, options);
    EXPECT_EQ(mesh.curves.size(), 16U);
    std::map<std::string, double> area;
    for (std::size_t f = 0; f < mesh.boundary.size(); ++f) {
      const auto& [a, b, c] = mesh.boundary[f];
      area[mesh.patches[static_cast<std::size_t>(mesh.face_patch[f])].name] +=
          (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]).norm() / 2;
    }
    if (!given.labels.empty()) {
      EXPECT_EQ(area.size(), 2U);
      EXPECT_NEAR(area["inlet"], .16, 1e-9);
      EXPECT_NEAR(area["wall"], 5.84, 1e-9);
    } else {
      EXPECT_EQ(area.size(), 7U);
      std::vector<double> all;
      for (const auto& [name, value] : area) all.push_back(value);
      std::sort(all.begin(), all.end());
      EXPECT_NEAR(all[0], .16, 1e-9);
      EXPECT_NEAR(all[1], .84, 1e-9);
      EXPECT_NEAR(all[2], 1, 1e-9);
    }
  }
  lined.lines.push_back({0, 12});
  EXPECT_THROW(mesh_body(lined, options), std::invalid_argument);
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
