#include "examples/swimmer/swim_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "mesh/core/tet_quality.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/artefact.h"

namespace umtet {
namespace {

std::string csv(std::span<const SwimRow> rows) {
  std::string text = "t,velocity,z0,F_deformation,F_translation,min_Q,tets,volume_gap,seconds\n";
  for (const auto& [s, Q, n_tets, gap, seconds] : rows) {
    text += fmt::format("{},{},{},{},{},{:.4f},{},{:.4f},{:.2f}\n", s.t, s.velocity, s.z0, s.F_deformation,
                        s.F_translation, Q, n_tets, gap, seconds);
  }
  return text;
}

std::string pvd(std::span<const SwimRow> rows, const auto& file_of) {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
  for (std::size_t k = 0; k < rows.size(); ++k) {
    text += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", rows[k].step.t, file_of(k));
  }
  return text + "</Collection>\n</VTKFile>\n";
}

/// Draws a curve with marks in a frame of 560 x 200 at (60, top): points (t, y), with the minimum and maximum at the
/// axes.
std::string panel(double top, const char* name, const std::vector<std::pair<double, double>>& points) {
  double t0 = points.front().first, t1 = points.back().first, y0 = 0, y1 = 0;
  for (const auto& [t, y] : points) y0 = std::min(y0, y), y1 = std::max(y1, y);
  // A curve with one point, or with all values zero, also has a frame.
  if (!(t1 > t0)) t0 -= .5, t1 += .5;
  if (!(y1 > y0)) y0 -= .5, y1 += .5;
  const auto px = [&](double t) { return 60 + 560 * (t - t0) / (t1 - t0); };
  const auto py = [&](double y) { return top + 200 * (y1 - y) / (y1 - y0); };
  std::string curve, marks;
  for (const auto& [t, y] : points) {
    curve += fmt::format("{:.1f},{:.1f} ", px(t), py(y));
    marks += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>\n", px(t), py(y));
  }
  std::string text = fmt::format(
      "<rect x=\"60\" y=\"{}\" width=\"560\" height=\"200\" fill=\"none\" stroke=\"#888\"/>\n"
      "<line x1=\"60\" x2=\"620\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#ccc\"/>\n"
      "<polyline points=\"{}\" fill=\"none\" stroke=\"#1f77b4\" stroke-width=\"1.5\"/>\n"
      "<g fill=\"#1f77b4\">\n{}</g>\n<text x=\"66\" y=\"{}\">{}</text>\n",
      top, py(0), py(0), curve, marks, top - 5, name);
  for (const double y : {y0, y1}) {
    text += fmt::format("<text x=\"54\" y=\"{:.1f}\" text-anchor=\"end\">{:.3g}</text>\n", py(y) + 4, y);
  }
  for (const double t : {t0, (t0 + t1) / 2, t1}) {
    text += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{:.3g}</text>\n", px(t), top + 216, t);
  }
  return text;
}

std::string svg(std::span<const SwimRow> rows) {
  std::vector<std::pair<double, double>> velocity, position;
  for (const SwimRow& row : rows) {
    velocity.emplace_back(row.step.t, row.step.velocity);
    position.emplace_back(row.step.t, row.step.z0);
  }
  return std::string(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"500\" font-family=\"sans-serif\" "
             "font-size=\"12\">\n<rect width=\"640\" height=\"500\" fill=\"white\"/>\n") +
         panel(20, "velocity dz0/dt over t", velocity) + panel(265, "position z0 over t", position) + "</svg>\n";
}

}  // namespace

double min_quality(const FluidMesh& fluid, std::span<const Tet> background) {
  double least = 1;
  for (const int t : fluid.tets) {
    const Tet& K = background[t];
    least = std::min(least, mean_ratio(fluid.V[K[0]], fluid.V[K[1]], fluid.V[K[2]], fluid.V[K[3]]));
  }
  return least;
}

SwimFiles::SwimFiles(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::filesystem::create_directories(folder_ / "fields");
  remove_stale_temporaries(folder_);
  remove_stale_temporaries(folder_ / "fields");
}

std::filesystem::path SwimFiles::field_file(std::size_t row) const {
  return std::filesystem::path("fields") / fmt::format("{:03}.vtu", row);
}

void SwimFiles::write_fields(std::size_t row, const FluidMesh& fluid, std::span<const Tet> background,
                             const ForceFreeMotion& motion) const {
  std::vector<int> local(fluid.V.size(), -1);
  for (const int t : fluid.tets) {
    for (const int v : background[t]) local[v] = 0;
  }
  TetMesh mesh;
  std::vector<std::int64_t> vertex;
  for (std::size_t v = 0; v < local.size(); ++v) {
    if (local[v] < 0) continue;
    local[v] = static_cast<int>(vertex.size());
    vertex.push_back(static_cast<std::int64_t>(v));
    mesh.V.push_back(fluid.V[v]);
  }
  for (const int t : fluid.tets) {
    const Tet& K = background[t];
    mesh.C.push_back({local[K[0]], local[K[1]], local[K[2]], local[K[3]]});
  }
  MeshFile file =
      with_standard_data(std::move(mesh), vertex, std::vector<std::int64_t>(fluid.tets.begin(), fluid.tets.end()));
  const auto add = [&](const std::string& name, const auto& value_at) {
    std::vector<double> values;
    values.reserve(vertex.size());
    for (const std::int64_t v : vertex) values.push_back(value_at(static_cast<std::size_t>(v)));
    file.point_data[name] = std::move(values);
  };
  const auto add_flow = [&](const char* name, const auto& flow) {
    for (int c = 0; c < 3; ++c) {
      add(fmt::format("u_{}_{}", name, "xyz"[c]), [&](std::size_t v) { return flow.u[v][c]; });
    }
    add(fmt::format("p_{}", name), [&](std::size_t v) { return flow.p[v]; });
  };
  add_flow("phi", motion.deformation);
  add_flow("z", motion.translation);
  write_artefact(folder_ / field_file(row), [&](const std::filesystem::path& path) { write_vtu(path, file); });
}

void SwimFiles::write_tables(std::span<const SwimRow> rows, bool fields) const {
  write_text_artefact(folder_ / "swimmer.csv", csv(rows));
  write_text_artefact(folder_ / "swimmer.svg", svg(rows));
  if (!fields) return;
  write_text_artefact(folder_ / "swimmer.pvd", pvd(rows, [&](std::size_t k) { return field_file(k).string(); }));
}

}  // namespace umtet
