#include "pipeline/output/export_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <optional>

#include "mesh/io/solver_files.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/record.h"
#include "pipeline/meshing/sample_fields.h"
#include "pipeline/output/boundary_patches.h"
#include "pipeline/reports/stage_reports.h"
#include "reconstruct/io/point_cloud_io.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

using Writer = std::function<void(const fs::path&, const SolverMesh&)>;

/// A file of a format: mesh<ending>, in 4-export.
struct ExportedFile {
  std::string ending;
  Writer write;
};

struct ExportFormat {
  std::string name;
  std::vector<ExportedFile> files;
  std::optional<SurfaceFormat> surface;  ///< then each of several patches has a file of its own too
};

const std::vector<ExportFormat>& formats_known() {
  const auto surface = [](SurfaceFormat format) {
    return [format](const fs::path& p, const SolverMesh& m) { write_boundary_surface(p, m, format); };
  };
  static const std::vector<ExportFormat> formats = {
      {"vtu",
       {{".vtu", [](const fs::path& p, const SolverMesh& m) { write_vtu(p, m); }},
        {"_boundary.vtu", write_boundary_vtu}},
       {}},
      {"msh", {{".msh", [](const fs::path& p, const SolverMesh& m) { write_msh41(p, m, MshEncoding::Binary); }}}, {}},
      // Both versions have the suffix .msh and must not overwrite each other.
      {"msh22",
       {{"_22.msh", [](const fs::path& p, const SolverMesh& m) { write_msh22(p, m, MshEncoding::Binary); }}},
       {}},
      {"mesh", {{".mesh", write_medit}}, {}},
      {"inp", {{".inp", write_inp}}, {}},
      {"bdf", {{".bdf", write_nastran}}, {}},
      {"xdmf",
       {{".h5", write_hdf5},
        {".xdmf", [](const fs::path& p, const SolverMesh& m) { write_xdmf(p, m, "mesh.h5"); }},
        {"_boundary.xdmf", [](const fs::path& p, const SolverMesh& m) { write_boundary_xdmf(p, m, "mesh.h5"); }}},
       {}},
      {"stl", {{".stl", surface(SurfaceFormat::Stl)}}, SurfaceFormat::Stl},
      {"obj", {{".obj", surface(SurfaceFormat::Obj)}}, SurfaceFormat::Obj},
      {"ply", {{".ply", surface(SurfaceFormat::Ply)}}, SurfaceFormat::Ply}};
  return formats;
}

std::vector<PendingFile> files_of(const ExportFormat& format, const fs::path& folder, const SolverMesh& mesh) {
  std::vector<PendingFile> files;
  for (const ExportedFile& file : format.files) {
    files.push_back(
        {folder / ("mesh" + file.ending), [&mesh, &file](const fs::path& path) { file.write(path, mesh); }});
  }
  if (!format.surface || mesh.patches.size() < 2) return files;
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    files.push_back({folder / ("mesh." + mesh.patches[p].name + format.files.front().ending),
                     [&mesh, p, surface = *format.surface](const fs::path& path) {
                       write_boundary_surface(path, mesh, surface, p);
                     }});
  }
  return files;
}

bool is_exported(const std::string& name) {
  for (const ExportFormat& format : formats_known()) {
    for (const ExportedFile& file : format.files) {
      if (name == "mesh" + file.ending) return true;
    }
    if (format.surface && name.starts_with("mesh.") && name.ends_with(format.files.front().ending)) return true;
  }
  return false;
}

/// The cloud that the mesh was made of; empty for a formula or a grid, and where 1-cloud has been taken away.
OrientedPointCloud cloud_of_case(const CasePaths& paths, const StageRecord& mesh) {
  for (const char* key : {"implicit", "level_set"}) {
    if (!mesh.parameters.value(key, "").empty()) return {};
  }
  const StageState state = inspect_stage(paths, Stage::Cloud, Json::object(), std::nullopt);
  if (state.kind == StageState::Kind::Damaged) throw ArtefactDamaged(state.reason);
  if (!state.record) return {};
  try {
    return read_point_cloud(paths.cloud()).cloud;
  } catch (const CloudRefused& e) {
    throw ArtefactDamaged(e.what());
  }
}

