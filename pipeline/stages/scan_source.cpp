#include "pipeline/stages/scan_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "reconstruct/cloud/cloud_survey.h"
#include "reconstruct/triangles/body_samples.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

// Of samples at which the side is a guess: what is worth a line.
constexpr double kUnsure = .01;

/// What was mended, and how sure it is.
std::vector<std::string> notices_of(const TrianglesReport& t, const TriangleFileReport& file) {
  std::vector<std::string> list;
  const auto say = [&]<class... T>(fmt::format_string<T...> format, T&&... args) {
    list.push_back(fmt::format(format, std::forward<T>(args)...));
  };
  const TriangleReport& b = t.body;
  const FaceSidesReport& s = b.sides;
  const auto percent = [&](std::size_t n, std::size_t of) {
    return 100. * static_cast<double>(n) / static_cast<double>(of);
  };
  say("{} triangles in {} patch{}, {} open edges; {} samples {:.3g} apart", b.n_triangles, s.n_patches,
      s.n_patches == 1 ? "" : "es", s.n_open_edges, b.n_samples, b.spacing);
  if (b.dropped.n_degenerate + b.dropped.n_duplicates > 0)
    say("dropped {} triangles without an area and {} that were there twice", b.dropped.n_degenerate,
        b.dropped.n_duplicates);
  if (s.weld_distance > 0) say("corners nearer than {:.2g} count as one", s.weld_distance);
  if (s.n_turned > 0)
    say("turned {} triangles ({:.1f} %), so that all look outward (--normals given keeps them)", s.n_turned,
        percent(s.n_turned, b.n_triangles));
  if (s.n_one_sided_edges > 0)
    say("at {} edges the sides of neighbours contradict one another: part of the surface is one-sided",
        s.n_one_sided_edges);
  if (s.n_cavities > 0) say("{} closed shells inside of others look inward: cavities", s.n_cavities);
  if (s.n_inner_shells > 0)
    say("{} closed shells inside of others look outward: the body is solid there (turn them for cavities)",
        s.n_inner_shells);
  if (b.n_inside + b.n_inside_out > 0)
    say("left out {:.1f} % of the surface, which is inside of the body: inner walls and overlaps, by the winding "
        "number",
        percent(b.n_inside + b.n_inside_out, b.n_samples));
  if (b.unsure > kUnsure)
    say("which side is inside is a guess for {:.1f} % of the surface: the winding number is no whole number there",
        100 * b.unsure);
  if (file.n_groups_ignored > 0)
    say("{} groups or materials, more than {}: they are no patches", file.n_groups_ignored, kMostGroups);
  return list;
}

}  // namespace

bool is_of_triangles(const fs::path& source, const Parameters& parameters) {
  return holds_triangles(source, parameters.cloud().as_points ? PlyFaces::Ignored : PlyFaces::Surface);
}

ScanSource read_source(const fs::path& source, const Parameters& parameters, const Context& context) {
  const std::string& columns = parameters.cloud().columns;
  if (!is_of_triangles(source, parameters)) return {read_scan(source, columns), {}};
  if (!columns.empty())
    throw CloudRefused(source.string() + ": --columns is about tables in text, not about triangles");
  TriangleFile file = read_triangles(source);
  const NormalsOf how = parameters.cloud().normals;
  ScanSource scan;
  BodySamples body = [&] {
    try {
      return sample_body(std::move(file.mesh),
                         {.spacing = parameters.cloud().sample_spacing, .turn = how != NormalsOf::Given}, context);
    } catch (const std::invalid_argument& e) {
      throw CloudRefused(fmt::format("{}: {}", source.string(), e.what()));
    }
  }();
  if (body.cloud.points.size() < kFewestSurveyed)
    throw CloudRefused(
        fmt::format("{}: {} of {} samples lie on the boundary of a body, {} are needed: a smaller "
                    "--sample-spacing, or --normals given if the sides of the triangles are right",
                    source.string(), body.cloud.points.size(), body.report.n_samples, kFewestSurveyed));
  scan.cloud.report.format = file.report.format;
  scan.cloud.report.n_points = body.cloud.points.size();
  scan.cloud.cloud = std::move(body.cloud);
  scan.cloud.report.of_triangles = how != NormalsOf::Estimate;
  if (how == NormalsOf::Estimate) scan.cloud.cloud.normals.clear();
  SampledTriangles& t = scan.triangles.emplace();
  t.report = {.n_vertices = file.report.n_vertices,
              .n_faces = file.report.n_faces,
              .n_polygons = file.report.n_polygons,
              .body = std::move(body.report),
              .n_boundary = body.boundary.F.size(),
              .label_names = std::move(file.report.label_names)};
  t.boundary = std::move(body.boundary);
  t.notices = notices_of(t.report, file.report);
  return scan;
}

std::string fields_left_out(const CloudFileReport& file) {
  constexpr std::size_t kListed = 8;
  const std::vector<std::string>& names = file.fields_left_out;
  if (names.empty()) return {};
  const std::vector<std::string> listed(names.begin(), names.begin() + std::min(names.size(), kListed));
  return fmt::format("left out {} field{} ({}{}): {} are kept, and one of each name", names.size(),
                     names.size() == 1 ? "" : "s", fmt::join(listed, ", "), names.size() > kListed ? " ..." : "",
                     kMostFields);
}

void add_triangles(const SampledTriangles& triangles, CloudReport& report) {
  report.triangles = triangles.report;
  report.notices.insert(report.notices.begin(), triangles.notices.begin(), triangles.notices.end());
}

}  // namespace umtet
