#include "pipeline/output/report_scene.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "body/pieces/zero_set_choice.h"
#include "common/indices_where.h"
#include "common/polled_loops.h"
#include "mesh/patches/patches.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/meshing/made_mesh.h"
#include "pipeline/meshing/sample_fields.h"
#include "pipeline/output/detail/scene_blocks.h"
#include "pipeline/output/detail/worst_tets.h"
#include "pipeline/output/report_page.h"

namespace umtet {
namespace {

using detail::FacedTet;
using detail::in_known_steps;
using detail::in_steps;

constexpr std::uint8_t kNoValue = 255;
constexpr std::size_t kValuesPerPoll = 100'000;
// Cells of 12 tets have about two tets along an edge: their squares look as fine as the tets. A million take 1.3 MB.
constexpr double kTetsPerCell = 12, kMostCells = 1e6;

template <class Value = double>
const std::vector<Value>* field(const std::map<std::string, FieldValues>& data, const char* name) {
  const auto it = data.find(name);
  return it == data.end() ? nullptr : std::get_if<std::vector<Value>>(&it->second);
}

double longest_edge(const TetMesh& mesh) {
  const double longest2 = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.C.size()), 0.,
      [&](const tbb::blocked_range<std::size_t>& tets, double l2) {
        for (std::size_t k = tets.begin(); k != tets.end(); ++k) {
          const Tet& t = mesh.C[k];
          for (int i = 0; i < 3; ++i) {
            for (int j = i + 1; j < 4; ++j) l2 = std::max(l2, (mesh.V[t[i]] - mesh.V[t[j]]).squaredNorm());
          }
        }
        return l2;
      },
      [](double a, double b) { return std::max(a, b); });
  return std::sqrt(longest2);
}

class SceneMaker {
 public:
  SceneMaker(const MeshFile& file, const Domain& domain, const ReportCaps& caps)
      : file_(file), mesh_(file.mesh), domain_(domain), caps_(caps) {
    for (const Vec3& x : mesh_.V) box_.extend(x);
    for (const Vec3& x : domain.cloud.points) box_.extend(x + domain.shift);
  }
  ReportScene operator()(const SolverMesh& divided);

 private:
  void take_faces(const SolverMesh& divided);
  void take_patches(const SolverMesh& divided);
  void coarsen_faces();
  void take_tets();
  void take_points();
  void write_curves(const SolverMesh& divided);
  void write_indices(const char* name, const std::vector<FacedTet>& list);
  void write_positions(const char* name, const std::vector<Vec3>& points);
  void write_bytes(const char* name, const std::vector<std::uint8_t>& bytes) {
    scene_.blocks.emplace_back(name, detail::byte_block(bytes));
  }
  void write_ids();
  void write_cells();
  void write_values();
  void write_fields();
  void write_field(const std::string& name, const std::vector<double>& values);
  void write_field(const std::string& name, const std::vector<Vec3>& colours);
  void add_field(SceneHead::Field field, const std::vector<std::uint8_t>& bytes) {
    write_bytes(("vertex_field_" + std::to_string(scene_.head.fields.size())).c_str(), bytes);
    scene_.head.fields.push_back(std::move(field));
  }
  /// Numbers the vertices that are shown, in the order of first use.
  int shown(int vertex) {
    int& id = shown_id_[vertex];
    if (id < 0) {
      id = static_cast<int>(shown_.size());
      shown_.push_back(vertex);
    }
    return id;
  }

  const MeshFile& file_;
  const TetMesh& mesh_;
  const Domain& domain_;
  const ReportCaps& caps_;
  Box box_;
  std::vector<FacedTet> faces_;
  std::vector<int> face_tet_, face_patch_;
  std::vector<int> tets_;
  std::vector<int> shown_id_, shown_;
  ReportScene scene_;
};

void SceneMaker::take_faces(const SolverMesh& divided) {
  face_tet_ = divided.face_tet;
  for (std::size_t f = 0; f < face_tet_.size(); ++f) {
    const Tet& tet = mesh_.C[face_tet_[f]];
    const int behind = divided.face_opposite[f];
    const auto& [a, b, c] = kTetFace[behind];
    faces_.push_back({tet[a], tet[b], tet[c], tet[behind]});
  }
  take_patches(divided);
  scene_.head.n_faces = faces_.size();
  if (faces_.size() > caps_.faces) coarsen_faces();
  scene_.head.n_faces_shown = faces_.size();
}

