#include "pipeline/output/export_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <variant>

#include "mesh/io/solver_files.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/record.h"
#include "pipeline/domain/load_domain.h"
#include "pipeline/meshing/sample_fields.h"
#include "pipeline/output/boundary_patches.h"
#include "pipeline/output/part_patches.h"
#include "pipeline/reports/stage_reports.h"
#include "reconstruct/io/point_cloud_io.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

using Writer = std::function<void(const fs::path&, const SolverMesh&)>;

/// A file of a format: mesh<ending> in 4-export.
struct ExportedFile {
  std::string ending;
  Writer write;
};

constexpr const char* kRegionsMesh = "regions.vtu";
constexpr const char* kBoundaryHdf5 = "mesh_boundary.h5";  // of several regions

struct ExportFormat {
  std::string name;
  std::vector<ExportedFile> files;
  std::optional<SurfaceFormat> surface = {};  ///< if set, each of several patches also has its own file
  std::optional<PieceFormat> pieces = {};     ///< if set, `files` are the files of one process
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
      {"feb", {{".feb", write_feb}}, {}},
      {"cdb", {{".cdb", write_cdb}}, {}},
      {"xdmf",
       {{".h5", write_hdf5},
        {".xdmf", [](const fs::path& p, const SolverMesh& m) { write_xdmf(p, m, "mesh.h5"); }},
        {"_boundary.xdmf", [](const fs::path& p, const SolverMesh& m) { write_boundary_xdmf(p, m, "mesh.h5"); }}},
       {},
       PieceFormat::Xdmf},
      {"stl", {{".stl", surface(SurfaceFormat::Stl)}}, SurfaceFormat::Stl},
      {"obj", {{".obj", surface(SurfaceFormat::Obj)}}, SurfaceFormat::Obj},
      {"ply", {{".ply", surface(SurfaceFormat::Ply)}}, SurfaceFormat::Ply},
      {"pvtu",
       {{"_0.vtu", write_vtu_piece},
        {".pvtu", [](const fs::path& p, const SolverMesh& m) { write_pvtu(p, m, "mesh_0.vtu"); }}},
       {},
       PieceFormat::Pvtu},
      {"pmsh",
       {{"_part_1.msh", [](const fs::path& p, const SolverMesh& m) { write_msh41_piece(p, m); }}},
       {},
       PieceFormat::Msh}};
  return formats;
}

std::vector<PendingFile> files_of(const ExportFormat& format, const fs::path& folder, const SolverMesh& mesh) {
  std::vector<PendingFile> files;
  for (const ExportedFile& file : format.files) {
    files.push_back(
        {folder / ("mesh" + file.ending), [&mesh, &file](const fs::path& path) { file.write(path, mesh); }});
  }
  if (format.pieces == PieceFormat::Xdmf && !mesh.regions.empty())
    files.push_back({folder / kBoundaryHdf5, [&mesh](const fs::path& path) { write_boundary_hdf5(path, mesh); }});
  if (!format.surface || mesh.patches.size() < 2) return files;
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    std::string name = mesh.patches[p].name;
    std::replace(name.begin(), name.end(), '|', '+');  // not in names of files of other systems
    files.push_back({folder / ("mesh." + name + format.files.front().ending),
                     [&mesh, p, surface = *format.surface](const fs::path& path) {
                       write_boundary_surface(path, mesh, surface, p);
                     }});
  }
  return files;
}

/// Returns the beginning and the end of names of files per process; a number is between them.
std::pair<std::string, std::string> around_number(PieceFormat format) {
  return format == PieceFormat::Pvtu ? std::pair("mesh_", ".vtu") : std::pair("mesh_part_", ".msh");
}

bool is_piece(const std::string& name, PieceFormat format) {
  if (format == PieceFormat::Xdmf) return false;
  const auto [begin, end] = around_number(format);
  if (!name.starts_with(begin) || !name.ends_with(end) || name.size() <= begin.size() + end.size()) return false;
  return std::all_of(name.begin() + static_cast<std::ptrdiff_t>(begin.size()),
                     name.end() - static_cast<std::ptrdiff_t>(end.size()), [](char c) { return c >= '0' && c <= '9'; });
}

bool is_exported(const std::string& name) {
  if (name == kBoundaryHdf5) return true;
  for (const ExportFormat& format : formats_known()) {
    if (format.pieces && is_piece(name, *format.pieces)) return true;
    for (const ExportedFile& file : format.files) {
      if (name == "mesh" + file.ending) return true;
    }
    if (format.surface && name.starts_with("mesh.") && name.ends_with(format.files.front().ending)) return true;
  }
  return false;
}

/// Returns the cloud from which the mesh was made; empty for a formula or a grid, and if 1-cloud has been removed.
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

/// Removes files of a former export: patches may have had other names, and there may have been more files per process.
void remove_former(const ExportFormat& format, const CasePaths& paths, const std::vector<fs::path>& written) {
  for (const fs::path& file : exported_files(paths)) {
    const bool is_boundary = format.surface && file.extension() == format.files.front().ending;
    const bool is_of_pieces = format.pieces && is_piece(file.filename(), *format.pieces);
    if ((is_boundary || is_of_pieces) && std::find(written.begin(), written.end(), file) == written.end())
      fs::remove(file);
  }
}

