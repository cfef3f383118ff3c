#include "pipeline/output/stage_strip.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "body/pieces/zero_set_choice.h"
#include "body/piecewise_body.h"
#include "common/polled_loops.h"
#include "mesh/implicit/zero_surface.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/meshing/defect_files.h"
#include "pipeline/output/detail/scene_blocks.h"
#include "pipeline/output/detail/triangle_scene.h"
#include "pipeline/output/stage_layers.h"
#include "pipeline/reports/blame.h"
#include "pipeline/reports/stage_reports.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/io/triangle_mesh_io.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

// Cubes of the surface psi = 0 along the diagonal of the body: 40,000 triangles on a sphere, 0.6 MB of the page.
constexpr double kCubesAcross = 72;
// Each stage besides the last one takes at most this much of a page; of larger meshes, the parts at the middle planes.
constexpr ReportCaps kStageCaps{.faces = 60'000, .tets = 30'000, .points = 0};
// Samples from which the surface is followed; more of them start in the same cubes.
constexpr std::size_t kMostSeeds = 200'000;

/// Returns a word that a shell passes on unchanged.
std::string shell_word(const std::string& text) {
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("/._-+=:,@%").find(c) != std::string_view::npos;
  };
  if (!text.empty() && std::all_of(text.begin(), text.end(), is_plain)) return text;
  std::string word = "'";
  for (const char c : text) c == '\'' ? word += "'\\''" : word += c;
  return word + "'";
}

std::string percent(double share) { return fmt::format("{:.3g} %", 100 * share); }

/// Returns a number with commas between thousands.
std::string count(std::size_t n) {
  return n < 1000 ? std::to_string(n) : count(n / 1000) + fmt::format(",{:03}", n % 1000);
}

/// The stage of the strip at which a user looks for a cause that a certificate names.
std::string stage_of_blame(const std::string& cause) {
  if (cause == "input" || cause == "labels") return "input";
  if (cause == "normals") return "cloud";
  return cause == "level set" ? "level-set" : "mesh";
}

class StripMaker {
 public:
  explicit StripMaker(const StripSource& source) : source_(source) {}
  StageStrip operator()();

 private:
  using Facts = std::vector<std::pair<std::string, std::string>>;
  struct Picture {
    std::string id, name, file, command;
    Facts facts;
    std::optional<double> seconds;
    std::vector<std::string> layers;
    Json scene = nullptr;
    std::string colour;
  };

  std::optional<StageRecord> record(Stage stage) const;
  std::string repeat(const std::string& call) const;
  Picture& add(const char* id, const char* name) {
    Picture& picture = pictures_.emplace_back();
    picture.id = id;
    picture.name = name;
    return picture;
  }
  void take_samples();
  std::vector<std::string> marks() const;
  void add_input();
  void add_cloud();
  void add_level_set();
  void add_mesh_file(const char* id, const char* name, const char* file, const std::string& call);
  void add_mesh();
  void draw_triangles(Picture& picture, const std::vector<Vec3>& V, const std::vector<Triangle>& F, const Vec3& shift);
  void draw_zero_set(Picture& picture);
  void put_scene(Picture& picture, const SceneHead& head, std::vector<std::pair<std::string, std::string>> blocks);
  void add_failed_stage();
  Json blame() const;
  std::string shown(const Json& blame) const;

  const StripSource& source_;
  std::optional<StageRecord> cloud_record_, fit_record_, mesh_record_;
  std::vector<Picture> pictures_;
  SampleLayers samples_;
  std::vector<std::pair<std::string, std::string>> blocks_;
};

std::optional<StageRecord> StripMaker::record(Stage stage) const {
  if (!fs::exists(source_.paths.record(stage))) return std::nullopt;
  return read_record(source_.paths, stage);
}

/// Returns commands that repeat a stage in a copy of the case, which `umtet diff` compares with the case.
std::string StripMaker::repeat(const std::string& call) const {
  const std::string root = fs::absolute(source_.paths.root).lexically_normal().string();
  const std::string plain = root.ends_with('/') ? root.substr(0, root.size() - 1) : root;
  const std::string copy = shell_word(plain + "-2");
  return "cp -r " + shell_word(plain) + " " + copy + " && umtet " +
         fmt::format(fmt::runtime(call), fmt::arg("copy", copy));
}

