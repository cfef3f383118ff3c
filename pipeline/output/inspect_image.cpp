#include "pipeline/output/inspect_image.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "body/body.h"
#include "body/sizing/background_choice.h"
#include "pipeline/case/option_words.h"
#include "pipeline/domain/body_options.h"
#include "pipeline/domain/load_domain.h"
#include "reconstruct/io/grid_io.h"
#include "reconstruct/level_set/image_level.h"

namespace umtet {
namespace {

// Maximum number of parts in the text; the document contains all.
constexpr std::size_t kListedParts = 40;

const char* name_of(GridKind kind) {
  switch (kind) {
    case GridKind::Segmentation:
      return "segmentation";
    case GridKind::LevelSet:
      return "level set";
    default:
      return "image";
  }
}

void predict(const Parameters& given, ImageInspection& found) {
  Parameters parameters = given;
  parameters.set(keys::mesh::level_set, found.file, ParamSource::Flag, "command line");
  Domain domain = grid_domain(parameters);
  BackgroundChoice background(body_options(parameters), domain);
  const EdgeLength choice = background.edge_length(domain);
  found.prediction = prediction_of(choice.h, background.expected_tets(domain, choice.h), 0, parameters);
  found.notices = texts_of(domain.notices, as_flag);
}

}  // namespace

ImageInspection inspect_image(const std::filesystem::path& file, const Parameters& parameters, Progress& progress) {
  progress.report("inspect", "read", 0);
  ImageInspection found;
  found.file = file.string();
  {
    const Grid grid = read_grid(file);
    found.kind = kind_of(grid);
    found.n = grid.n;
    found.steps = grid.steps();
    const auto [least, greatest] = std::minmax_element(grid.values.begin(), grid.values.end());
    found.least = *least, found.greatest = *greatest;
    progress.report("inspect", "survey", .3);
    if (found.kind == GridKind::Segmentation) {
      for (const LabelPart& part : label_parts(grid)) {
        found.parts.push_back(
            {part, part_shape(grid, part), static_cast<double>(part.n_voxels) * std::abs(grid.axes.determinant())});
      }
    }
    if (found.kind == GridKind::Image) {
      found.suggested_level = suggested_level(grid);
      found.wall_above = wall_share(grid, [&](double v) { return v > *found.suggested_level; });
    }
  }
  const MeshParameters& p = parameters.mesh();
  if (found.kind != GridKind::Image || !p.level.empty() || p.part > 0) predict(parameters, found);
  return found;
}

Json to_json(const ImageInspection& found) {
  Json json = {{"file", found.file},
               {"kind", name_of(found.kind)},
               {"n", {found.n[0], found.n[1], found.n[2]}},
               {"steps", json_of(found.steps)},
               {"values", {{"least", found.least}, {"greatest", found.greatest}}}};
  if (found.kind == GridKind::Segmentation) {
    Json parts = Json::array();
    for (const ImageInspection::Part& part : found.parts) {
      parts.push_back(
          {{"part", part.voxels.number},
           {"n_voxels", part.voxels.n_voxels},
           {"volume", part.volume},
           {"pieces", {{"by_points", part.shape.pieces_by_points}, {"by_faces", part.shape.pieces_by_faces}}},
           {"thickness", {{"p01", part.shape.thickness_p01}, {"median", part.shape.thickness_median}}},
           {"at_wall", part.voxels.at_wall}});
    }
    json["parts"] = std::move(parts);
  }
  if (found.suggested_level) json["suggested_level"] = *found.suggested_level;
  json["prediction"] = found.prediction ? to_json(*found.prediction) : Json(nullptr);
  json["notices"] = found.notices;
  return json;
}

std::string inspection_text(const ImageInspection& found) {
  std::string out =
      fmt::format("image     {}: {}, {} x {} x {} voxels of {:.4g} x {:.4g} x {:.4g}, values {:g} to {:g}\n",
                  found.file, name_of(found.kind), found.n[0], found.n[1], found.n[2], found.steps[0], found.steps[1],
                  found.steps[2], found.least, found.greatest);
  for (std::size_t i = 0; i < std::min(kListedParts, found.parts.size()); ++i) {
    const ImageInspection::Part& part = found.parts[i];
    const std::size_t n = part.shape.pieces_by_points, n_faces = part.shape.pieces_by_faces;
    out += fmt::format(
        "part {:<4} {} voxels, volume {:.6g}, {} piece{}{}, thickness 1 % {:.3g}, median {:.3g}{}\n",
        fmt::format("{:.10g}", part.voxels.number), part.voxels.n_voxels, part.volume, n, n == 1 ? "" : "s",
        n_faces == n ? "" : fmt::format(" ({} if voxels need a common face)", n_faces), part.shape.thickness_p01,
        part.shape.thickness_median, part.voxels.at_wall ? ", reaches the wall of the image" : "");
  }
  if (found.parts.size() > kListedParts)
    out += fmt::format("          and {} more parts (--json lists them)\n", found.parts.size() - kListedParts);
  if (found.suggested_level) {
    const double level = *found.suggested_level;
    out += fmt::format("level     such as --level {:g}: for values above {:g}, which {}; :{:g} for values below\n",
                       level, level,
                       found.wall_above > 0 ? fmt::format("reach {:.0f} % of the wall", 100 * found.wall_above)
                                            : "do not reach the wall of the image",
                       level);
  }
  for (const std::string& notice : found.notices) out += "notice    " + notice + "\n";
  out += found.prediction ? prediction_text(*found.prediction) : "a run     requires --level\n";
  return out;
}

}  // namespace umtet
