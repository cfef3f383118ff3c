#include "pipeline/output/case_diff.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "mesh/certify/boundary_surface.h"
#include "mesh/implicit/surface_distance.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/domain/edged_case.h"
#include "pipeline/reports/stage_reports.h"
#include "pipeline/stages/stages.h"
#include "reconstruct/io/level_set_io.h"
#include "reconstruct/io/point_cloud_io.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

// Two numbers that differ by less than this share look alike in three digits.
constexpr double kSeen = 1e-3;
// Maximum number of differing numbers per stage in the text; the document contains all.
constexpr std::size_t kListed = 8;

using Measures = std::vector<std::pair<std::string, StageDiff::Measure>>;

Spread spread(const std::vector<double>& d) {
  double max = 0, sum = 0;
  for (const double v : d) {
    max = std::max(max, v);
    sum += v * v;
  }
  return {max, d.empty() ? 0 : std::sqrt(sum / static_cast<double>(d.size()))};
}

/// Adds every leaf that differs between the two documents.
void add_differences(const Json& a, const Json& b, const std::string& pointer, std::vector<ValueDifference>& list) {
  if (a == b) return;
  if (!a.is_object() || !b.is_object()) {
    list.push_back({pointer, a, b});
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

Measures cloud_difference(const CasePaths& a, const CasePaths& b) {
  const OrientedPointCloud x = read_point_cloud(a.cloud()).cloud, y = read_point_cloud(b.cloud()).cloud;
  return {{"n_a", x.points.size()},
          {"n_b", y.points.size()},
          {"a_to_b", spread(SampleDistance(y.points).distances(x.points, until_interrupted()))},
          {"b_to_a", spread(SampleDistance(x.points).distances(y.points, until_interrupted()))}};
}

Measures level_set_difference(const CasePaths& a, const CasePaths& b, const StageRecord& record_a,
                              const StageRecord& record_b) {
  // A level set and functions of patches have nothing to compare at samples that lie on both.
  if (has_edges(record_a) || has_edges(record_b))
    return {{"keeps_edges_a", has_edges(record_a)}, {"keeps_edges_b", has_edges(record_b)}};
  const LevelSet psi_a = read_level_set(a.level_set()), psi_b = read_level_set(b.level_set());
  const Vec3 shift_a = level_set_report(record_a).shift, shift_b = level_set_report(record_b).shift;
  const std::vector<Vec3> x = read_point_cloud(a.cloud()).cloud.points;
  std::vector<double> d(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    d[i] = std::abs(psi_a.value(x[i] - shift_a) - psi_b.value(x[i] - shift_b));
  }
  return {{"spacing_a", psi_a.spacing()}, {"spacing_b", psi_b.spacing()}, {"psi_at_samples_of_a", spread(d)}};
}

struct BoundarySurface {
  MeshFile file;
  std::vector<Triangle> faces;
  std::vector<Vec3> corners;

  explicit BoundarySurface(const CasePaths& paths) : file(read_tet_mesh(paths.mesh())) {
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

std::size_t n_holes(const StageRecord& record) {
  const std::optional<SupportReport>& support = mesh_report(record).measured.domain.support;
  return support ? support->n_closed_holes : 0;
}

Measures mesh_difference(const CasePaths& a, const CasePaths& b, const StageRecord& record_a,
                         const StageRecord& record_b) {
  const BoundarySurface x(a), y(b);
  const bool same_tets = x.file.mesh.C == y.file.mesh.C;
  Measures measures = {{"n_tets_a", x.file.mesh.C.size()},
                       {"n_tets_b", y.file.mesh.C.size()},
                       {"same_tets", same_tets},
                       {"boundary_a_to_b", spread(y.distances(x.corners))},
                       {"boundary_b_to_a", spread(x.distances(y.corners))}};
  if (const std::size_t in_a = n_holes(record_a), in_b = n_holes(record_b); in_a + in_b > 0) {
    measures.emplace_back("closed_holes_a", in_a);
    measures.emplace_back("closed_holes_b", in_b);
  }
  if (!same_tets) return measures;
  std::vector<double> moves;
  for (std::size_t v = 0; v < x.file.mesh.V.size(); ++v) {
    moves.push_back((x.file.mesh.V[v] - y.file.mesh.V[v]).norm());
  }
  measures.emplace_back("moves", spread(moves));
  return measures;
}

std::optional<StageRecord> record_of(const CasePaths& paths, Stage stage) {
  // Parameters do not matter here, but the stage must be complete.
  StageState state = inspect_stage(paths, stage, Json::object(), std::nullopt);
  if (state.kind == StageState::Kind::Damaged) throw ArtefactDamaged(state.reason);
  return std::move(state.record);
}

Measures difference_of(Stage stage, const CasePaths& a, const CasePaths& b, const StageRecord& record_a,
                       const StageRecord& record_b) {
  try {
    if (stage == Stage::Cloud) return cloud_difference(a, b);
    if (stage == Stage::LevelSet) return level_set_difference(a, b, record_a, record_b);
    return mesh_difference(a, b, record_a, record_b);
  } catch (const CloudRefused& e) {  // umtet wrote these files, so an error in them is damage
    throw ArtefactDamaged(e.what());
  } catch (const LevelSetRefused& e) {
    throw ArtefactDamaged(e.what());
  } catch (const MeshFileRefused& e) {
    throw ArtefactDamaged(e.what());
  }
}

StageDiff diff_stage(Stage stage, const CasePaths& a, const CasePaths& b) {
  StageDiff diff;
  diff.stage = stage;
  const std::optional<StageRecord> x = record_of(a, stage), y = record_of(b, stage);
  diff.in_a = x.has_value();
  diff.in_b = y.has_value();
  diff.same = x.has_value() == y.has_value() && (!x || x->outputs == y->outputs);
  if (!x || !y) return diff;
  add_differences(x->parameters, y->parameters, "", diff.parameters);
  add_differences(x->numbers, y->numbers, "", diff.numbers);
  if (!diff.same) diff.difference = difference_of(stage, a, b, *x, *y);
  return diff;
}

Json to_json(const Spread& spread) { return {{"max", spread.max}, {"rms", spread.rms}}; }

Json to_json(const std::vector<ValueDifference>& differences) {
  Json list = Json::array();
  for (const ValueDifference& d : differences) list.push_back({{"at", d.at}, {"a", d.a}, {"b", d.b}});
  return list;
}

Json to_json(const StageDiff& s) {
  Json json = {{"stage", to_string(s.stage)}, {"in_a", s.in_a}, {"in_b", s.in_b}, {"same", s.same}};
  if (!s.in_a || !s.in_b) return json;
  json["parameters"] = to_json(s.parameters);
  json["numbers"] = to_json(s.numbers);
  if (!s.difference) return json;
  Json measures = Json::object();
  for (const auto& [name, measure] : *s.difference) {
    measures[name] = std::visit(
        []<class T>(const T& value) {
          if constexpr (std::is_same_v<T, Spread>) {
            return to_json(value);
          } else {
            return Json(value);
          }
        },
        measure);
  }
  json["difference"] = std::move(measures);
  return json;
}

/// Returns a value as text. A list of objects, such as holes or thin places, is represented by its length.
std::string shown(const Json& value, bool is_long) {
  if (value.is_null()) return "none";
  if (value.is_number_float() && !is_long) return fmt::format("{:.4g}", value.get<double>());
  if (!value.is_array() || value.empty() || !value.front().is_object()) return value.dump();
  return fmt::format("[{} entr{}]", value.size(), value.size() == 1 ? "y" : "ies");
}

/// Returns whether a user would see the difference: numbers differ in three digits, and neither value is a list of
/// numbers or texts.
bool matters(const ValueDifference& d) {
  const bool is_list = (d.a.is_array() && !d.a.empty() && !d.a.front().is_object()) ||
                       (d.b.is_array() && !d.b.empty() && !d.b.front().is_object());
  if (is_list) return false;
  if (d.a.is_number() && d.b.is_number()) {
    const double a = d.a.get<double>(), b = d.b.get<double>();
    return std::abs(a - b) > kSeen * std::max(std::abs(a), std::abs(b));
  }
  return shown(d.a, false) != shown(d.b, false);
}

std::string lines_of(const std::vector<ValueDifference>& differences, const char* what, bool is_long) {
  std::string out;
  std::size_t n_listed = 0;
  for (const ValueDifference& d : differences) {
    if (!is_long && (n_listed == kListed || !matters(d))) continue;
    ++n_listed;
    out += fmt::format("  {} {}: {} | {}\n", what, d.at.substr(1), shown(d.a, is_long), shown(d.b, is_long));
  }
  if (differences.size() > n_listed) out += fmt::format("  and {} more (-v)\n", differences.size() - n_listed);
  return out;
}

std::string shown(const StageDiff::Measure& measure) {
  return std::visit(
      []<class T>(const T& value) {
        if constexpr (std::is_same_v<T, Spread>) {
          return fmt::format("max {:.3g}, rms {:.3g}", value.max, value.rms);
        } else {
          return Json(value).dump();
        }
      },
      measure);
}

}  // namespace

std::optional<Stage> CaseDiff::first_difference() const {
  const auto it = std::find_if(stages.begin(), stages.end(), [](const StageDiff& s) { return !s.same; });
  if (it == stages.end()) return std::nullopt;
  return it->stage;
}

CaseDiff diff_cases(const CasePaths& a, const CasePaths& b, Progress& progress) {
  for (const CasePaths* paths : {&a, &b}) {
    if (!fs::exists(paths->parameters())) {
      throw UsageError(paths->root.string() + " is not a case: it contains no case.toml");
    }
  }
  CaseDiff diff{a.root.string(), b.root.string(), {}};
  for (const Stage stage : kStages) {
    stop_if_interrupted();
    progress.report("diff", to_string(stage), (static_cast<double>(stage) - 1) / kStages.size());
    diff.stages.push_back(diff_stage(stage, a, b));
  }
  return diff;
}

Json to_json(const CaseDiff& diff) {
  Json stages = Json::array();
  for (const StageDiff& stage : diff.stages) stages.push_back(to_json(stage));
  const std::optional<Stage> first = diff.first_difference();
  return {{"a", diff.a},
          {"b", diff.b},
          {"first_difference", first ? Json(to_string(*first)) : Json(nullptr)},
          {"stages", stages}};
}

std::string diff_text(const CaseDiff& diff, bool is_long) {
  const std::optional<Stage> first = diff.first_difference();
  std::string out =
      first ? std::string("first difference: ") + to_string(*first) + "\n" : "all stages have the same files\n";
  for (const StageDiff& s : diff.stages) {
    if (!s.in_a && !s.in_b) continue;
    out += std::string(to_string(s.stage)) + ": ";
    if (s.in_a != s.in_b) {
      out += fmt::format("only in {}\n", s.in_a ? diff.a : diff.b);
      continue;
    }
    out += s.same ? "same files\n" : "differs\n";
    out += lines_of(s.parameters, "parameter", true);
    if (!s.difference) continue;
    for (const auto& [name, measure] : *s.difference) out += fmt::format("  {}: {}\n", name, shown(measure));
    out += lines_of(s.numbers, "number", is_long);
  }
  return out;
}

}  // namespace umtet
