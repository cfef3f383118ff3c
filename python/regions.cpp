// One mesh of several bodies, of umtet/_regions.py.

#include "python/regions.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "body/regions/region_bodies.h"
#include "mesh/io/solver_files.h"
#include "pipeline/memory/jobs.h"
#include "pipeline/reports/region_json.h"
#include "python/arguments.h"
#include "python/interruptible.h"

namespace py = pybind11;

namespace umtet::python {
namespace {

using NamedBodies = std::vector<std::pair<std::string, py::object>>;

/// @param p  is owned by the body
RegionBody body_of(const std::string& name, std::shared_ptr<const Psi> p) {
  if (const std::string problem = problem_of_region_name(name); !problem.empty())
    throw std::invalid_argument("the name '" + name + "' " + problem);
  RegionBody body;
  body.name = name;
  Box box;
  for (const Vec3& x : p->domain.cloud.points) {
    body.samples.push_back(x + p->domain.shift);
    box.extend(body.samples.back());
  }
  if (!box.isEmpty()) body.box = box;
  body.psi = [p = std::move(p)](const Vec3& x, Vec3* gradient, Mat3* hessian) {
    return p->domain.evaluate(x - p->domain.shift, gradient, hessian);
  };
  return body;
}

RegionBodyMesh mesh_regions(const NamedBodies& named, const Settings& settings, bool has_outside,
                            const py::object& progress, int threads) {
  const Parameters parameters = parameters_of(settings);
  RegionBodyOptions options{.h = parameters.mesh().h,
                            .tets = parameters.mesh().tets,
                            .box = parse_box(parameters.mesh().box),
                            .has_outside = has_outside};
  std::vector<RegionBody> bodies;
  bool asks_python = false;
  for (const auto& [name, psi] : named) {
    auto p = std::make_shared<const Psi>(psi_of(psi, options.box, std::nullopt, threads));
    asks_python = asks_python || p->function != nullptr;
    bodies.push_back(body_of(name, std::move(p)));
  }
  auto job = [bodies = std::move(bodies), options](const Watch& watch) mutable {
    options.context = context_of(watch);
    return mesh_region_bodies(bodies, options);
  };
  if (!asks_python) return interruptible(progress, threads, std::move(job));
  const Watch watch = watch_of(progress);
  return in_arena(1, [&] { return job(watch); });
}

SolverMesh solver_mesh_of(const RegionBodyMesh& made) {
  SolverMesh mesh = solver_mesh(made.mesh.mesh);
  set_regions(mesh, made.mesh.region, made.names);
  return mesh;
}

/// Faces by the name of their patch: boundary and interfaces.
py::dict patches_of(const RegionBodyMesh& made) {
  const SolverMesh mesh = solver_mesh_of(made);
  std::vector<std::vector<Triangle>> faces(mesh.patches.size());
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    const std::array<int, 6> ids = mesh.face(f);
    faces[static_cast<std::size_t>(mesh.face_patch[f])].push_back({ids[0], ids[1], ids[2]});
  }
  py::dict patches;
  for (std::size_t p = 0; p < faces.size(); ++p) patches[py::str(mesh.patches[p].name)] = array(faces[p]);
  return patches;
}

void save(const RegionBodyMesh& made, const std::filesystem::path& file) {
  static const std::map<std::string, void (*)(const std::filesystem::path&, const SolverMesh&)> writers = {
      {".vtu", write_vtu},
      {".msh", [](const std::filesystem::path& p, const SolverMesh& m) { write_msh41(p, m, MshEncoding::Binary); }},
      {".mesh", write_medit},
      {".inp", write_inp},
      {".bdf", write_nastran},
      {".feb", write_feb},
      {".cdb", write_cdb}};
  const auto writer = writers.find(file.extension().string());
  if (writer == writers.end())
    throw std::invalid_argument(file.string() + ": .vtu, .msh, .mesh, .inp, .bdf, .feb and .cdb are written");
  const py::gil_scoped_release no_gil;
  writer->second(file, solver_mesh_of(made));
}

}  // namespace

void bind_regions(py::module_& m) {
  py::class_<RegionBodyMesh>(m, "RegionsMesh")
      .def_property_readonly("points", [](const RegionBodyMesh& a) { return array(a.mesh.mesh.V, Vec3::Zero()); })
      .def_property_readonly("tets", [](const RegionBodyMesh& a) { return array(a.mesh.mesh.C); })
      .def_property_readonly("region", [](const RegionBodyMesh& a) { return array(a.mesh.region); })
      .def_readonly("names", &RegionBodyMesh::names)
      .def_readonly("h", &RegionBodyMesh::h)
      .def_property_readonly("certificate", [](const RegionBodyMesh& a) { return dict_of(document_of_regions(a)); })
      .def("patches", &patches_of)
      .def("save", &save);
  m.def("mesh_regions", &mesh_regions);
}

}  // namespace umtet::python