void SceneMaker::take_patches(const SolverMesh& divided) {
  std::vector<double> area(divided.patches.size(), 0);
  std::vector<std::size_t> n(divided.patches.size(), 0);
  const FaceGeometry geometry = face_geometry(divided.nodes, divided.triangles());
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    area[divided.face_patch[f]] += geometry.area[f];
    ++n[divided.face_patch[f]];
  }
  for (std::size_t p = 0; p < area.size(); ++p) {
    const MeshPart& part = divided.patches[p];
    scene_.head.patches.push_back({part.name, part.number, n[p], area[p]});
  }
  if (area.size() > 1) face_patch_ = divided.face_patch;
}

void SceneMaker::coarsen_faces() {
  const std::vector<std::size_t> kept = detail::coarsen_faces(mesh_.V, box_.min(), caps_.faces, faces_);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    face_tet_[k] = face_tet_[kept[k]];
    if (!face_patch_.empty()) face_patch_[k] = face_patch_[kept[k]];
  }
  face_tet_.resize(kept.size());
  if (!face_patch_.empty()) face_patch_.resize(kept.size());
}

/// Selects all tets, or the worst tets and the tets at the middle planes. A tet is drawn at a cut if a neighbour is on
/// the other side; centroids of neighbours are at most half the longest edge apart.
void SceneMaker::take_tets() {
  const std::vector<double>& q = *field(file_.cell_data, "mean_ratio");
  const std::size_t n = mesh_.C.size(), n_worst = std::min(caps_.worst, n);
  const double layer = longest_edge(mesh_) / 2;
  std::vector<int> planes;
  if (n <= caps_.tets) {
    tets_ = detail::worst_first(q, n_worst);
  } else {
    tets_ = detail::worst_of(q, n_worst);
    std::vector<char> taken(n, 0);
    for (const int t : tets_) taken[t] = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const double middle = box_.center()[axis];
      const std::vector<int> more = indices_where<int>(n, [&](std::size_t t) {
        double sum = 0;
        for (const int v : mesh_.C[t]) sum += mesh_.V[v][axis];
        return !taken[t] && std::abs(sum / 4 - middle) <= layer;
      });
      if (tets_.size() + more.size() > caps_.tets) continue;
      for (const int t : more) taken[t] = 1;
      tets_.insert(tets_.end(), more.begin(), more.end());
      planes.push_back(axis);
    }
  }
  scene_.head.n_tets = mesh_.C.size();
  scene_.head.n_tets_shown = tets_.size();
  scene_.head.n_worst = n_worst;
  scene_.head.layer = layer;
  if (tets_.size() != mesh_.C.size()) scene_.head.planes = std::move(planes);
}

void SceneMaker::take_points() {
  const std::vector<Vec3>& all = domain_.cloud.points;
  if (caps_.points == 0) return;
  const std::size_t step = all.size() / caps_.points + 1;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < all.size(); i += step) points.push_back(all[i] + domain_.shift);
  scene_.head.n_points = all.size();
  scene_.head.n_points_shown = points.size();
  write_positions("points", points);
}

/// The ids of tets that the viewer cannot derive: if all tets are shown, those after the worst ones ascend.
void SceneMaker::write_ids() {
  const std::size_t n = scene_.head.planes ? tets_.size() : scene_.head.n_worst;
  scene_.blocks.emplace_back("tet_ids", base64(tets_.data(), sizeof(int) * n));
  scene_.blocks.emplace_back("face_ids", base64(face_tet_.data(), sizeof(int) * face_tet_.size()));
}