void StripMaker::put_scene(Picture& picture, const SceneHead& head,
                           std::vector<std::pair<std::string, std::string>> blocks) {
  picture.scene = to_json(head);
  for (auto& [name, text] : blocks) {
    if (name != "points") blocks_.emplace_back(picture.id + "_" + name, std::move(text));
  }
}

void StripMaker::take_samples() {
  std::vector<MarkedSample> marked;
  const fs::path file = source_.paths.folder(Stage::Cloud) / kMarkedFile;
  if (cloud_record_ && fs::exists(file)) marked = read_marked(file);
  if (source_.domain && source_.domain->has_samples()) {
    samples_ = sample_layers(source_.domain->cloud, source_.domain->shift, marked, source_.domain);
  } else if (cloud_record_) {
    samples_ = sample_layers(read_point_cloud(source_.paths.cloud()).cloud, Vec3::Zero(), marked, nullptr);
  }
}

std::vector<std::string> StripMaker::marks() const {
  std::vector<std::string> ids;
  for (const SampleLayer& layer : samples_.layers)
    if (layer.id != "samples") ids.push_back(layer.id);
  return ids;
}

void StripMaker::draw_triangles(Picture& picture, const std::vector<Vec3>& V, const std::vector<Triangle>& F,
                                const Vec3& shift) {
  if (F.empty()) return;
  ReportScene scene = detail::triangle_scene(V, F, shift, kStageCaps.faces);
  put_scene(picture, scene.head, std::move(scene.blocks));
}

void StripMaker::draw_zero_set(Picture& picture) {
  const Domain& domain = *source_.domain;
  std::vector<Vec3> seeds;
  const std::size_t step = domain.cloud.points.size() / kMostSeeds + 1;
  for (std::size_t i = 0; i < domain.cloud.points.size(); i += step) seeds.push_back(domain.cloud.points[i]);
  const ZeroSurface surface = domain.with_psi_apart([&](ImplicitFunctionRef psi) {
    return zero_surface(psi, domain.box, domain.diagonal / kCubesAcross, seeds, until_interrupted());
  });
  if (surface.F.empty()) return;
  std::vector<detail::VertexField> fields;
  std::vector<double> support(surface.V.size()), residual(surface.V.size());
  if (domain.has_samples()) {
    const NeighbourTree tree(domain.cloud.points);
    const std::vector<double> of_samples = residuals(domain, domain.cloud.points);
    polled_parallel_for(surface.V.size(), umtet::kValuesPerPoll, until_interrupted(), [&](std::size_t v) {
      std::array<Neighbour, 1> room;
      const auto nearest = tree.k_nearest(surface.V[v], room);
      support[v] = std::sqrt(nearest[0].distance2);
      residual[v] = of_samples[nearest[0].point];
    });
    double most = 0;
    for (const double r : residual)
      if (!std::isnan(r)) most = std::max(most, r);
    fields.push_back({"residual of the nearest sample", residual, {0, most}});
  }
  ReportScene scene = detail::triangle_scene(surface.V, surface.F, domain.shift, surface.F.size(), fields);
  if (domain.has_samples()) {
    const double far = *std::max_element(support.begin(), support.end());
    scene.head.support = {0, far};
    scene.head.support_radius = support_radius(domain);
    std::vector<std::uint8_t> bytes;
    for (const int v : detail::order_of_use(surface.F, surface.V.size()))
      bytes.push_back(detail::in_steps(support[v], 0, far));
    scene.blocks.emplace_back("vertex_support", detail::byte_block(bytes));
    picture.colour = "support";
  }
  if (domain.piecewise && domain.piecewise->graph) {
    std::vector<Vec3> ends;
    for (const FeatureCurve& curve : domain.piecewise->graph->curves) {
      for (std::size_t k = 0; k + 1 < curve.points.size(); ++k)
        ends.insert(ends.end(), {curve.points[k] + domain.shift, curve.points[k + 1] + domain.shift});
    }
    if (!ends.empty())
      scene.blocks.emplace_back("curves", detail::position_block(ends, scene.head.box_min, scene.head.box_size));
  }
  put_scene(picture, scene.head, std::move(scene.blocks));
}

