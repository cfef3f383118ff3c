#include "pipeline/output/inspect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "body/edges/edged_body.h"
#include "body/scan/cloud_preparation.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/option_words.h"
#include "pipeline/domain/edged_case.h"
#include "reconstruct/cloud/cloud_arrays.h"
#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/cloud/survey/cloud_survey.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/solve/resolution.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

// Bounds of shares and ratios beyond which a warning is given.
constexpr double kConsistent = .98, kVariation = 30, kShareDropped = .01, kOpen = .05, kUlp = 1e-3, kFloatUlp = .1;
// If a body is thinner than this many edges of the default mesh, faces of the mesh fold.
constexpr double kThin = 2.2 * kMeshEdge;

/// Returns likely problems with remedies.
std::vector<std::string> troubles(const CloudSurvey& s, const CloudFileReport& file) {
  std::vector<std::string> list;
  const auto trouble = [&]<class... T>(fmt::format_string<T...> format, T&&... args) {
    list.push_back(fmt::format(format, std::forward<T>(args)...));
  };
  const auto n = static_cast<double>(s.n_points);
  if (file.n_points_dropped > 0) trouble("{} points are not finite: they are dropped", file.n_points_dropped);
  if (s.dropped.n_duplicates > 0) trouble("{} points are duplicates: one of each is kept", s.dropped.n_duplicates);
  if (const std::size_t junk = s.dropped.n_outliers + s.dropped.n_small_components;
      static_cast<double>(junk) > kShareDropped * n) {
    trouble("{} points ({:.1f} %) are far from any surface: they are dropped; --keep-all keeps them", junk,
            100 * static_cast<double>(junk) / n);
  }
  if (const std::string left_out = fields_left_out(file); !left_out.empty()) list.push_back(left_out);
  if (s.has_lines_of_sight) {
    trouble(
        "the normals are not perpendicular to the surface of the points: they are replaced by estimated normals; "
        "--normals given keeps them");
  } else if (!s.has_normals) {
    trouble(
        "no normals: they are estimated and oriented; check the result, or give the position of the scanner with "
        "--orient-from");
  } else {
    if (s.n_normals_zero > 0) trouble("{} normals are missing: they are estimated", s.n_normals_zero);
    if (s.consistency < kConsistent) {
      trouble(
          "only {:.1f} % of the normals agree with their neighbours: a reversed minority is turned back; "
          "--normals estimate discards them",
          100 * s.consistency);
    }
    if (s.volume < 0) trouble("the normals point inward: they are turned");
    if (s.openness > kOpen) {
      trouble(
          "the surface is open or sampled on one side (|sum a n| / sum a = {:.2f}): its closure is a guess, "
          "which the certificate and the patch closed_holes show",
          s.openness);
    }
  }
  if (s.density_variation > kVariation) {
    trouble("the density varies {:.0f} : 1: sparse parts get a coarser surface", s.density_variation);
  }
  if (s.noise > s.spacing[1]) {
    trouble("noise of {:.2g} spacings: the surface is smoothed over three times the noise; --detail keeps more of it",
            s.noise_over_spacing);
  }
  if (s.thickness && (*s.thickness)[0] < kThin * s.diagonal) {
    trouble("1 % of the body is thinner than {:.3g}: the mesh needs --h {:.2g} or smaller to resolve it",
            (*s.thickness)[0], (*s.thickness)[0] / 2.2);
  }
  if (s.ulp_over_spacing > kUlp) {
    trouble("coordinates of {:.3g} have a rounding error of {:.1g} of the spacing: move the cloud closer to the origin",
            s.farthest_coordinate, s.ulp_over_spacing);
  } else if (s.float_ulp_over_spacing > kFloatUlp) {
    trouble("if these coordinates were ever in single precision, they have steps of {:.1g} spacings",
            s.float_ulp_over_spacing);
  }
  return list;
}

/// Says what becomes of the sharp edges of triangles.
void add_sharp_edges(const EdgedTriangles& edged, SampledTriangles& triangles, std::vector<std::string>& troubles) {
  const SharpEdges& edges = edged.triangles->edges;
  if (edges.curves.empty()) return;
  const std::string found = edges_text(edges) + fmt::format(", a length of {:.4g}", edges.length());
  if (edged.body) {
    triangles.notices.emplace_back(found + ": each patch gets a function of its own, and the mesh has the edges");
  } else if (edges.n_curves_by(SharpCurve::Reason::Turn) > 0) {
    troubles.push_back(found + ": psi is smooth and rounds them within an edge length; a smaller --h rounds less");
  }
}