/// A grid of cells with the least Q of the tets in each, in place of tets that are too many for the page. A tet is in
/// the cells of its centroid and of the points halfway from there to its corners.
void SceneMaker::write_cells() {
  if (!scene_.head.planes) return;
  const std::vector<double>& q = *field(file_.cell_data, "mean_ratio");
  const Vec3 size = box_.sizes();
  double volume = 0;
  for (const Tet& t : mesh_.C)
    volume +=
        std::abs(
            (mesh_.V[t[1]] - mesh_.V[t[0]]).cross(mesh_.V[t[2]] - mesh_.V[t[0]]).dot(mesh_.V[t[3]] - mesh_.V[t[0]])) /
        6;
  const double edge = std::max(std::cbrt(kTetsPerCell * volume / static_cast<double>(mesh_.C.size())),
                               std::cbrt(size.prod() / kMostCells));
  std::array<int, 3>& n = scene_.head.cells.emplace();
  for (int k = 0; k < 3; ++k) n[k] = std::max(1, static_cast<int>(std::ceil(size[k] / edge)));
  std::vector<std::uint8_t> least(static_cast<std::size_t>(n[0]) * n[1] * n[2], 0);
  const auto put = [&](const Vec3& x, std::uint8_t value) {
    std::size_t at = 0;
    for (int k = 2; k >= 0; --k) {
      const int i = static_cast<int>((x[k] - box_.min()[k]) / std::max(size[k], 1e-300) * n[k]);
      at = at * n[k] + std::clamp(i, 0, n[k] - 1);
    }
    if (least[at] == 0 || value < least[at]) least[at] = value;
  };
  const auto [q0, q1] = scene_.head.quality;
  for (std::size_t t = 0; t < mesh_.C.size(); ++t) {
    const auto value = static_cast<std::uint8_t>(1 + in_known_steps(q[t], q0, q1));
    Vec3 centre = Vec3::Zero();
    for (const int v : mesh_.C[t]) centre += mesh_.V[v] / 4;
    put(centre, value);
    for (const int v : mesh_.C[t]) put((centre + mesh_.V[v]) / 2, value);
  }
  write_bytes("cells", least);
}

void SceneMaker::write_curves(const SolverMesh& divided) {
  std::vector<Vec3> ends;
  for (const MeshCurve& curve : divided.curves) {
    for (const auto& [a, b] : curve.edges) ends.insert(ends.end(), {mesh_.V[a], mesh_.V[b]});
  }
  if (!ends.empty()) write_positions("curves", ends);
}

void SceneMaker::write_positions(const char* name, const std::vector<Vec3>& points) {
  scene_.blocks.emplace_back(name, detail::position_block(points, box_.min(), box_.sizes()));
}

void SceneMaker::write_indices(const char* name, const std::vector<FacedTet>& list) {
  scene_.blocks.emplace_back(name, detail::index_block(list, scene_.head.index_bytes));
}

void SceneMaker::write_values() {
  const std::vector<double>& q = *field(file_.cell_data, "mean_ratio");
  const auto [least_q, most_q] = std::minmax_element(q.begin(), q.end());
  const double q0 = *least_q, q1 = *most_q;
  scene_.head.quality = {q0, q1};
  std::vector<std::uint8_t> bytes;
  for (const int t : tets_) bytes.push_back(in_steps(q[t], q0, q1));
  write_bytes("tet_quality", bytes);
  bytes.clear();
  for (const int t : face_tet_) bytes.push_back(in_steps(q[t], q0, q1));
  write_bytes("face_quality", bytes);

  std::vector<double> deviation(faces_.size());
  const ImplicitFunctionRef psi = domain_.psi();
  const std::vector<std::uint8_t>* wall = field<std::uint8_t>(file_.point_data, kAtWall);
  polled_parallel_for(faces_.size(), kValuesPerPoll, until_interrupted(), [&](std::size_t f) {
    const FacedTet& t = faces_[f];
    if (wall && (*wall)[t[0]] && (*wall)[t[1]] && (*wall)[t[2]]) return;
    Vec3 g;
    const double value = psi.value((mesh_.V[t[0]] + mesh_.V[t[1]] + mesh_.V[t[2]]) / 3 - domain_.shift, g);
    deviation[f] = std::abs(value) / g.norm();
  });
  const double most = deviation.empty() ? 0 : *std::max_element(deviation.begin(), deviation.end());
  scene_.head.deviation = {0, most};
  bytes.clear();
  for (const double d : deviation) bytes.push_back(in_steps(d, 0, most));
  write_bytes("face_deviation", bytes);

  if (!face_patch_.empty()) {
    bytes.clear();
    for (const int p : face_patch_) bytes.push_back(static_cast<std::uint8_t>(p % 256));
    write_bytes("face_patch", bytes);
  }
  if (const std::vector<double>* length = field(file_.point_data, "edge_length")) {
    const auto [least, most] = std::minmax_element(length->begin(), length->end());
    scene_.head.edge_length = {*least, *most};
    bytes.clear();
    for (const int v : shown_) bytes.push_back(in_steps((*length)[v], *least, *most));
    write_bytes("vertex_edge_length", bytes);
  }
  if (const std::vector<double>* support = field(file_.point_data, "support")) {
    double far = 0;
    for (const double d : *support) far = std::max(far, d);
    scene_.head.support = {0, far};
    scene_.head.support_radius = support_radius(domain_);
    bytes.clear();
    for (const int v : shown_) bytes.push_back(in_steps((*support)[v], 0, far));
    write_bytes("vertex_support", bytes);
  }
  write_fields();
}

