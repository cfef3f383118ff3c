#include "pipeline/output/case_diff.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh/certify/boundary_surface.h"
#include "mesh/implicit/surface_distance.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/stages/stages.h"
#include "reconstruct/io/level_set_io.h"
#include "reconstruct/io/point_cloud_io.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

// Lines of differing numbers a stage in the text; the document has them all.
constexpr std::size_t kListed = 8;

/// Largest and root of the mean square.
Json spread(const std::vector<double>& d) {
  double max = 0, sum = 0;
  for (const double v : d) {
    max = std::max(max, v);
    sum += v * v;
  }
  return {{"max", max}, {"rms", d.empty() ? 0 : std::sqrt(sum / static_cast<double>(d.size()))}};
}

/// Adds {at, a, b} for every leaf in which the two documents differ.
void add_differences(const Json& a, const Json& b, const std::string& pointer, Json& list) {
  if (a == b) return;
  if (!a.is_object() || !b.is_object()) {
    list.push_back({{"at", pointer}, {"a", a}, {"b", b}});
    return;
  }
  const auto below = [&](const std::string& key) { return pointer + "/" + key; };
  for (const auto& [key, value] : a.items()) {
    add_differences(value, b.contains(key) ? b[key] : Json(nullptr), below(key), list);
  }
  for (const auto& [key, value] : b.items()) {
    if (!a.contains(key)) add_differences(nullptr, value, below(key), list);
  }
}

Json cloud_difference(const CasePaths& a, const CasePaths& b) {
  const OrientedPointCloud x = read_point_cloud(a.cloud()).cloud, y = read_point_cloud(b.cloud()).cloud;
  return {{"n_a", x.points.size()},
          {"n_b", y.points.size()},
          {"a_to_b", spread(SampleDistance(y.points).distances(x.points, until_interrupted()))},
          {"b_to_a", spread(SampleDistance(x.points).distances(y.points, until_interrupted()))}};
}

Json level_set_difference(const CasePaths& a, const CasePaths& b, const StageRecord& record_a,
                          const StageRecord& record_b) {
  const LevelSet psi_a = read_level_set(a.level_set()), psi_b = read_level_set(b.level_set());
  const Vec3 shift_a = recorded_vector(record_a, "shift"), shift_b = recorded_vector(record_b, "shift");
  const std::vector<Vec3> x = read_point_cloud(a.cloud()).cloud.points;
  std::vector<double> d(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    d[i] = std::abs(psi_a.value(x[i] - shift_a) - psi_b.value(x[i] - shift_b));
  }
  return {{"spacing_a", psi_a.spacing()}, {"spacing_b", psi_b.spacing()}, {"psi_at_samples_of_a", spread(d)}};
}

struct Skin {
  MeshFile file;
  std::vector<Triangle> faces;
  std::vector<Vec3> corners;

  explicit Skin(const CasePaths& paths) : file(read_tet_mesh(paths.mesh())) {
    const TetMesh& mesh = file.mesh;
    faces = boundary_faces(mesh.C, mesh.V.size()).triangles;
    std::vector<char> used(mesh.V.size(), 0);
    for (const Triangle& f : faces) {
      for (const int v : f) used[v] = 1;
    }
    for (std::size_t v = 0; v < used.size(); ++v) {
      if (used[v]) corners.push_back(mesh.V[v]);
    }
  }
  std::vector<double> distances(const std::vector<Vec3>& x) const {
    return SurfaceDistance(file.mesh.V, faces).distances(x, until_interrupted());
  }
};

Json mesh_difference(const CasePaths& a, const CasePaths& b) {
  const Skin x(a), y(b);
  Json json = {{"n_tets_a", x.file.mesh.C.size()},
               {"n_tets_b", y.file.mesh.C.size()},
               {"same_tets", x.file.mesh.C == y.file.mesh.C},
               {"boundary_a_to_b", spread(y.distances(x.corners))},
               {"boundary_b_to_a", spread(x.distances(y.corners))}};
  if (!json["same_tets"]) return json;
  std::vector<double> moves;
  for (std::size_t v = 0; v < x.file.mesh.V.size(); ++v) {
    moves.push_back((x.file.mesh.V[v] - y.file.mesh.V[v]).norm());
  }
  json["moves"] = spread(moves);
  return json;
}