/// Predicts `umtet run` with the same parameters. A failure is reported as an obstacle, and costs are then estimated
/// from the samples.
RunPrediction prediction_of(CloudFile scan, const fs::path& file, const CloudSurvey& survey, double area,
                            const EdgedTriangles& edged, const Parameters& parameters) {
  std::string obstacle;
  try {
    if (edged.body) return predict_run(edged, parameters, until_interrupted());
    return predict_run(std::move(scan), file, parameters, until_interrupted());
  } catch (const CloudRefused& e) {
    obstacle = text_of(e.message, as_flag);
  } catch (const SolveError& e) {
    obstacle = e.what();
  } catch (const SolveTooLarge& e) {
    obstacle = text_of(e.message, as_flag);
  } catch (const MeshingImpossible& e) {
    obstacle = text_of(e.message, as_flag);
  } catch (const ResourceLimit& e) {
    obstacle = text_of(e.message, as_flag);
  }
  RunPrediction run = predict_run(survey, area, parameters);
  run.obstacle = std::move(obstacle);
  return run;
}

}  // namespace

CloudInspection inspect_cloud(const InputFile& input, const Parameters& given, Progress& progress) {
  Parameters parameters = given;
  take_given_edges(parameters);
  progress.report("inspect", "read", 0);
  const fs::path& file = input.path();
  ScanSource source = read_source(input, parameters);
  const CloudFile& scan = source.cloud;
  progress.report("inspect", "survey", .3);
  CloudSurvey s = [&] {
    try {
      return survey(scan.cloud);
    } catch (const TooFewPoints& e) {
      throw CloudRefused(fmt::format("{}: {}: duplicates and outliers are not counted", file.string(), e.what()));
    }
  }();
  std::vector<double> area = sample_areas(scan.cloud.points);
  std::nth_element(area.begin(), area.begin() + static_cast<std::ptrdiff_t>(area.size() / 2), area.end());
  Resolution lattice = choose_resolution(std::sqrt(area[area.size() / 2]), kMeshEdge * s.diagonal, s.noise);
  std::vector<std::string> list = troubles(s, scan.report), fields = field_names(scan.cloud);
  EdgedTriangles edged;
  if (source.triangles) {
    edged = edged_triangles(source.triangles->boundary, middle_of(source.triangles->boundary), parameters);
    add_sharp_edges(edged, *source.triangles, list);
  }
  CloudFileReport report = scan.report;
  progress.report("inspect", "predict the run", .6);
  RunPrediction prediction =
      prediction_of(std::move(source.cloud), file, s, std::accumulate(area.begin(), area.end(), 0.), edged, parameters);
  return {file.string(), std::move(report),  std::move(fields),     std::move(source.triangles),
          std::move(s),  std::move(lattice), std::move(prediction), std::move(list)};
}

