// The built program, from outside: colours and temperatures of a scan at the boundary of its mesh.

#include <cmath>
#include <cstdio>

#include "mesh/io/tet_mesh_io.h"
#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

constexpr int kSamples = 4000;
const double kSpacing = std::sqrt(4 * M_PI / kSamples);  // of the unit sphere

class ScanFields : public Program {
 protected:
  using Line = std::function<std::string(const Vec3& x)>;
  static std::string temperature(const Vec3& x) { return std::to_string(20 + 5 * x.x()); }

  /// Even points of the unit sphere with normals and what `more` says, but for those it says nothing of.
  void write_sphere(const std::string& name, const std::vector<std::string>& properties, const Line& more) const {
    std::vector<std::string> rows;
    for (int i = 0; i < kSamples; ++i) {
      const double z = 1 - (2 * i + 1.) / kSamples, r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
      const Vec3 x(r * std::cos(a), r * std::sin(a), z);
      const std::string values = more(x);
      if (values.empty()) continue;
      char row[200];
      std::snprintf(row, sizeof(row), "%.17g %.17g %.17g %.17g %.17g %.17g ", x[0], x[1], x[2], x[0], x[1], x[2]);
      rows.push_back(row + values);
    }
    write_rows(name, properties, rows);
  }
  void write_rows(const std::string& name, const std::vector<std::string>& properties,
                  const std::vector<std::string>& rows) const {
    std::ofstream out(folder / name);
    out << "ply\nformat ascii 1.0\nelement vertex " << rows.size() << '\n';
    for (const char* p : {"x", "y", "z", "nx", "ny", "nz"}) out << "property double " << p << '\n';
    for (const std::string& p : properties) out << "property " << p << '\n';
    out << "end_header\n";
    for (const std::string& row : rows) out << row << '\n';
  }
  MeshFile mesh(const std::string& file) const { return read_tet_mesh(folder / file); }
  template <class T = double>
  static const std::vector<T>& data(const std::map<std::string, FieldValues>& of, const std::string& name) {
    return std::get<std::vector<T>>(of.at(name));
  }
};

TEST_F(ScanFields, ATemperatureReachesTheBoundaryAndNothingElse) {
  write_sphere("ball.ply", {"float temperature", "uchar red", "uchar green", "uchar blue"},
               [](const Vec3& x) { return temperature(x) + (x.y() < 0 ? " 255 0 0" : " 0 0 255"); });
  const Result r = run("run ball.ply -o ball --tets 8000 --export vtu,msh,xdmf,inp");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.err.find("rgb, temperature"), std::string::npos) << r.err;
  EXPECT_EQ(Json::parse(content(folder / "ball/1-cloud/record.json"))["numbers"]["fields"],
            Json({"rgb", "temperature"}));
  for (const char* file : {"ball/3-mesh/mesh.vtu", "ball/4-export/mesh.vtu"}) {
    const MeshFile made = mesh(file);
    const auto& boundary = data<std::uint8_t>(made.point_data, "boundary");
    const auto& heat = data(made.point_data, "scan_temperature");
    const auto& rgb = data<Vec3>(made.point_data, "scan_rgb");
    double sum2 = 0, n = 0;
    for (std::size_t i = 0; i < boundary.size(); ++i) {
      EXPECT_EQ(std::isnan(heat[i]), boundary[i] == 0);
      EXPECT_EQ(std::isnan(rgb[i][1]), boundary[i] == 0);
      if (boundary[i] == 0) continue;
      // Thirteen samples lie within two and a half spacings: no mean is farther off than the gradient, 5, takes it.
      const double error = heat[i] - 20 - 5 * made.mesh.V[i].x();
      EXPECT_LT(std::abs(error), 5 * 2.5 * kSpacing);
      sum2 += error * error;
      ++n;
      if (std::abs(made.mesh.V[i].y()) < 2.5 * kSpacing) continue;
      const Vec3 expected = made.mesh.V[i].y() < 0 ? Vec3(1, 0, 0) : Vec3(0, 0, 1);
      EXPECT_LT((rgb[i] - expected).norm(), 1e-12);
    }
    EXPECT_LT(std::sqrt(sum2 / n), 5 * .2 * kSpacing) << "samples lie on all sides";
  }
  EXPECT_NE(content(folder / "ball/4-export/mesh.msh").find("\"scan_temperature\""), std::string::npos);
  EXPECT_NE(content(folder / "ball/4-export/mesh_boundary.xdmf").find("scan_rgb"), std::string::npos);
  EXPECT_EQ(content(folder / "ball/4-export/mesh.inp").find("scan_"), std::string::npos);
  const std::string page = content(folder / "ball/report.html");
  EXPECT_NE(page.find("block-vertex_field_1"), std::string::npos);
  const Result inspected = run("inspect ball.ply");
  EXPECT_NE(inspected.out.find("fields    rgb, temperature\n"), std::string::npos) << inspected.out;
}

TEST_F(ScanFields, StagesOneByOneGiveTheSameBytesWithAnyNumberOfThreads) {
  write_sphere("ball.ply", {"float temperature"}, temperature);
  ASSERT_EQ(run("run ball.ply -o whole --tets 3000 --threads 2").code, 0);
  ASSERT_EQ(run("run ball.ply -o parts --threads 1 --until cloud").code, 0);
  ASSERT_EQ(run("run ball.ply -o parts --tets 3000 --threads 1").code, 0);
  fs::remove_all(folder / "parts/3-mesh");
  ASSERT_EQ(run("run ball.ply -o parts --tets 3000 --threads 2").code, 0);
  for (const char* file : {"1-cloud/cloud.ply", "3-mesh/mesh.vtu"}) {
    EXPECT_EQ(content(folder / "whole" / file), content(folder / "parts" / file)) << file;
  }
}

