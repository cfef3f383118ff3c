#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include "body/label_volume.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/level_range.h"
#include "pipeline/case/memory.h"
#include "pipeline/domain/load_domain.h"
#include "reconstruct/io/grid_io.h"
#include "reconstruct/level_set/image_level.h"
#include "reconstruct/level_set/label_parts.h"

namespace umtet {
namespace {

// The value and its coefficient; for a segmentation also distances, bounds and iterates in single precision.
constexpr double kBytesPerNode = 70;
// Maximum number of parts in a message.
constexpr std::size_t kListed = 12;
// Layers of nodes around a body that reaches the wall, as room for the mesh.
constexpr int kLayersAtWall = 6;

std::string number_of(double v) { return fmt::format("{:.10g}", v); }

/// Returns a text such as "1 (179 voxels), 4 (20 voxels) and 3 more".
std::string parts_text(const std::vector<LabelPart>& parts) {
  std::string text;
  for (std::size_t i = 0; i < std::min(kListed, parts.size()); ++i) {
    text += fmt::format("{}{} ({} voxel{})", i > 0 ? ", " : "", number_of(parts[i].number), parts[i].n_voxels,
                        parts[i].n_voxels == 1 ? "" : "s");
  }
  if (parts.size() > kListed) text += fmt::format(" and {} more", parts.size() - kListed);
  return text;
}

/// Returns the requested part. \throw GridRefused  there is no such part
std::optional<std::int64_t> part_of(const Grid& grid, const MeshParameters& p, Domain& domain) {
  const std::vector<LabelPart> parts = label_parts(grid);
  if (parts.empty()) throw GridRefused(p.level_set + ": all voxels are 0, so there is no body");
  const auto wanted = static_cast<double>(p.part);
  std::size_t n_at_wall = 0;
  for (const LabelPart& part : parts) {
    if (p.part == 0 || part.number == wanted) n_at_wall += part.at_wall ? 1 : 0;
  }
  if (p.part > 0 && std::none_of(parts.begin(), parts.end(), [&](const auto& q) { return q.number == wanted; })) {
    throw GridRefused(fmt::format("{}: there is no part {}; the parts are {}", p.level_set, p.part, parts_text(parts)));
  }
  if (n_at_wall > 0)
    domain.notices.emplace_back(p.level_set + ": the body reaches the wall of the image and ends flat there");
  if (p.part == 0 && parts.size() > 1) {
    domain.notices.emplace_back(
        fmt::format("{}: the body consists of all parts: {} (umtet regions makes a region of each)", p.level_set,
                    parts_text(parts)),
        std::vector<Remedy>{{Change::Use, {Option{keys::mesh::part}, "N"}, "selects one"}});
  }
  return p.part > 0 ? std::optional(p.part) : std::nullopt;
}

/// Computes psi of a segmentation and adds a notice about the smoothing.
void take_parts(const Grid& grid, const MeshParameters& p, Domain& domain) {
  const std::optional<std::int64_t> part = part_of(grid, p, domain);
  const auto number = part ? std::optional(static_cast<double>(*part)) : std::nullopt;
  const auto kernel = p.part_smooth >= 0 ? std::optional(p.part_smooth) : std::nullopt;
  MaskFit fit = kernel ? fit_mask_by_kernel(grid, number, *kernel) : fit_mask(grid, number);
  const MaskReport& r = fit.report;
  const std::string head = fmt::format("{}: a segmentation of {} voxels{}, ", p.level_set, r.n_inside,
                                       part ? fmt::format(" of part {}", *part) : "");
  const Message notice = kernel ? Message{head + fmt::format("smoothed over {:.2g} voxels (", *kernel),
                                          Option{keys::mesh::part_smooth}, ")"}
                                : Message(head + "smoothed between its voxels");
  domain.notices.push_back(
      notice +
      fmt::format(": the volume is {:.5g}, {:+.2f} % relative to the voxels, and {} voxels have changed sides, "
                  "by at most {:.2g} voxels",
                  r.volume, 100 * (r.volume / r.volume_of_voxels - 1), r.n_changed,
                  r.farthest_changed / fit.voxels.steps().minCoeff()));
  domain.labels = std::make_shared<const LabelVolume>(label_volume(fit, part, kernel));
  domain.grid = std::make_shared<const GridLevelSet>(std::move(fit.psi));
}

/// Returns the side of a level that is the body: the side that does not reach the wall of the image, or reaches less of
/// it; the values below if neither reaches it.
LevelRange::Side side_of(const Grid& grid, double level, const MeshParameters& p, Domain& domain) {
  const double below = wall_share(grid, [&](double v) { return v < level; });
  const double above = wall_share(grid, [&](double v) { return v > level; });
  if (below == 0 || below < above) return LevelRange::Side::Below;
  domain.notices.emplace_back(
      fmt::format("{}: values below {:g} reach {} of the image, so the body consists of the values above", p.level_set,
                  level, above > 0 ? fmt::format("{:.0f} % of the wall", 100 * below) : "the wall"),
      std::vector<Remedy>{
          {Change::Use, {Option{keys::mesh::level}, fmt::format(":{:g}", level)}, "selects the values below"}});
  return LevelRange::Side::Above;
}

/// Returns the diagonal of the box around the inside nodes, extended by half a step on all sides.
double diagonal_of_body(const Grid& grid) {
  Eigen::AlignedBox3d box;
  std::size_t at = 0;
  for (int k = 0; k < grid.n[2]; ++k) {
    for (int j = 0; j < grid.n[1]; ++j) {
      for (int i = 0; i < grid.n[0]; ++i)
        if (grid.values[at++] < 0) box.extend(Vec3(grid.axes * Vec3(i, j, k)));
    }
  }
  return box.diagonal().norm() + grid.steps().norm();
}

/// Computes psi of an image and a level.
void take_level(Grid grid, LevelRange level, const MeshParameters& p, Domain& domain) {
  using Side = LevelRange::Side;
  if (p.above && level.side != Side::Either && level.side != Side::Above)
    throw UsageError({Option{keys::mesh::above}, " and ", Setting(Option{keys::mesh::level}, p.level),
                      ": only one of them may specify the side of the body"});
  if (p.above) level.side = Side::Above;
  if (level.side == Side::Either) level.side = side_of(grid, level.low, p, domain);
  const auto [least, greatest] = std::minmax_element(grid.values.begin(), grid.values.end());
  const double low = *least, high = *greatest;
  const auto none = [&](const char* where) {
    throw GridRefused(fmt::format(
        "{}: no value is {} {}: the values are from {:g} to {:g}", p.level_set, where,
        level.side == Side::Above ? fmt::format("{:g}", level.low) : fmt::format("{:g}", level.high), low, high));
  };
  if (level.side == Side::Above && !(high > level.low)) none("above");
  if (level.side == Side::Below && !(low < level.high)) none("below");
  if (level.side == Side::Above) take_above(grid, level.low);
  if (level.side == Side::Below) take_below(grid, level.high);
  if (level.side == Side::Between) take_between(grid, level.low, level.high);
  if (std::none_of(grid.values.begin(), grid.values.end(), [](double v) { return v < 0; }))
    throw GridRefused(fmt::format("{}: no value is between {:g} and {:g}", p.level_set, level.low, level.high));
  if (close_at_wall(grid, kLayersAtWall)) {
    const bool is_below = level.side == Side::Below;
    const std::string body = is_below ? fmt::format("the body, the values below {:g},", level.high) : "the body";
    Message& notice =
        domain.notices.emplace_back(p.level_set + ": " + body + " reaches the wall of the image and ends flat there");
    if (is_below) notice.remedies = {{Change::Give, Option{keys::mesh::above}, "for the values above"}};
  }
  domain.diagonal = diagonal_of_body(grid);
  domain.grid = std::make_shared<const GridLevelSet>(interpolate(std::move(grid)));
}

[[noreturn]] void ask_for_level(const Grid& grid, const MeshParameters& p) {
  const auto [least, greatest] = std::minmax_element(grid.values.begin(), grid.values.end());
  const double level = suggested_level(grid);
  throw GridRefused(
      {fmt::format("{}: an image with grey values from {:g} to {:g}: select the values inside the body with ",
                   p.level_set, *least, *greatest),
       Option{keys::mesh::level}, ", such as ", Setting(Option{keys::mesh::level}, fmt::format("{:g}:", level)),
       fmt::format(" for values above {:g} (:{:g} for values below)", level, level)});
}

}  // namespace

Domain grid_domain(const Parameters& parameters) {
  const MeshParameters& p = parameters.mesh();
  if (!p.implicit.empty()) {
    throw UsageError(
        {Option{keys::mesh::implicit}, " and ", Option{keys::mesh::level_set}, ": they are mutually exclusive"});
  }
  const std::optional<LevelRange> level = parse_level(p.level);
  if (p.above && !level) throw UsageError({Option{keys::mesh::above}, " needs ", Option{keys::mesh::level}});
  if (p.part > 0 && level) {
    throw UsageError({Option{keys::mesh::part}, " and ", Option{keys::mesh::level}, ": they are mutually exclusive"});
  }
  Domain domain;
  domain.complement = p.complement;
  const double allowed = allowed_bytes(parameters);
  Grid grid = read_grid(p.level_set, allowed > 0 ? std::min(1e9, allowed / kBytesPerNode) : 1e9);
  try {
    const GridKind kind = level ? GridKind::Image : kind_of(grid);
    if (p.part > 0 && !has_whole_values(grid))
      throw UsageError({Option{keys::mesh::part}, ": " + p.level_set + " contains no part numbers"});
    if (level) {
      take_level(std::move(grid), *level, p, domain);
    } else if (kind == GridKind::Segmentation || p.part > 0) {
      take_parts(grid, p, domain);
    } else if (kind == GridKind::LevelSet) {
      domain.grid = std::make_shared<const GridLevelSet>(interpolate(std::move(grid)));
    } else {
      ask_for_level(grid, p);
    }
  } catch (const std::invalid_argument& e) {
    throw GridRefused(p.level_set + ": " + e.what());
  }
  domain.box = parse_box(p.box).value_or(domain.grid->box());
  if (domain.labels) domain.diagonal = domain.labels->diagonal;
  if (!(domain.diagonal > 0)) domain.diagonal = domain.box.diagonal().norm();
  return domain;
}

}  // namespace umtet