void SceneMaker::write_fields() {
  for (const auto& [name, any] : file_.point_data) {
    if (!is_of_scan(name)) continue;
    if (const auto* values = std::get_if<std::vector<double>>(&any)) write_field(name, *values);
    if (const auto* colours = std::get_if<std::vector<Vec3>>(&any)) write_field(name, *colours);
  }
}

void SceneMaker::write_field(const std::string& name, const std::vector<double>& values) {
  SceneHead::Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const int v : shown_) {
    if (std::isnan(values[v])) continue;
    range = {std::min(range.least, values[v]), std::max(range.most, values[v])};
  }
  if (range.least > range.most) return;  // no sample is near
  std::vector<std::uint8_t> bytes;
  for (const int v : shown_) bytes.push_back(in_known_steps(values[v], range.least, range.most));
  add_field({name, range}, bytes);
}

void SceneMaker::write_field(const std::string& name, const std::vector<Vec3>& colours) {
  std::vector<std::uint8_t> bytes;
  for (const int v : shown_) {
    for (const double c : colours[v]) bytes.push_back(in_known_steps(c, 0, 1));
  }
  add_field({name, {0, 1}, true}, bytes);
}

ReportScene SceneMaker::operator()(const SolverMesh& divided) {
  if (mesh_.C.empty() || !field(file_.cell_data, "mean_ratio")) {
    throw std::invalid_argument("a scene needs tets with mean_ratio");
  }
  if (divided.n_tets() != mesh_.C.size()) throw std::invalid_argument("a scene needs the patches of its own mesh");
  scene_.head.box_min = box_.min();
  scene_.head.box_size = box_.sizes();
  take_faces(divided);
  take_tets();
  shown_id_.assign(mesh_.V.size(), -1);
  std::vector<FacedTet> faces = faces_, tets;
  for (const int t : tets_) tets.push_back(mesh_.C[t]);
  for (auto* list : {&faces, &tets}) {
    for (FacedTet& t : *list) {
      for (int& v : t) v = shown(v);
    }
  }
  scene_.head.index_bytes = detail::index_bytes_for(shown_.size());
  write_indices("faces", faces);
  write_indices("tets", tets);
  std::vector<Vec3> positions;
  for (const int v : shown_) positions.push_back(mesh_.V[v]);
  write_positions("positions", positions);
  write_values();
  write_ids();
  write_cells();
  write_curves(divided);
  take_points();
  return std::move(scene_);
}

Json to_json(const SceneHead::Range& range) { return {range.least, range.most}; }

}  // namespace

Json to_json(const SceneHead& head) {
  Json patches = Json::array();
  for (const SceneHead::Patch& p : head.patches) {
    patches.push_back({{"name", p.name}, {"number", p.number}, {"n_faces", p.n_faces}, {"area", p.area}});
  }
  Json ranges = {{"quality", to_json(head.quality)}, {"deviation", to_json(head.deviation)}};
  if (head.edge_length) ranges["edge_length"] = to_json(*head.edge_length);
  if (head.support) ranges["support"] = to_json(*head.support);
  Json fields = Json::array();
  for (const SceneHead::Field& f : head.fields) {
    fields.push_back({{"name", f.name}, {"range", to_json(f.range)}, {"of_colours", f.of_colours}});
  }
  return {{"box_min", json_of(head.box_min)},
          {"box_size", json_of(head.box_size)},
          {"patches", patches},
          {"n_faces", head.n_faces},
          {"n_faces_shown", head.n_faces_shown},
          {"n_tets", head.n_tets},
          {"n_tets_shown", head.n_tets_shown},
          {"n_worst", head.n_worst},
          {"layer", head.layer},
          {"planes", json_of(head.planes)},
          {"cells", json_of(head.cells)},
          {"index_bytes", head.index_bytes},
          {"ranges", ranges},
          {"support_radius", head.support_radius},
          {"fields", fields},
          {"n_points", head.n_points},
          {"n_points_shown", head.n_points_shown}};
}

ReportScene report_scene(const MeshFile& mesh, const Domain& domain, const SolverMesh& divided,
                         const ReportCaps& caps) {
  return SceneMaker(mesh, domain, caps)(divided);
}

}  // namespace umtet
