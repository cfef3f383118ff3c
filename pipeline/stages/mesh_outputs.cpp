#include "pipeline/stages/mesh_outputs.h"

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <utility>

#include "body/fidelity/mesh_defects.h"
#include "body/fidelity/mesh_sizes.h"
#include "body/search/second_order.h"
#include "common/indices_where.h"
#include "mesh/certify/quality_report.h"
#include "mesh/io/feature_files.h"
#include "mesh/io/mesh_part.h"
#include "mesh/io/quality_csv.h"
#include "pipeline/case/artefact.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/meshing/defect_files.h"
#include "pipeline/meshing/made_mesh.h"
#include "pipeline/meshing/second_order_file.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

/// Returns a .pvd file that shows the meshes of these files in ParaView in this order; their time is their index.
std::string series_of(const std::vector<std::string>& files) {
  std::string pvd =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n";
  int step = 0;
  for (const std::string& name : files) {
    pvd += fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"0\" file=\"{}\"/>\n", step++, name);
  }
  return pvd + "</Collection>\n</VTKFile>\n";
}

/// The curves of Figure 8: for each stage, the quality vectors of the mesh and of its tets with a positive vertex.
class QualityCurves {
 public:
  void add(const std::string& stage, const MeshFile& content, const std::vector<int>& positive_vertices) {
    const auto& Q = std::get<std::vector<double>>(content.cell_data.at("mean_ratio"));
    auto [all, boundary] = quality_vectors(content.mesh.C, Q, positive_vertices, content.mesh.V.size());
    of_mesh_.push_back({stage, std::move(all)});
    of_boundary_.push_back({"boundary_" + stage, std::move(boundary)});
  }
  std::vector<QualityCurve> all() && {
    std::move(of_boundary_.begin(), of_boundary_.end(), std::back_inserter(of_mesh_));
    return std::move(of_mesh_);
  }

 private:
  std::vector<QualityCurve> of_mesh_, of_boundary_;
};

/// Returns the tets with a vertex that moves after the choice.
std::vector<std::size_t> moving_tets(const UmResult& result) {
  const std::vector<Vec3>& chosen = result.submesh.mesh.V;
  std::vector<std::uint8_t> moves(chosen.size());
  tbb::parallel_for(std::size_t{0}, moves.size(), [&](std::size_t v) {
    moves[v] = chosen[v] != result.projected[v] || chosen[v] != result.final[v];
  });
  const std::vector<Tet>& C = result.submesh.mesh.C;
  return indices_where<std::size_t>(
      C.size(), [&](std::size_t t) { return moves[C[t][0]] || moves[C[t][1]] || moves[C[t][2]] || moves[C[t][3]]; });
}

/// Writes the files of meshes and of their qualities for a distributed mesh, which no process has as a whole.
std::vector<std::string> write_parts(const StageContext& context, const fs::path& folder, const Domain& domain,
                                     const MeshAttempt& best) {
  const std::shared_ptr<const WrittenInParts> written = written_in_parts(best.parts);
  MeshWithBoundary handed{written, best.result.final, best.result.submesh.positive_faces,
                          boundary_data(domain, best.result, best.mid_sides)};
  for (Vec3& x : handed.V) x += domain.shift;
  // The files do not need the level set, but other processes on this machine need its memory.
  if (domain.level_set) domain.level_set->forget_below(std::numeric_limits<double>::infinity());
  const BoundaryData& of_boundary = handed.data;
  const WrittenInParts& parts = *written;
  const auto write = [&](const std::string& name, MeshState state) {
    const bool is_final = state == MeshState::Final;
    write_artefact(folder / name, [&](const fs::path& temporary) {
      parts.write(temporary, state, !is_final, is_final ? of_boundary : BoundaryData());
    });
  };
  write("omega_h.vtu", MeshState::Chosen);
  write("projected.vtu", MeshState::Projected);
  write("mesh.vtu", MeshState::Final);
  write_artefact(folder / "quality.csv", [&](const fs::path& temporary) { parts.write_quality(temporary); });
  context.handover.parts = std::make_shared<const MeshWithBoundary>(std::move(handed));
  return {"omega_h.vtu", "projected.vtu", "mesh.vtu", "quality.csv"};
}

