#include "body/regions/label_regions.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "body/errors.h"
#include "common/formatted.h"
#include "reconstruct/level_set/label_fit.h"
#include "reconstruct/level_set/label_parts.h"
#include "reconstruct/level_set/voxel_pieces.h"

namespace umtet {
namespace {

// Where neither h nor a number of tets is given: what a minute makes, and what every body is worth.
constexpr double kMostTets = 1e6, kFewestTets = 1e5;
// Edges in the thinnest place of a label: between two interfaces, as much as a valid mesh needs.
constexpr double kEdgesAcross = 3;

std::vector<std::string> names_of(const std::vector<LabelPart>& parts, const std::map<int, std::string>& names) {
  if (parts.empty()) throw UsageError("all voxels are 0, so there is no body");
  if (parts.size() >= kMostRegions)
    throw UsageError(formatted("%zu labels: a mesh has at most %d regions", parts.size(), kMostRegions - 1));
  for (const auto& named : names)
    if (std::none_of(parts.begin(), parts.end(), [&](const LabelPart& p) { return p.number == named.first; }))
      throw UsageError(formatted("%s: no voxel has the label %d", named.second.c_str(), named.first));
  std::vector<std::string> list = {"outside"};
  for (const LabelPart& part : parts) {
    const auto named = names.find(static_cast<int>(part.number));
    list.push_back(named != names.end() ? named->second : formatted("label%.10g", part.number));
  }
  return list;
}

/// The box of the voxels of all labels.
Box box_of(const Grid& grid, const std::vector<LabelPart>& parts) {
  Box box;
  for (const LabelPart& part : parts)
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 at;
      for (int a = 0; a < 3; ++a) at[a] = (corner >> a & 1) != 0 ? part.last[a] + .5 : part.first[a] - .5;
      box.extend(grid.origin + grid.axes * at);
    }
  return box;
}

/// Measures the voxels of each label.
std::vector<RegionVoxels> voxels_of(const Grid& grid, const std::vector<LabelPart>& parts,
                                    const std::vector<std::shared_ptr<const LabelLevelSet>>& functions) {
  std::vector<RegionVoxels> list;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const BodyVoxels& voxels = functions[k + 1]->voxels();
    RegionVoxels r;
    r.region = static_cast<int>(k) + 1;
    r.label = parts[k].number;
    r.n_voxels = parts[k].n_voxels;
    r.volume_of_voxels = static_cast<double>(r.n_voxels) * voxels.voxel_volume();
    const PartShape shape = part_shape(grid, parts[k]);
    r.pieces = {shape.pieces_by_points, shape.pieces_by_faces};
    r.thickness = shape.thickness_p01;
    list.push_back(r);
  }
  return list;
}

double edge_length_of_labels(const std::vector<RegionVoxels>& voxels, double volume) {
  double thinnest = voxels.front().thickness;
  for (const RegionVoxels& r : voxels) thinnest = std::min(thinnest, r.thickness);
  return std::clamp(thinnest / kEdgesAcross, edge_length_of(volume, kMostTets), edge_length_of(volume, kFewestTets));
}

void compare(RegionBodyMesh& made) {
  for (RegionVoxels& r : made.voxels) {
    const auto& of = made.certificate.regions;
    const auto found =
        std::find_if(of.begin(), of.end(), [&](const RegionMeasures& m) { return m.region == r.region; });
    if (found == of.end()) continue;  // failures() names it
    r.volume = found->certificate.volume;
    const std::string& name = made.names[static_cast<std::size_t>(r.region)];
    const double off = r.volume / r.volume_of_voxels - 1;
    if (std::abs(off) > kLabelVolume)
      made.reasons.push_back(
          formatted("%s: the volume is %.6g, and its voxels have %.6g (%+.2g %%); an edge length of "
                    "%.2g leaves %.0f %%",
                    name.c_str(), r.volume, r.volume_of_voxels, 100 * off,
                    made.h * std::sqrt(kLabelVolume / std::abs(off)), 100 * kLabelVolume));
    if (!r.pieces.allows(static_cast<std::size_t>(found->n_pieces)))
      made.reasons.push_back(
          formatted("%s: the mesh has %d pieces, and the voxels have %zu; the thinnest places are "
                    "%.2g h thick",
                    name.c_str(), found->n_pieces, r.pieces.by_points, r.thickness / made.h));
  }
}

}  // namespace

RegionBodyMesh mesh_label_regions(const Grid& grid, const std::map<int, std::string>& names,
                                  const RegionBodyOptions& options) {
  const std::vector<LabelPart> parts = label_parts(grid);
  std::vector<std::string> all_names = names_of(parts, names);
  options.context.report("fit", 0);
  std::vector<double> labels;
  labels.reserve(parts.size());
  for (const LabelPart& part : parts) labels.push_back(part.number);
  std::vector<std::shared_ptr<const LabelLevelSet>> functions;
  std::vector<PatchFunction> psi;
  for (LabelLevelSet& f : fit_labels(grid, labels)) {
    functions.push_back(std::make_shared<const LabelLevelSet>(std::move(f)));
    psi.emplace_back([f = functions.back()](const Vec3& x, Vec3* gradient, Mat3* hessian) {
      return f->evaluate(x, gradient, hessian);
    });
  }
  std::vector<RegionVoxels> voxels = voxels_of(grid, parts, functions);
  const Box box = box_of(grid, parts);
  RegionBodyOptions sized = options;
  if (sized.h <= 0 && sized.tets <= 0) {
    double volume = options.box ? options.box->volume() : box.volume();
    if (!options.has_outside) {
      volume = 0;
      for (const RegionVoxels& r : voxels) volume += r.volume_of_voxels;
    }
    sized.h = edge_length_of_labels(voxels, volume);
  }
  RegionBodyMesh made = mesh_region_domain(RegionDomain::of_least(std::move(psi)), std::move(all_names), box, sized);
  made.voxels = std::move(voxels);
  compare(made);
  return made;
}

}  // namespace umtet