void StripMaker::add_input() {
  if (!cloud_record_) return;
  const CloudReport report = cloud_report(*cloud_record_);
  Picture& p = add("input", "input");
  p.file = cloud_record_->run.source;
  p.command = "umtet inspect " + shell_word(p.file);
  p.facts.emplace_back("format", report.format);
  if (report.triangles) {
    p.facts.emplace_back("triangles", count(report.triangles->n_faces));
    if (source_.domain && source_.domain->triangles) {
      const TriangleMesh& mesh = source_.domain->triangles->mesh;
      draw_triangles(p, mesh.V, mesh.F, source_.domain->shift);
    } else if (fs::exists(source_.paths.triangles())) {
      const TriangleMesh mesh = read_triangles(source_.paths.triangles()).mesh;
      draw_triangles(p, mesh.V, mesh.F, Vec3::Zero());
    }
  } else {
    p.facts.emplace_back("points", count(report.n_points_in_file));
    p.facts.emplace_back("normals", report.normals.given ? "given" : "none, or not used");
    p.layers = {"samples"};
    for (const std::string& id : marks())
      if (id != "turned" && id != "doubtful") p.layers.push_back(id);
  }
  const Vec3 size = report.box.sizes();
  p.facts.emplace_back("size", fmt::format("{:.4g} × {:.4g} × {:.4g}", size.x(), size.y(), size.z()));
}

void StripMaker::add_cloud() {
  if (!cloud_record_) return;
  const CloudReport report = cloud_report(*cloud_record_);
  Picture& p = add("cloud", "cloud");
  p.file = source_.paths.cloud().string();
  p.seconds = cloud_record_->run.seconds;
  p.layers = {"samples", "normals"};
  for (std::string& id : marks()) p.layers.push_back(std::move(id));
  p.facts.emplace_back("samples", count(report.n_points));
  const CloudReport::Dropped& d = report.dropped;
  if (report.merged) p.facts.emplace_back("merged from", count(report.merged->n_points) + " points");
  const auto dropped = [&](const char* what, std::size_t n) {
    if (n > 0) p.facts.emplace_back(fmt::format("dropped {}", what), count(n));
  };
  dropped("outliers", d.outliers);
  dropped("points of small pieces", d.small_components);
  dropped("duplicates", d.duplicates);
  dropped("points that are no numbers", d.not_finite);
  const NormalsReport& normals = report.normals;
  p.facts.emplace_back("normals", normals.given ? "given" : "estimated");
  if (normals.orientation) {
    p.facts.emplace_back("consistent", percent(normals.orientation->consistency) + " before, " +
                                           percent(normals.orientation->consistency_after) + " after");
    if (normals.given && normals.orientation->n_turned > 0)
      p.facts.emplace_back("turned", count(normals.orientation->n_turned));
    if (normals.orientation->n_doubtful > 0)
      p.facts.emplace_back("side is a guess", count(normals.orientation->n_doubtful));
  }
  const bool drops = d.outliers + d.small_components > 0;
  p.command = repeat(drops           ? "run {copy} --until cloud --keep-all"
                     : normals.given ? "run {copy} --until cloud --normals estimate"
                                     : "run {copy} --until cloud --flip");
}

void StripMaker::add_level_set() {
  const bool is_alone = has_own_psi(source_.parameters.mesh());
  if (!fit_record_ && !(is_alone && source_.domain)) return;
  Picture& p = add("level-set", "level set");
  if (is_alone) {
    const MeshParameters& mesh = source_.parameters.mesh();
    p.facts.emplace_back(mesh.implicit.empty() ? "file" : "formula",
                         mesh.implicit.empty() ? mesh.level_set : mesh.implicit);
    if (mesh.implicit.empty()) p.file = mesh.level_set;
    if (!mesh.implicit.empty() && !mesh.box.empty())
      p.command = "umtet inspect --implicit " + shell_word(mesh.implicit) + " --box=" + mesh.box;
  } else {
    const LevelSetReport report = level_set_report(*fit_record_);
    p.seconds = fit_record_->run.seconds;
    p.file = (source_.paths.folder(Stage::LevelSet) / fit_record_->outputs.front().name).string();
    if (source_.domain && source_.domain->piecewise) {
      const auto& graph = source_.domain->piecewise->graph;
      if (graph) p.facts.emplace_back("sharp edges", count(graph->curves.size()));
      if (graph) p.facts.emplace_back("corners", count(graph->corners.size()));
      p.facts.emplace_back("noise", fmt::format("{:.3g}", report.noise));
      p.command = repeat("reconstruct {copy} --edges off");
    } else {
      double finest = report.fit.spacing;
      for (const BandReport& band : report.fit.bands) finest = std::min(finest, band.spacing);
      p.facts.emplace_back("finest spacing", fmt::format("{:.4g}", finest));
      p.facts.emplace_back("nodes", count(report.fit.n_nodes));
      p.facts.emplace_back("distance of samples, rms", fmt::format("{:.3g}", report.fit.rms_value));
      p.facts.emplace_back("noise of samples", fmt::format("{:.3g}", report.noise));
      if (report.fit.n_opposed_normals > 0)
        p.facts.emplace_back("normals against grad ψ", count(report.fit.n_opposed_normals));
      if (!report.fit.holes.empty()) p.facts.emplace_back("holes closed", count(report.fit.holes.size()));
      p.command = repeat(fmt::format("reconstruct {{copy}} --spacing {:.4g}", finest / 2));
    }
  }
  if (source_.domain) draw_zero_set(p);
}

