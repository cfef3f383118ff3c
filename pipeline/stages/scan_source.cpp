#include "pipeline/stages/scan_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pipeline/case/artefact.h"
#include "reconstruct/cloud/survey/cloud_survey.h"
#include "reconstruct/io/feature_lines_io.h"
#include "reconstruct/triangles/body_samples.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

// Share of samples with a guessed side that is reported.
constexpr double kUnsure = .01;

std::vector<std::string> names_of_caps(std::size_t n) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < n; ++k) names.push_back(fmt::format("opening_{}", k + 1));
  return names;
}

/// Names the caps. There are as many names as labels, or none: a file may have labels without names.
void name_caps(TrianglesReport& t) {
  const std::vector<PlaneCap>& caps = t.body.caps;
  if (caps.empty()) return;
  // Without labels in the file, all other triangles have label 1.
  if (t.label_names.empty() && t.n_labels == 0) t.label_names.emplace_back("wall");
  if (t.label_names.size() < t.n_labels) return;
  for (std::string& name : names_of_caps(caps.size())) t.label_names.push_back(std::move(name));
}

/// Returns the repairs, and how certain they are.
std::vector<Message> notices_of(const TrianglesReport& t, const TriangleFileReport& file, Touching touching) {
  std::vector<Message> list;
  const auto say = [&]<class... T>(fmt::format_string<T...> format, T&&... args) {
    list.emplace_back(fmt::format(format, std::forward<T>(args)...));
  };
  const auto remedy = [&](Setting setting, const char* effect) {
    list.back().remedies.push_back({Change::Use, std::move(setting), effect});
  };
  const TriangleReport& b = t.body;
  const FaceSidesReport& s = b.sides;
  const auto percent = [&](std::size_t n, std::size_t of) {
    return 100. * static_cast<double>(n) / static_cast<double>(of);
  };
  say("{} triangles in {} patch{}, {} open edges; {} samples {:.3g} apart{}", b.n_triangles, s.n_patches,
      s.n_patches == 1 ? "" : "es", s.n_open_edges, b.n_samples, b.spacing,
      b.least_spacing < b.spacing ? fmt::format(", {:.3g} where the body or a gap is thin", b.least_spacing) : "");
  if (!b.caps.empty()) {
    say("closed {} opening{} by the plane of {} rim: patch{} {}", b.caps.size(), b.caps.size() == 1 ? "" : "s",
        b.caps.size() == 1 ? "its" : "each one's", b.caps.size() == 1 ? "" : "es",
        fmt::join(names_of_caps(b.caps.size()), ", "));
    remedy({Option{keys::reconstruct::close}, "smooth"}, "does not");
    remedy({Option{keys::cloud::cap}, "false"}, "does not");
  }
  if (b.touching.n_contacts > 0) {
    const bool apart = touching == Touching::Apart;
    say("{} closed components meet along edges or at corners: {} there, {:.3g} wide", b.touching.n_pieces,
        apart ? "a gap is left" : "a neck is added", 2 * b.touching.width);
    remedy({Option{keys::cloud::touching}, apart ? "fuse" : "apart"}, apart ? "joins them" : "separates them");
  }
  if (b.dropped.n_degenerate + b.dropped.n_duplicates > 0)
    say("dropped {} triangles without area and {} duplicate triangles", b.dropped.n_degenerate, b.dropped.n_duplicates);
  if (s.weld_distance > 0) say("corners closer than {:.2g} are merged", s.weld_distance);
  if (s.n_turned > 0) {
    say("turned {} triangles ({:.1f} %), so that all face outward", s.n_turned, percent(s.n_turned, b.n_triangles));
    remedy({Option{keys::cloud::normals}, "given"}, "keeps them");
  }
  if (s.n_one_sided_edges > 0)
    say("at {} edges the sides of neighbouring triangles contradict each other: part of the surface is one-sided",
        s.n_one_sided_edges);
  if (s.n_cavities > 0) say("{} closed shells inside others face inward: they are cavities", s.n_cavities);
  if (s.n_inner_shells > 0)
    say("{} closed shells inside others face outward: the body is solid there (turn them to get cavities)",
        s.n_inner_shells);
  if (b.n_inside + b.n_inside_out > 0)
    say("left out {:.1f} % of the surface, which is inside the body: inner walls and overlaps, by the winding "
        "number",
        percent(b.n_inside + b.n_inside_out, b.n_samples));
  if (b.unsure > kUnsure)
    say("the inside is a guess for {:.1f} % of the surface: the winding number is not a whole number there",
        100 * b.unsure);
  if (file.n_lines > 0) say("{} edges are given by lines of the file", file.n_lines);
  if (file.n_lines_ignored > 0)
    say("lines of the file leave the edges of its triangles at {} places: they are ignored there",
        file.n_lines_ignored);
  if (file.n_groups_ignored > 0)
    say("{} groups or materials, more than {}: they are ignored", file.n_groups_ignored, kMostGroups);
  return list;
}

