#include "pipeline/output/boundary_patches.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "body/fidelity/closed_holes.h"
#include "body/fidelity/patch_measures.h"
#include "body/patches/boundary_division.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/meshing/made_mesh.h"

namespace umtet {
namespace {

constexpr Option kLabelNames{keys::output::label_names};

bool has_walls(const std::vector<char>& at_wall) {
  return std::find(at_wall.begin(), at_wall.end(), 1) != at_wall.end();
}

/// Returns the names of labels: those of output.label_names, then those of the file.
/// \throw UsageError  a name for a label that no point has, or that is reserved for walls
std::map<int, std::string> names_of_labels(const OrientedPointCloud& cloud, bool walled, const Parameters& parameters,
                                           const std::vector<std::string>& names_of_file) {
  std::map<int, std::string> names = parse_label_names(parameters.output().label_names);
  if (cloud.labels.empty() && !names.empty()) {
    throw UsageError(
        {kLabelNames, ": the points have no labels (PLY property label, PCD field label, or a last column)"});
  }
  const std::vector<int> in_cloud = distinct_labels(cloud);
  for (const auto& [label, name] : names) {
    if (walled && lower_case(name) == kWalls) {
      throw UsageError({Setting(kLabelNames, fmt::format("{}={}", label, name)),
                        ": this name is reserved for the faces at the walls of the box"});
    }
    if (std::binary_search(in_cloud.begin(), in_cloud.end(), label)) continue;
    throw UsageError({Setting(kLabelNames, fmt::format("{}={}", label, name)),
                      fmt::format(": no point has this label; the labels are {}", fmt::join(in_cloud, ", "))});
  }
  add_names_of_file(names_of_file, names);
  return names;
}

/// Sets the patches and curves of a division, and passes its notices on.
void take_division(SolverMesh& mesh, BoundaryDivision division, const Warn& warn) {
  for (const std::string& notice : division.notices) warn(notice);
  set_patches(mesh, std::move(division.face_patch), std::move(division.patches));
  if (!division.curves.empty()) set_curves(mesh, std::move(division.curves));
}

std::vector<char> faces_at_walls(const SolverMesh& mesh, const MeshFile& file) {
  const auto found = file.point_data.find(kAtWall);
  if (found == file.point_data.end()) return {};
  const auto* wall = std::get_if<std::vector<std::uint8_t>>(&found->second);
  std::vector<char> at_wall(mesh.n_faces());
  for (std::size_t f = 0; wall && f < at_wall.size(); ++f) {
    const std::array<int, 6> face = mesh.face(f);
    at_wall[f] = std::all_of(face.begin(), face.begin() + 3, [&](int v) { return (*wall)[v]; });
  }
  return at_wall;
}

std::vector<char> faces_in_holes(const SolverMesh& mesh, const MeshFile& file,
                                 const std::optional<SupportReport>& support) {
  const auto found = file.point_data.find("support");
  if (!support || support->n_closed_holes == 0 || found == file.point_data.end()) return {};
  const auto* distance = std::get_if<std::vector<double>>(&found->second);
  if (!distance) return {};
  const std::vector<Triangle> faces = mesh.triangles();
  const ClosedHoles holes = find_closed_holes(file.mesh.V, faces, *distance, support->radius, until_interrupted());
  std::vector<char> in_holes(faces.size());
  std::transform(holes.of_face.begin(), holes.of_face.end(), in_holes.begin(), [](int hole) { return hole >= 0; });
  return in_holes;
}

}  // namespace

void take_holes(SolverMesh& mesh, const std::vector<char>& in_holes, const Warn& warn) {
  BoundaryDivision division{mesh.face_patch, mesh.patches, {}};
  take_holes(in_holes, division);
  take_division(mesh, std::move(division), warn);
}

void mark_patches(const Domain& domain, const SolverMesh& mesh, const std::vector<Vec3>& V, double h,
                  MarkedFaces& marked) {
  if (!domain.piecewise) return;
  marked.of_body = patches_by_position(domain, V, mesh.triangles(), h, until_interrupted());
  marked.labels = domain.piecewise->labels;
}

MarkedFaces marked_faces(const SolverMesh& mesh, const MeshFile& file, const std::optional<SupportReport>& support) {
  return {faces_at_walls(mesh, file), faces_in_holes(mesh, file, support)};
}

void divide_boundary(SolverMesh& mesh, const MarkedFaces& marked, const OrientedPointCloud& cloud,
                     const Parameters& parameters, const Warn& warn, const std::vector<std::string>& names_of_file) {
  if (!marked.in_holes.empty()) {
    for (const auto& [label, name] : parse_label_names(parameters.output().label_names)) {
      if (lower_case(name) != kClosedHoles) continue;
      throw UsageError({Setting(kLabelNames, fmt::format("{}={}", label, name)),
                        ": this name is reserved for faces that no sample supports"});
    }
  }
  BoundaryDivision division =
      divide_boundary(mesh.nodes, mesh.triangles(), marked.at_wall, cloud,
                      {.angle = parameters.output().patch_angle,
                       .planar = parameters.output().patch_planar,
                       .label_min_area = parameters.output().label_min_area,
                       .names = names_of_labels(cloud, has_walls(marked.at_wall), parameters, names_of_file)},
                      marked.of_body, marked.labels);
  take_holes(marked.in_holes, division);
  take_division(mesh, std::move(division), warn);
}

}  // namespace umtet