/// Drops boundary faces of a part of a mesh that are inside of the mesh.
void keep_faces_of_boundary(SolverMesh& divided, const MeshFile& mesh) {
  const auto found = mesh.point_data.find("boundary");
  const auto* on_boundary =
      found == mesh.point_data.end() ? nullptr : std::get_if<std::vector<std::uint8_t>>(&found->second);
  if (!on_boundary) return;
  std::size_t n = 0;
  for (std::size_t f = 0; f < divided.n_faces(); ++f) {
    const auto& corners = kTetFace[divided.face_opposite[f]];
    const Tet& tet = mesh.mesh.C[divided.face_tet[f]];
    if (std::any_of(corners.begin(), corners.end(), [&](int k) { return (*on_boundary)[tet[k]] == 0; })) continue;
    divided.face_tet[n] = divided.face_tet[f];
    divided.face_opposite[n] = divided.face_opposite[f];
    divided.face_patch[n++] = divided.face_patch[f];
  }
  divided.face_tet.resize(n);
  divided.face_opposite.resize(n);
  divided.face_patch.resize(n);
}

void StripMaker::add_mesh_file(const char* id, const char* name, const char* file, const std::string& call) {
  const bool has_failed = !mesh_record_;
  const fs::path path = (has_failed ? source_.paths.failed() : source_.paths.folder(Stage::Mesh)) / file;
  if (!source_.domain || !fs::exists(path)) return;
  MeshFile mesh;
  try {
    mesh = read_tet_mesh(path);
  } catch (const MeshFileRefused& e) {
    throw ArtefactDamaged(e.what());
  }
  if (mesh.mesh.C.empty() || !mesh.cell_data.contains("mean_ratio")) return;
  SolverMesh divided = solver_mesh(mesh.mesh);
  keep_faces_of_boundary(divided, mesh);
  Picture& p = add(id, name);
  ReportScene scene = report_scene(mesh, *source_.domain, divided, kStageCaps);
  p.file = path.string();
  p.facts.emplace_back(has_failed ? "tets" : "tets that move later", count(mesh.mesh.C.size()));
  p.facts.emplace_back("boundary faces", count(scene.head.n_faces));
  p.facts.emplace_back("least Q", fmt::format("{:.3g}", scene.head.quality.least));
  const auto& q = std::get<std::vector<double>>(mesh.cell_data.at("mean_ratio"));
  const auto n_bad = static_cast<std::size_t>(std::count_if(q.begin(), q.end(), [](double x) { return !(x > 0); }));
  if (n_bad > 0) p.facts.emplace_back("inverted tets", count(n_bad));
  p.facts.emplace_back("face centres off ψ = 0, at most", fmt::format("{:.3g}", scene.head.deviation.most));
  p.command = repeat(call);
  p.colour = std::string_view(id) == "chosen" ? "deviation" : "quality";
  put_scene(p, scene.head, std::move(scene.blocks));
}

void StripMaker::add_mesh() {
  if (!source_.certificate) return;
  const MeshMeasures& m = source_.certificate->measured;
  Picture& p = add("mesh", "mesh");
  p.file = source_.paths.mesh().string();
  if (mesh_record_) p.seconds = mesh_record_->run.seconds;
  p.facts.emplace_back("tets", count(m.mesh.n_tets));
  p.facts.emplace_back("least Q", fmt::format("{:.4g}", m.mesh.quality.min));
  if (const std::optional<double>& off = m.mesh.boundary.max_centroid_distance_over_h)
    p.facts.emplace_back("face centres off ψ = 0, at most", fmt::format("{:.3g} h", *off));
  if (m.cloud) p.facts.emplace_back("99 % of the samples within", fmt::format("{:.3g} h", m.cloud->p99 / m.mesh.h));
  if (!m.defects.empty()) p.facts.emplace_back("defects", count(m.defects.n()));
  p.command = repeat(fmt::format("mesh {{copy}} --h {:.4g}", .8 * m.mesh.h));
  p.colour = "quality";
}