TEST_F(ScanFields, MidSidesHaveThemWithSecondOrder) {
  write_sphere("ball.ply", {"float temperature"}, temperature);
  ASSERT_EQ(run("run ball.ply -o ball --tets 2000 --order 2 --export vtu").code, 0);
  for (const char* file : {"ball/3-mesh/mesh.vtu", "ball/4-export/mesh.vtu"}) {
    const MeshFile made = mesh(file);
    const auto& boundary = data<std::uint8_t>(made.quadratic_data, "boundary");
    const auto& heat = data(made.quadratic_data, "scan_temperature");
    ASSERT_GT(heat.size(), made.mesh.V.size());
    for (std::size_t i = 0; i < heat.size(); ++i) {
      EXPECT_EQ(std::isnan(heat[i]), boundary[i] == 0) << file << ' ' << i;
      if (boundary[i] == 0) continue;
      EXPECT_NEAR(heat[i], 20 + 5 * made.quadratic->V[i].x(), 5 * 2.5 * kSpacing);
    }
  }
}

TEST_F(ScanFields, AHoleHasNone) {
  write_sphere("hole.ply", {"float temperature"},
               [](const Vec3& x) { return x.x() > std::cos(.6) ? std::string() : temperature(x); });
  ASSERT_EQ(run("run hole.ply -o hole --tets 8000").code, 0);
  const MeshFile made = mesh("hole/3-mesh/mesh.vtu");
  const auto &heat = data(made.point_data, "scan_temperature"), &support = data(made.point_data, "support");
  const Json certificate = Json::parse(content(folder / "hole/certificate.json"));
  const double radius = certificate["domain"]["support_radius"];
  int n_none = 0;
  for (std::size_t i = 0; i < heat.size(); ++i) {
    if (support[i] < 0) continue;
    EXPECT_EQ(std::isnan(heat[i]), support[i] >= radius) << support[i];
    n_none += std::isnan(heat[i]);
  }
  EXPECT_GT(n_none, 10);
}

TEST_F(ScanFields, TheSidesOfAThinPlateDoNotMix) {
  // 2 x 2 x .1, samples .05 apart: half a thickness. Above 80 degrees, below 20, between them at the rim.
  std::vector<std::string> rows;
  const auto add = [&](const Vec3& x, const Vec3& n, double t) {
    std::ostringstream row;
    row << x.transpose() << ' ' << n.transpose() << ' ' << t;
    rows.push_back(row.str());
  };
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      const double x = -1 + .05 * (i + .5), y = -1 + .05 * (j + .5);
      add({x, y, .05}, Vec3::UnitZ(), 80);
      add({x, y, -.05}, -Vec3::UnitZ(), 20);
    }
    for (const double z : {-.025, .025}) {
      for (const double side : {-1., 1.}) {
        const double s = -1 + .05 * (i + .5);
        add({side, s, z}, side * Vec3::UnitX(), 50);
        add({s, side, z}, side * Vec3::UnitY(), 50);
      }
    }
  }
  write_rows("plate.ply", {"float temperature"}, rows);
  const Result r = run("run plate.ply -o plate --h .05");
  ASSERT_TRUE(fs::exists(folder / "plate/3-mesh/mesh.vtu")) << r.err;
  const MeshFile made = mesh("plate/3-mesh/mesh.vtu");
  const auto& heat = data(made.point_data, "scan_temperature");
  int n = 0;
  for (std::size_t i = 0; i < heat.size(); ++i) {
    const Vec3& x = made.mesh.V[i];
    if (std::isnan(heat[i]) || std::abs(x.x()) > .8 || std::abs(x.y()) > .8) continue;
    EXPECT_NEAR(heat[i], x.z() > 0 ? 80 : 20, 1e-9) << x.transpose();
    ++n;
  }
  EXPECT_GT(n, 1000);
}

TEST_F(ScanFields, NamesOfOursStayOurs) {
  write_sphere("names.ply", {"float support", "float boundary", "float wall", "float scan_support", "int label"},
               [](const Vec3& x) { return "7 8 9 10 " + std::to_string(x.z() < 0 ? 1 : 2); });
  const Result r = run("run names.ply -o names --tets 2000 --export vtu --label-names 1=support");
  ASSERT_EQ(r.code, 0) << r.err;
  const MeshFile made = mesh("names/3-mesh/mesh.vtu");
  std::map<std::string, double> first = {
      {"scan_support", 7}, {"scan_boundary", 8}, {"scan_wall", 9}, {"scan_scan_support", 10}};
  const auto& boundary = data<std::uint8_t>(made.point_data, "boundary");
  const auto& support = data(made.point_data, "support");
  for (std::size_t i = 0; i < boundary.size(); ++i) {
    EXPECT_EQ(support[i] < 0, boundary[i] == 0);
    if (boundary[i] == 0) continue;
    for (const auto& [name, value] : first) EXPECT_NEAR(data(made.point_data, name)[i], value, 1e-12);
  }
  EXPECT_FALSE(made.point_data.contains("scan_label"));
}

TEST_F(ScanFields, CloudsWithoutThemHaveNoneInTheirFiles) {
  const Result r = run("run egg.ply -o egg --tets 2000 --export vtu");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(content(folder / "egg/3-mesh/mesh.vtu").find("scan_"), std::string::npos);
  EXPECT_FALSE(Json::parse(content(folder / "egg/1-cloud/record.json"))["numbers"].contains("fields"));
}

}  // namespace
}  // namespace umtet
