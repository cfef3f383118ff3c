#include "pipeline/export_case.h"

#include <fmt/format.h>

#include <algorithm>

#include "mesh/skin.h"
#include "mesh/tet_mesh_io.h"
#include "pipeline/exit_code.h"
#include "pipeline/interrupt.h"
#include "pipeline/parameters.h"
#include "pipeline/record.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

void write(const std::string& format, const fs::path& file, const MeshFile& mesh,
           const std::vector<Triangle>& boundary) {
  if (format == "msh") write_msh41(file, mesh.mesh, boundary, MshEncoding::Binary);
  if (format == "msh22") write_msh22(file, mesh.mesh, boundary, MshEncoding::Binary);
  if (format == "mesh") write_medit(file, mesh.mesh, boundary);
  if (format == "vtu") write_vtu(file, mesh);
  if (format == "stl") write_surface(file, mesh.mesh.V, boundary, SurfaceFormat::Stl);
}

}  // namespace

const std::vector<std::string>& export_formats() {
  static const std::vector<std::string> formats = {"msh", "msh22", "mesh", "vtu", "stl"};
  return formats;
}

fs::path exported_file(const CasePaths& paths, const std::string& format) {
  // Two flavours of one suffix must not overwrite each other.
  return paths.exports() / (format == "msh22" ? "mesh_22.msh" : "mesh." + format);
}

std::vector<fs::path> export_case(const CasePaths& paths, const std::vector<std::string>& formats, Progress& progress) {
  for (const std::string& format : formats) {
    if (std::find(export_formats().begin(), export_formats().end(), format) != export_formats().end()) continue;
    const std::string near = nearest(format, export_formats());
    throw UsageError("no format " + format +
                     (near.empty() ? "; there are msh, msh22, mesh, vtu, stl" : "; did you mean " + near + "?"));
  }
  // Parameters do not matter here: whatever made the mesh, it must be whole.
  const StageState state = inspect_stage(paths, Stage::Mesh, Json::object(), std::nullopt);
  if (state.kind == StageState::Kind::Damaged) throw ArtefactDamaged(state.reason);
  if (!state.record) throw UsageError("nothing to export: " + state.reason);
  progress.report("export", "read", 0);
  const MeshFile mesh = [&] {
    try {
      return read_tet_mesh(paths.mesh());
    } catch (const MeshFileRefused& e) {
      throw ArtefactDamaged(e.what());
    }
  }();
  const std::vector<Triangle> boundary = boundary_faces(mesh.mesh.C, mesh.mesh.V.size()).triangles;
  progress.detail(fmt::format("export: {} tets, {} boundary faces", mesh.mesh.C.size(), boundary.size()));
  fs::create_directories(paths.exports());
  remove_stale_temporaries(paths.exports());
  std::vector<fs::path> files;
  for (const std::string& format : formats) {
    stop_if_interrupted();
    progress.report("export", format, static_cast<double>(files.size() + 1) / static_cast<double>(formats.size() + 1));
    files.push_back(exported_file(paths, format));
    write_artefact(files.back(), [&](const fs::path& temporary) { write(format, temporary, mesh, boundary); });
  }
  return files;
}

}  // namespace umtet