/// Adds the stage that ended without a result, unless its remains have a picture.
void StripMaker::add_failed_stage() {
  if (!source_.failure || source_.certificate) return;
  const std::string id = stage_of_blame(source_.failure->stage == Stage::Cloud      ? "normals"
                                        : source_.failure->stage == Stage::LevelSet ? "level set"
                                                                                    : "mesh");
  if (std::any_of(pictures_.begin(), pictures_.end(), [&](const Picture& p) { return p.id == id; })) return;
  Picture& p = add(id.c_str(), id == "level-set" ? "level set" : id.c_str());
  p.facts.emplace_back("no result", source_.failure->message.substr(0, source_.failure->message.find('\n')));
  if (id == "level-set") p.command = repeat("reconstruct {copy} --normals estimate");
  if (id == "mesh") p.command = repeat("mesh {copy} --background graded");
  const bool has_samples = !samples_.layers.empty();
  if (has_samples) p.layers = {"samples"};
}

/// Normals come before all stages that use them; without doubts about them, the stage that stopped is to blame.
Json StripMaker::blame() const {
  if (source_.certificate) {
    const std::optional<Blame>& blame = source_.certificate->blame;
    if (!blame) return nullptr;
    return {{"stage", stage_of_blame(blame->stage)}, {"number", blame->number}, {"remedy", blame->remedy}};
  }
  if (!source_.failure) return nullptr;
  std::optional<InputFacts> facts;
  if (cloud_record_) {
    const CloudReport report = cloud_report(*cloud_record_);
    facts = input_facts(report, fit_record_ ? level_set_report(*fit_record_) : LevelSetReport());
  }
  const Blame blame = blame_for_failure(source_.failure->stage, source_.failure->message, facts);
  return {{"stage", stage_of_blame(blame.stage)}, {"number", blame.number}, {"remedy", blame.remedy}};
}

/// The mesh; without one the stage to blame, or the last one that is done.
std::string StripMaker::shown(const Json& blame) const {
  if (pictures_.empty()) return "";
  if (source_.certificate || !blame.is_object()) return pictures_.back().id;
  return blame.at("stage");
}

StageStrip StripMaker::operator()() {
  const bool is_alone = has_own_psi(source_.parameters.mesh());
  if (!is_alone) {
    cloud_record_ = record(Stage::Cloud);
    fit_record_ = record(Stage::LevelSet);
  }
  mesh_record_ = record(Stage::Mesh);
  if (!is_alone) take_samples();
  add_input();
  add_cloud();
  add_level_set();
  stop_if_interrupted();
  const std::string other_h = source_.certificate
                                  ? fmt::format("--h {:.4g}", .97 * source_.certificate->measured.mesh.h)
                                  : "--background graded";
  add_mesh_file("chosen", "chosen tets", "omega_h.vtu", "mesh {copy} " + other_h);
  add_mesh_file("projected", "projected", "projected.vtu", "mesh {copy} --set mesh.closest_point=paper");
  add_mesh();
  add_failed_stage();
  Json stages = Json::array(), layers = Json::array();
  for (const Picture& p : pictures_) {
    Json facts = Json::array();
    for (const auto& [what, value] : p.facts) facts.push_back({what, value});
    stages.push_back({{"id", p.id},
                      {"name", p.name},
                      {"facts", facts},
                      {"seconds", json_of(p.seconds)},
                      {"file", p.file},
                      {"command", p.command},
                      {"layers", p.layers},
                      {"colour", p.colour},
                      {"scene", p.scene}});
  }
  for (const SampleLayer& layer : samples_.layers) layers.push_back(to_json(layer));
  const Json cause = blame();
  StageStrip strip;
  strip.document = {{"stages", stages}, {"layers", layers}, {"blame", cause}, {"shown", shown(cause)}};
  strip.blocks = std::move(blocks_);
  for (auto& block : samples_.blocks) strip.blocks.push_back(std::move(block));
  return strip;
}

}  // namespace

StageStrip stage_strip(const StripSource& source) { return StripMaker(source)(); }

}  // namespace umtet