/// Patches that had other names in a former export have other files.
void remove_former_surfaces(const ExportFormat& format, const CasePaths& paths, const std::vector<fs::path>& written) {
  if (!format.surface) return;
  for (const fs::path& file : exported_files(paths)) {
    const bool is_boundary = file.extension() == format.files.front().ending;
    if (is_boundary && std::find(written.begin(), written.end(), file) == written.end()) fs::remove(file);
  }
}

SolverMesh mesh_of_case(const CasePaths& paths, const Parameters& parameters, Progress& progress) {
  // Parameters do not matter here: whatever made the mesh, it must be whole.
  const StageState state = inspect_stage(paths, Stage::Mesh, Json::object(), std::nullopt);
  if (state.kind == StageState::Kind::Damaged) throw ArtefactDamaged(state.reason);
  if (!state.record) throw UsageError("nothing to export: " + state.reason + "; umtet mesh makes it");
  try {
    MeshFile file = read_tet_mesh(paths.mesh());
    SolverMesh mesh = file.quadratic ? solver_mesh(*file.quadratic) : solver_mesh(file.mesh);
    const MarkedFaces marked = marked_faces(mesh, file, mesh_report(*state.record).measured.domain.support);
    std::map<std::string, FieldValues>& of_nodes = file.quadratic ? file.quadratic_data : file.point_data;
    for (auto it = of_nodes.begin(); it != of_nodes.end();) {
      const auto next = std::next(it);
      if (is_of_scan(it->first)) mesh.boundary_data.insert(of_nodes.extract(it));
      it = next;
    }
    // What else is read for points is read for corners.
    if (!file.quadratic) mesh.point_data = std::move(file.point_data);
    mesh.cell_data = std::move(file.cell_data);
    divide_boundary(
        mesh, marked, cloud_of_case(paths, *state.record), parameters,
        [&](const std::string& text) { progress.warn("export: " + text); }, label_names_of_file(paths));
    return mesh;
  } catch (const MeshFileRefused& e) {
    throw ArtefactDamaged(e.what());
  }
}

}  // namespace

const std::vector<std::string>& export_formats() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const ExportFormat& format : formats_known()) list.push_back(format.name);
    return list;
  }();
  return names;
}

void require_formats(const std::vector<std::string>& formats) {
  for (const std::string& format : formats) {
    if (std::find(export_formats().begin(), export_formats().end(), format) != export_formats().end()) continue;
    const std::string near = nearest(format, export_formats());
    throw UsageError(fmt::format("no format {}; {}", format,
                                 near.empty() ? fmt::format("there are {}", fmt::join(export_formats(), ", "))
                                              : fmt::format("did you mean {}?", near)));
  }
}

std::vector<fs::path> exported_files(const CasePaths& paths) {
  std::vector<fs::path> files;
  std::error_code missing;
  for (const fs::directory_entry& entry : fs::directory_iterator(paths.exports(), missing)) {
    if (is_exported(entry.path().filename().string())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<fs::path> export_case(const CasePaths& paths, const std::vector<std::string>& formats,
                                  const Parameters& parameters, Progress& progress) {
  require_formats(formats);
  progress.report("export", "read", 0);
  const SolverMesh mesh = mesh_of_case(paths, parameters, progress);
  progress.detail(fmt::format("export: {} tets, {} boundary faces in {} patches", mesh.n_tets(), mesh.n_faces(),
                              mesh.patches.size()));
  if (mesh.nodes_per_tet == 10 && std::find(formats.begin(), formats.end(), "mesh") != formats.end()) {
    progress.warn("export: FreeFEM finds no tets in mesh.mesh: it reads those of 4 nodes (--order 1)");
  }
  fs::create_directories(paths.exports());
  remove_stale_temporaries(paths.exports());
  std::vector<fs::path> written;
  for (std::size_t i = 0; i < formats.size(); ++i) {
    stop_if_interrupted();
    progress.report("export", formats[i], static_cast<double>(i + 1) / static_cast<double>(formats.size() + 1));
    const auto format = std::find_if(formats_known().begin(), formats_known().end(),
                                     [&](const ExportFormat& f) { return f.name == formats[i]; });
    const std::vector<PendingFile> files = files_of(*format, paths.exports(), mesh);
    write_artefacts(files);
    for (const PendingFile& file : files) written.push_back(file.path);
    remove_former_surfaces(*format, paths, written);
  }
  return written;
}

}  // namespace umtet