void require_regular_file(const fs::path& file) {
  const fs::file_status status = fs::status(file);
  if (fs::is_directory(status)) throw CloudRefused(file.string() + ": a folder; give the file of the cloud");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw CloudRefused(file.string() + ": not a regular file; copy its output to a file and give that file");
  }
}

}  // namespace

std::shared_ptr<const InputFile> open_source(const fs::path& file) {
  require_regular_file(file);
  return std::make_shared<InputFile>(file);
}

std::vector<RecordedFile> source_inputs(const InputFile& source, const Parameters& parameters, FileStamps& stamps) {
  // Gigabytes that are not a scan are not read for their checksum.
  if (!stamps.knows(source)) {
    is_of_triangles(source, parameters) ? check_triangles_head(source)
                                        : check_scan_head(source, parameters.cloud().columns);
  }
  std::vector<RecordedFile> inputs = {{"source", stamps.of(source)}};
  const auto add = [&](const char* name, const std::string& file, const char* too_large) {
    if (file.empty()) return;
    if (is_too_large_a_text(file)) throw CloudRefused(file + too_large);
    require_regular_file(file);
    inputs.push_back({name, stamps.of(fs::path(file))});
  };
  add("viewpoints", parameters.cloud().orient_from, ": too large for a file of viewpoints with lines x y z");
  add("features", parameters.cloud().features, ": too large for a file of edges");
  return inputs;
}

bool is_of_triangles(const InputFile& source, const Parameters& parameters) {
  return holds_triangles(source, parameters.cloud().as_points ? PlyFaces::Ignored : PlyFaces::Surface);
}

ScanSource read_source(const InputFile& source, const Parameters& parameters, const Context& context) {
  const std::string& columns = parameters.cloud().columns;
  const fs::path features = parameters.cloud().features;
  if (!is_of_triangles(source, parameters)) {
    if (!features.empty())
      throw CloudRefused(
          {source.path().string() + ": ", Option{keys::cloud::features}, " applies to triangles, not to points"});
    return {read_scan(source, columns), {}};
  }
  if (!columns.empty())
    throw CloudRefused(
        {source.path().string() + ": ", Option{keys::cloud::columns}, " applies to text tables, not to triangles"});
  TriangleFile file = read_triangles(source);
  std::size_t n_given = 0;
  if (!features.empty()) {
    require_regular_file(features);
    n_given = add_lines(file.mesh, read_feature_lines(features), features);
  }
  const NormalsOf how = parameters.cloud().normals;
  const Touching touching = parameters.cloud().touching;
  ScanSource scan;
  const std::size_t n_labels =
      file.mesh.labels.empty()
          ? 0
          : static_cast<std::size_t>(std::max(0, *std::max_element(file.mesh.labels.begin(), file.mesh.labels.end())));
  BodySamples body = [&] {
    try {
      return sample_body(std::move(file.mesh),
                         {.spacing = parameters.cloud().sample_spacing,
                          .turn = how != NormalsOf::Given,
                          .cap = parameters.cloud().cap,
                          .touching = touching},
                         context);
    } catch (const std::invalid_argument& e) {
      throw CloudRefused(fmt::format("{}: {}", source.path().string(), e.what()));
    }
  }();
  if (body.cloud.points.size() < kFewestSurveyed)
    throw CloudRefused(
        fmt::format("{}: {} of {} samples lie on the boundary of a body, {} are needed", source.path().string(),
                    body.cloud.points.size(), body.report.n_samples, kFewestSurveyed),
        {{Change::Lower, Option{keys::cloud::sample_spacing}},
         {Change::Give, {Option{keys::cloud::normals}, "given"}, "if the sides of the triangles are right"}});
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
              .label_names = std::move(file.report.label_names),
              .n_labels = n_labels};
  name_caps(t.report);
  t.boundary = std::move(body.boundary);
  t.notices = notices_of(t.report, file.report, touching);
  if (n_given > 0) t.notices.emplace_back(fmt::format("{} edges are given by {}", n_given, features.string()));
  return scan;
}

void add_triangles(const SampledTriangles& triangles, CloudReport& report) {
  report.triangles = triangles.report;
  report.notices.insert(report.notices.begin(), triangles.notices.begin(), triangles.notices.end());
}

}  // namespace umtet