Json to_json(const CloudInspection& inspection) {
  const CloudSurvey& s = inspection.survey;
  Json json = {{"file", inspection.file},
               {"format", inspection.read.format},
               {"n_points", s.n_points},
               {"box", {{"min", json_of(s.low)}, {"max", json_of(s.high)}, {"diagonal", s.diagonal}}},
               {"spacing", {{"p01", s.spacing[0]}, {"median", s.spacing[1]}, {"p99", s.spacing[2]}}},
               {"density_variation", s.density_variation}};
  if (inspection.triangles) {
    json["triangles"] = to_json(inspection.triangles->report);
    json["triangles"]["notices"] = texts_of(inspection.triangles->notices, as_flag);
  }
  if (!inspection.read.columns.empty()) json["columns"] = inspection.read.columns;
  if (!inspection.fields.empty()) json["fields"] = inspection.fields;
  Json normals = {{"present", s.has_normals}, {"lines_of_sight", s.has_lines_of_sight}};
  if (s.has_normals) {
    normals.update({{"missing", s.n_normals_zero},
                    {"rescaled", inspection.read.n_normals_rescaled},
                    {"consistency", s.consistency},
                    {"outward", s.volume > 0},
                    {"openness", s.openness}});
  }
  json["normals"] = std::move(normals);
  json["noise"] = {
      {"sigma", s.noise}, {"over_spacing", s.noise_over_spacing}, {"over_diagonal", s.noise_over_diagonal}};
  json["thickness"] = s.thickness ? Json({{"p01", (*s.thickness)[0]},
                                          {"p05", (*s.thickness)[1]},
                                          {"median", (*s.thickness)[2]},
                                          {"share_of_samples_with_an_opposite", s.thickness_found}})
                                  : Json(nullptr);
  json["dropped"] = {{"not_finite", inspection.n_not_finite()},
                     {"duplicates", s.dropped.n_duplicates},
                     {"outliers", s.dropped.n_outliers},
                     {"small_components", s.dropped.n_small_components}};
  json["origin"] = {{"farthest_coordinate", s.farthest_coordinate}, {"ulp_over_spacing", s.ulp_over_spacing}};
  const Resolution& lattice = inspection.lattice;
  json["lattice"] = {{"spacing", lattice.spacing}, {"smoothing", lattice.smoothing}, {"reason", lattice.reason}};
  json["prediction"] = to_json(inspection.prediction);
  json["trouble"] = inspection.troubles;
  return json;
}

std::string inspection_text(const CloudInspection& inspection) {
  const CloudSurvey& s = inspection.survey;
  std::string out = fmt::format("cloud     {}: {}, {} {}\n", inspection.file, inspection.read.format, s.n_points,
                                inspection.triangles ? "samples of its triangles" : "points");
  if (inspection.triangles) {
    for (const std::string& notice : texts_of(inspection.triangles->notices, as_flag))
      out += "triangles " + notice + "\n";
    for (std::size_t i = 0; i < inspection.triangles->report.label_names.size(); ++i)
      out += fmt::format("label     {} = {}\n", i + 1, inspection.triangles->report.label_names[i]);
  }
  constexpr std::string_view kColumns = "columns ";  // their line begins with this word, too
  if (const std::string& columns = inspection.read.columns; !columns.empty())
    out += fmt::format("columns   {}{}\n", columns.substr(std::min(kColumns.size(), columns.size())),
                       inspection.read.columns_are_guessed ? "; --columns overrules" : "");
  const Vec3 size = s.high - s.low;
  out += fmt::format("box       {:.6g} x {:.6g} x {:.6g}, diagonal {:.6g}\n", size.x(), size.y(), size.z(), s.diagonal);
  out += fmt::format("spacing   median {:.4g}, 1 % {:.4g}, 99 % {:.4g}; density varies {:.1f} : 1\n", s.spacing[1],
                     s.spacing[0], s.spacing[2], s.density_variation);
  if (s.has_normals) {
    out += fmt::format("normals   {:.1f} % consistent, {}; {} missing, {} normalised\n", 100 * s.consistency,
                       s.volume > 0 ? "outward" : "inward", s.n_normals_zero, inspection.read.n_normals_rescaled);
  } else {
    out += fmt::format("normals   none{}\n",
                       s.has_lines_of_sight ? "; the vectors in the file may be lines of sight" : "");
  }
  if (!inspection.fields.empty()) out += fmt::format("fields    {}\n", fmt::join(inspection.fields, ", "));
  out += fmt::format("noise     {:.3g} ({:.3g} spacings, {:.2g} of the diagonal)\n", s.noise, s.noise_over_spacing,
                     s.noise_over_diagonal);
  if (s.thickness) {
    const auto& [p01, p05, median] = *s.thickness;
    out += fmt::format("thickness 1 % {:.4g}, 5 % {:.4g}, median {:.4g}\n", p01, p05, median);
  }
  out += fmt::format("dropped   {} not finite, {} duplicates, {} outliers, {} in small components\n",
                     inspection.n_not_finite(), s.dropped.n_duplicates, s.dropped.n_outliers,
                     s.dropped.n_small_components);
  out += fmt::format("lattice   {:.4g}: {}\n", inspection.lattice.spacing, inspection.lattice.reason);
  out += prediction_text(inspection.prediction);
  if (inspection.troubles.empty()) out += "trouble   none seen\n";
  for (const std::string& trouble : inspection.troubles) out += "trouble   " + trouble + "\n";
  return out;
}

}  // namespace umtet