/// Returns whether patches are connected components of the boundary, which the processes know. Other patches, and data
/// of samples, require the whole mesh.
bool has_simple_patches(const Parameters& parameters) {
  return has_own_psi(parameters.mesh()) && parameters.output().patch_angle == 0 &&
         parameters.output().patch_planar == 0 && parameters.output().label_names.empty();
}

const ExportFormat& format_of(const std::string& name) {
  return *std::find_if(formats_known().begin(), formats_known().end(),
                       [&](const ExportFormat& f) { return f.name == name; });
}

/// Writes the files of one format; they are moved into place when all of them are written.
std::vector<fs::path> write_format(const ExportFormat& format, const fs::path& folder, const SolverMesh& mesh) {
  const std::vector<PendingFile> files = files_of(format, folder, mesh);
  write_artefacts(files);
  std::vector<fs::path> written;
  written.reserve(files.size());
  for (const PendingFile& file : files) written.push_back(file.path);
  return written;
}

std::vector<fs::path> write_pieces(PieceFormat format, const fs::path& folder, const WrittenInParts& parts,
                                   const PieceData* data) {
  const char* name = format == PieceFormat::Pvtu   ? "mesh.pvtu"
                     : format == PieceFormat::Xdmf ? "mesh.xdmf"
                                                   : "mesh_part.msh";
  return write_artefacts_in(
      folder, [&](const fs::path& temporary) { return parts.write_pieces(temporary / name, format, data); });
}

/// \throw UsageError, ArtefactDamaged
StageRecord mesh_record(const CasePaths& paths) {
  // Parameters do not matter here, but the mesh must be complete.
  const StageState state = inspect_stage(paths, Stage::Mesh, Json::object(), std::nullopt);
  if (state.kind == StageState::Kind::Damaged) throw ArtefactDamaged(state.reason);
  if (!state.record) throw UsageError("nothing to export: " + state.reason + "; umtet mesh makes it");
  return *state.record;
}

Warn warn_of(Progress& progress) {
  return [&](const std::string& text) { progress.warn("export: " + text); };
}

PieceData data_of_pieces(const CasePaths& paths, const MeshWithBoundary& mesh, const Parameters& parameters,
                         Progress& progress) {
  const StageRecord record = mesh_record(paths);
  return piece_data(mesh, cloud_of_case(paths, record), mesh_report(record).measured.domain.support, parameters,
                    warn_of(progress), label_names_of_file(paths));
}

SolverMesh mesh_of_case(const CasePaths& paths, const Parameters& parameters, Progress& progress) {
  const StageRecord record = mesh_record(paths);
  try {
    MeshFile file = read_tet_mesh(paths.mesh());
    SolverMesh mesh = file.quadratic ? solver_mesh(*file.quadratic) : solver_mesh(file.mesh);
    const MeshMeasures measured = mesh_report(record).measured;
    MarkedFaces marked = marked_faces(mesh, file, measured.domain.support);
    if (measured.features) {
      const Domain domain = load_domain(paths, parameters);
      std::vector<Vec3> V = file.mesh.V;
      for (Vec3& x : V) x -= domain.shift;
      mark_patches(domain, mesh, V, measured.mesh.h, marked);
    }
    std::map<std::string, FieldValues>& of_nodes = file.quadratic ? file.quadratic_data : file.point_data;
    for (auto it = of_nodes.begin(); it != of_nodes.end();) {
      const auto next = std::next(it);
      if (is_of_scan(it->first)) mesh.boundary_data.insert(of_nodes.extract(it));
      it = next;
    }
    // Other point data belong to corners only.
    if (!file.quadratic) mesh.point_data = std::move(file.point_data);
    mesh.cell_data = std::move(file.cell_data);
    divide_boundary(mesh, marked, cloud_of_case(paths, record), parameters, warn_of(progress),
                    label_names_of_file(paths));
    return mesh;
  } catch (const MeshFileRefused& e) {
    throw ArtefactDamaged(e.what());
  }
}

/// \throw ArtefactDamaged
SolverMesh mesh_of_regions(const fs::path& path) {
  try {
    MeshFile file = read_tet_mesh(path);
    const auto found = file.cell_data.find("region");
    const auto* marks =
        found == file.cell_data.end() ? nullptr : std::get_if<std::vector<std::int64_t>>(&found->second);
    if (!marks) throw ArtefactDamaged(path.string() + ": it has no cell data region");
    std::vector<std::string> names;
    std::vector<int> region;
    region.reserve(marks->size());
    for (const std::int64_t mark : *marks) {
      const auto name = file.region_names.find(mark);
      if (mark < 0 || name == file.region_names.end())
        throw ArtefactDamaged(fmt::format("{}: region {} has no name", path.string(), mark));
      region.push_back(static_cast<int>(mark));
    }
    for (const auto& [number, name] : file.region_names) {
      if (number != static_cast<std::int64_t>(names.size()))
        throw ArtefactDamaged(fmt::format("{}: region {} has no name", path.string(), names.size()));
      names.push_back(name);
    }
    SolverMesh mesh = solver_mesh(file.mesh);
    mesh.point_data = std::move(file.point_data);
    mesh.cell_data = std::move(file.cell_data);
    set_regions(mesh, region, names);
    return mesh;
  } catch (const MeshFileRefused& e) {
    throw ArtefactDamaged(e.what());
  } catch (const std::invalid_argument& e) {
    throw ArtefactDamaged(path.string() + ": " + e.what());
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
    throw UsageError(fmt::format("unknown format {}; {}", format,
                                 near.empty() ? fmt::format("the formats are {}", fmt::join(export_formats(), ", "))
                                              : fmt::format("did you mean {}?", near)));
  }
}