/// Writes the same files for a mesh in this process; its tets are lent to the files.
std::vector<std::string> write_whole(const StageContext& context, const fs::path& folder, const Domain& domain,
                                     MeshAttempt& best) {
  UmResult& result = best.result;
  std::vector<std::string> names;
  QualityCurves curves;
  // If tets were flipped, the earlier stages have the tets of the background.
  const UmResult& chosen = result.of_background ? *result.of_background : result;
  const std::vector<int>& chosen_vertices = chosen.submesh.positive_vertices;
  // Tets that do not move are stored once, in mesh.vtu. All meshes of a series must have the same tets.
  const bool is_series = context.parameters.mesh().keep_iterates;
  const std::vector<std::size_t> moving = is_series ? std::vector<std::size_t>() : moving_tets(chosen);
  MeshFile content =
      result.of_background ? mesh_content(domain, chosen, chosen.submesh.mesh.V) : taken_content(domain, result);
  const auto write = [&](const std::string& name) {
    names.push_back(name);
    write_mesh(folder / name, content);
  };
  const auto write_moving = [&](const std::string& name) {
    if (moving.empty()) return write(name);
    names.push_back(name);
    write_mesh(folder / name, part_of(content, moving));
  };
  write_moving("omega_h.vtu");
  curves.add("omega_h", content, chosen_vertices);
  for (std::size_t k = 0; k < result.iterates.size(); ++k) {
    move_to(domain, result.iterates[k], content);
    write(fmt::format("pass_{}.vtu", k + 1));
  }
  move_to(domain, chosen.projected, content);
  write_moving("projected.vtu");
  curves.add("projected", content, chosen_vertices);
  if (result.of_background) content = taken_content(domain, result);
  move_to(domain, result.final, content);
  curves.add("final", content, result.submesh.positive_vertices);
  add_support(domain, result, content);
  if (best.sizes) {
    content.point_data["h"] = asked_sizes(*best.sizes, result.final, until_interrupted());
    content.point_data["edge_length"] = mean_edges(result.final, content.mesh.C);
  }
  if (best.second) {
    names.emplace_back("mesh.vtu");
    write_second_order(folder / "mesh.vtu", domain, result, content, *best.second);
  } else {
    write("mesh.vtu");
  }
  context.handover.mesh = std::move(content);
  if (is_series) {
    write_text_artefact(folder / "iterates.pvd", series_of(names));
    names.emplace_back("iterates.pvd");
  }
  write_artefact(folder / "quality.csv",
                 [all = std::move(curves).all()](const fs::path& temporary) { write_quality_csv(temporary, all); });
  names.emplace_back("quality.csv");
  return names;
}

}  // namespace

std::vector<std::string> write_mesh_outputs(const StageContext& context, const Domain& domain, MeshAttempt& best) {
  begin_writing(context, Stage::Mesh);
  fs::remove_all(context.paths.failed());
  const fs::path folder = context.paths.folder(Stage::Mesh);
  std::vector<std::string> names =
      best.parts ? write_parts(context, folder, domain, best) : write_whole(context, folder, domain, best);
  if (!best.thin.empty()) {
    write_thin_places(folder / "too_thin.vtp", best.thin, domain.shift);
    names.emplace_back("too_thin.vtp");
  }
  if (best.features && !best.features->graph.curves.empty()) {
    write_artefact(folder / "features.vtp",
                   [&](const fs::path& file) { write_features(file, *best.features, domain.shift); });
    names.emplace_back("features.vtp");
  }
  if (!best.defects.empty()) {
    write_defects(folder / "defects.vtp", best.defects);
    names.emplace_back("defects.vtp");
  }
  return names;
}

fs::path write_failed_mesh(const CasePaths& paths, const Domain& domain, const UmResult& result) {
  fs::path folder = paths.failed();
  fs::remove_all(folder);
  const std::size_t n = result.submesh.mesh.V.size();
  if (n == 0) return folder;
  fs::create_directories(folder);
  MeshFile content = mesh_content(domain, result, result.submesh.mesh.V);
  write_mesh(folder / "omega_h.vtu", content);
  const bool has_final = result.final.size() == n;
  if (!has_final && result.projected.size() != n) return folder;
  move_to(domain, has_final ? result.final : result.projected, content);
  if (has_final) add_support(domain, result, content);
  write_mesh(folder / "projected.vtu", content);
  return folder;
}

}  // namespace umtet