std::optional<StageRecord> record_of(const CasePaths& paths, Stage stage) {
  // Parameters do not matter here: whatever made the stage, it must be whole.
  StageState state = inspect_stage(paths, stage, Json::object(), std::nullopt);
  if (state.kind == StageState::Kind::Damaged) throw ArtefactDamaged(state.reason);
  return std::move(state.record);
}

Json difference_of(Stage stage, const CasePaths& a, const CasePaths& b, const StageRecord& record_a,
                   const StageRecord& record_b) {
  try {
    if (stage == Stage::Cloud) return cloud_difference(a, b);
    if (stage == Stage::LevelSet) return level_set_difference(a, b, record_a, record_b);
    return mesh_difference(a, b);
  } catch (const CloudRefused& e) {  // these files are ours: what is wrong with them is damage
    throw ArtefactDamaged(e.what());
  } catch (const LevelSetRefused& e) {
    throw ArtefactDamaged(e.what());
  } catch (const MeshFileRefused& e) {
    throw ArtefactDamaged(e.what());
  }
}

Json diff_stage(Stage stage, const CasePaths& a, const CasePaths& b) {
  Json json = {{"stage", to_string(stage)}};
  const std::optional<StageRecord> x = record_of(a, stage), y = record_of(b, stage);
  json["in_a"] = x.has_value();
  json["in_b"] = y.has_value();
  json["same"] = x.has_value() == y.has_value() && (!x || x->outputs == y->outputs);
  if (!x || !y) return json;
  Json parameters = Json::array(), numbers = Json::array();
  add_differences(x->parameters, y->parameters, "", parameters);
  add_differences(x->numbers, y->numbers, "", numbers);
  json["parameters"] = parameters;
  json["numbers"] = numbers;
  if (!json["same"]) json["difference"] = difference_of(stage, a, b, *x, *y);
  return json;
}

std::string lines_of(const Json& differences, const char* what) {
  std::string out;
  std::size_t n = 0;
  for (const Json& d : differences) {
    if (++n > kListed) continue;
    out += fmt::format("  {} {}: {} | {}\n", what, d.at("at").get<std::string>().substr(1), d.at("a").dump(),
                       d.at("b").dump());
  }
  if (n > kListed) out += fmt::format("  and {} more\n", n - kListed);
  return out;
}

std::string shown(const Json& spread) {
  return fmt::format("max {:.3g}, rms {:.3g}", spread.at("max").get<double>(), spread.at("rms").get<double>());
}

}  // namespace

Json diff_cases(const CasePaths& a, const CasePaths& b, Progress& progress) {
  for (const CasePaths* paths : {&a, &b}) {
    if (!fs::exists(paths->parameters())) {
      throw UsageError(paths->root.string() + " is not a case: it has no case.toml");
    }
  }
  Json stages = Json::array(), first = nullptr;
  for (const Stage stage : kStages) {
    stop_if_interrupted();
    progress.report("diff", to_string(stage), (static_cast<double>(stage) - 1) / kStages.size());
    stages.push_back(diff_stage(stage, a, b));
    if (first.is_null() && !stages.back()["same"]) first = to_string(stage);
  }
  return {{"a", a.root.string()}, {"b", b.root.string()}, {"first_difference", first}, {"stages", stages}};
}

std::string diff_text(const Json& diff) {
  const Json& first = diff.at("first_difference");
  std::string out =
      first.is_null() ? "the same files in all stages\n" : "first difference: " + first.get<std::string>() + "\n";
  for (const Json& s : diff.at("stages")) {
    const bool in_a = s.at("in_a"), in_b = s.at("in_b");
    if (!in_a && !in_b) continue;
    out += s.at("stage").get<std::string>() + ": ";
    if (in_a != in_b) {
      out += fmt::format("only in {}\n", diff.at(in_a ? "a" : "b").get<std::string>());
      continue;
    }
    out += s.at("same") ? "same files\n" : "differs\n";
    out += lines_of(s.at("parameters"), "parameter");
    if (!s.contains("difference")) continue;
    for (const auto& [name, value] : s["difference"].items()) {
      out += fmt::format("  {}: {}\n", name, value.is_object() ? shown(value) : value.dump());
    }
    out += lines_of(s.at("numbers"), "number");
  }
  return out;
}

}  // namespace umtet