bool takes_parts(const std::vector<std::string>& formats) {
  return std::any_of(formats.begin(), formats.end(),
                     [](const auto& name) { return format_of(name).pieces.has_value(); });
}

bool is_in_pieces(const std::vector<std::string>& formats) {
  return std::any_of(formats.begin(), formats.end(), [](const auto& name) {
    return format_of(name).pieces && *format_of(name).pieces != PieceFormat::Xdmf;
  });
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
                                  const Parameters& parameters, Progress& progress, const MeshWithBoundary* parts) {
  require_formats(formats);
  std::optional<SolverMesh> mesh;
  const auto whole = [&]() -> const SolverMesh& {
    if (mesh) return *mesh;
    progress.report("export", "read", 0);
    mesh = mesh_of_case(paths, parameters, progress);
    progress.detail(fmt::format("export: {} tets, {} boundary faces in {} patches", mesh->n_tets(), mesh->n_faces(),
                                mesh->patches.size()));
    return *mesh;
  };
  std::optional<PieceData> of_pieces;
  const auto data = [&]() -> const PieceData* {
    if (has_simple_patches(parameters)) return nullptr;
    if (!of_pieces) of_pieces = data_of_pieces(paths, *parts, parameters, progress);
    return &*of_pieces;
  };
  const auto has = [&](const char* name) { return std::find(formats.begin(), formats.end(), name) != formats.end(); };
  const bool is_curved = parts ? parameters.mesh().order > 1 : has("pmsh") && whole().nodes_per_tet == 10;
  if (is_curved && has("pmsh")) throw UsageError("pmsh supports only tets of 4 nodes (--order 1)");
  if (has("mesh") && whole().nodes_per_tet == 10) {
    progress.warn("export: FreeFEM finds no tets in mesh.mesh: it reads only tets of 4 nodes (--order 1)");
  }
  fs::create_directories(paths.exports());
  remove_stale_temporaries(paths.exports());
  std::vector<fs::path> written;
  for (std::size_t i = 0; i < formats.size(); ++i) {
    stop_if_interrupted();
    progress.report("export", formats[i], static_cast<double>(i + 1) / static_cast<double>(formats.size() + 1));
    const ExportFormat& format = format_of(formats[i]);
    const bool is_of_parts = parts && format.pieces &&
                             (format.pieces != PieceFormat::Xdmf || (!is_curved && has_simple_patches(parameters)));
    const std::vector<fs::path> files = is_of_parts
                                            ? write_pieces(*format.pieces, paths.exports(), *parts->mesh, data())
                                            : write_format(format, paths.exports(), whole());
    written.insert(written.end(), files.begin(), files.end());
    remove_former(format, paths, written);
  }
  return written;
}

bool has_regions(const fs::path& folder) {
  return fs::exists(folder / kRegionsMesh) && !fs::exists(CasePaths{folder}.parameters());
}

void require_formats_of_regions(const std::vector<std::string>& formats) {
  require_formats(formats);
  if (std::find(formats.begin(), formats.end(), "pmsh") != formats.end())
    throw UsageError("pmsh supports one body only; msh has several regions");
}

std::vector<fs::path> export_regions(const fs::path& folder, const std::vector<std::string>& formats,
                                     Progress& progress) {
  require_formats_of_regions(formats);
  const CasePaths paths{folder};
  progress.report("export", "read", 0);
  const SolverMesh mesh = mesh_of_regions(folder / kRegionsMesh);
  progress.detail(fmt::format("export: {} tets in {} regions, {} faces in {} patches", mesh.n_tets(),
                              mesh.regions.size(), mesh.n_faces(), mesh.patches.size()));
  fs::create_directories(paths.exports());
  remove_stale_temporaries(paths.exports());
  std::vector<fs::path> written;
  for (std::size_t i = 0; i < formats.size(); ++i) {
    stop_if_interrupted();
    progress.report("export", formats[i], static_cast<double>(i + 1) / static_cast<double>(formats.size() + 1));
    const ExportFormat& format = format_of(formats[i]);
    const std::vector<fs::path> files = write_format(format, paths.exports(), mesh);
    written.insert(written.end(), files.begin(), files.end());
    remove_former(format, paths, written);
  }
  return written;
}

}  // namespace umtet
