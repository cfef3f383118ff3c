#include "pipeline/mesh_outputs.h"

#include <fmt/format.h>

#include "mesh/quality_report.h"
#include "pipeline/artefact.h"
#include "pipeline/made_mesh.h"
#include "pipeline/second_order.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

/// The meshes of these files in ParaView, in this order: time is their number.
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

}  // namespace

std::vector<std::string> write_mesh_outputs(const StageContext& context, const Domain& domain,
                                            const MeshAttempt& best) {
  begin_writing(context, Stage::Mesh);
  fs::remove_all(context.paths.failed());
  const fs::path folder = context.paths.folder(Stage::Mesh);
  const UmResult& result = best.result;
  const std::vector<Vec3>& omega_h = result.submesh.mesh.V;
  std::vector<std::string> names;
  const auto write = [&](const std::string& name, const std::vector<Vec3>& V) {
    names.push_back(name);
    return write_mesh(folder / name, domain, result, V);
  };
  write("omega_h.vtu", omega_h);
  for (std::size_t k = 0; k < best.iterates.size(); ++k) write(fmt::format("pass_{}.vtu", k + 1), best.iterates[k]);
  write("projected.vtu", result.projected);
  if (best.second) {
    names.emplace_back("mesh.vtu");
    write_second_order(folder / "mesh.vtu", domain, result, *best.second);
    context.handover.mesh = mesh_content(domain, result, result.final);
  } else {
    context.handover.mesh = write("mesh.vtu", result.final);
  }
  if (context.parameters.flag("mesh.keep_iterates")) {
    write_text_artefact(folder / "iterates.pvd", series_of(names));
    names.emplace_back("iterates.pvd");
  }
  write_artefact(folder / "quality.csv", [&](const fs::path& temporary) {
    write_quality_csv(temporary, quality_curves(result.submesh.mesh.C, result.submesh.positive_vertices, omega_h,
                                                result.projected, result.final));
  });
  names.emplace_back("quality.csv");
  if (!best.thin.empty()) {
    write_thin_places(folder / "too_thin.vtp", best.thin, domain.shift);
    names.emplace_back("too_thin.vtp");
  }
  return names;
}

fs::path write_failed_mesh(const CasePaths& paths, const Domain& domain, const UmResult& result) {
  fs::path folder = paths.failed();
  fs::remove_all(folder);
  const std::size_t n = result.submesh.mesh.V.size();
  if (n == 0) return folder;
  fs::create_directories(folder);
  write_mesh(folder / "omega_h.vtu", domain, result, result.submesh.mesh.V);
  const std::vector<Vec3>& last = result.final.size() == n ? result.final : result.projected;
  if (last.size() == n) write_mesh(folder / "projected.vtu", domain, result, last);
  return folder;
}

}  // namespace umtet
