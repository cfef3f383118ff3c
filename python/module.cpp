// umtet._core: the C++ behind umtet/__init__.py, which has the documentation.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>

#include "body/fidelity/measure.h"
#include "body/scan/cloud_preparation.h"
#include "body/scan/given_cloud.h"
#include "body/sizing/background_choice.h"
#include "mesh/background/a15_box.h"
#include "mesh/moving_mesh.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/option_words.h"
#include "pipeline/case/version.h"
#include "pipeline/domain/body_options.h"
#include "pipeline/domain/load_domain.h"
#include "pipeline/memory/mesh_object.h"
#include "pipeline/reports/certificate_json.h"
#include "pipeline/reports/defect_json.h"
#include "pipeline/reports/mesh_json.h"
#include "pipeline/stages/scan_source.h"
#include "pipeline/stages/stages.h"
#include "python/arguments.h"
#include "python/errors.h"
#include "python/interruptible.h"
#include "python/regions.h"
#include "reconstruct/io/level_set_io.h"
#include "reconstruct/io/point_cloud_io.h"

namespace py = pybind11;

namespace umtet::python {
namespace {

std::optional<Box> box_of(const Parameters& parameters) { return parse_box(parameters.mesh().box); }

MeshObject mesh(const py::object& psi, const Settings& settings, std::optional<double> t, const py::object& progress,
                int threads) {
  const Parameters parameters = parameters_of(settings);
  const bool of_grid = psi.is_none() && !parameters.mesh().level_set.empty();
  Psi p = of_grid ? Psi{nullptr, grid_domain(parameters), threads} : psi_of(psi, box_of(parameters), t, threads);
  const bool asks_python = p.function != nullptr;
  auto job = [p = std::move(p), parameters](const Watch& watch) mutable {
    MeshAttempt best = make_mesh(p.domain, parameters, watch);
    return mesh_object(std::move(p.domain), std::move(best), parameters);
  };
  if (!asks_python) return interruptible(progress, threads, std::move(job));
  const Watch watch = watch_of(progress);
  return in_arena(1, [&] { return job(watch); });
}

/// A UniversalMesh and its parameters.
struct Moving {
  Parameters parameters;
  Box box;
  UniversalMesh mesher;
  std::atomic<bool> at_work{false};

  explicit Moving(const Settings& settings)
      : parameters(walls_checked(parameters_of(settings))),
        box(wanted_box(parameters)),
        mesher(background(), um_params(parameters.mesh())) {}

  static Parameters walls_checked(Parameters parameters) {
    require_walls(parameters);
    return parameters;
  }
  static Box wanted_box(const Parameters& parameters) {
    if (const std::optional<Box> box = box_of(parameters)) return *box;
    throw std::invalid_argument("box is missing: (x0, y0, z0, x1, y1, z1) around all domains");
  }
  BackgroundMesh background() const {
    if (parameters.mesh().box_walls) return BackgroundMesh(a15_box(box, parameters.mesh().h));
    return {tiling_of(parameters.mesh()), box, parameters.mesh().h};
  }
};

py::tuple update(Moving& moving, const py::object& psi, std::optional<double> t, const std::optional<Points>& seeds,
                 bool certify, const py::object& progress, int threads) {
  Psi p = psi_of(psi, moving.box, t, threads);
  if (!p.domain.shift.isZero(0)) {
    throw std::invalid_argument(
        "psi: its cloud is far from the origin, and was moved to it for the fit; move the cloud before reconstruct()");
  }
  const double h = moving.mesher.background().h();
  p.domain.limit_detail(h);
  p.domain.complement = moving.parameters.mesh().complement;
  UpdateHints hints;
  if (seeds) hints.seeds = vectors(*seeds, "seeds");
  const Watch watch = watch_of(progress);
  if (moving.at_work.exchange(true)) throw std::invalid_argument("this UniversalMesh is at work in another call");
  const auto done = [](std::atomic<bool>* at_work) { *at_work = false; };
  const std::unique_ptr<std::atomic<bool>, decltype(done)> guard(&moving.at_work, done);
  MeshObject made{{}, {}, {}, h, {}};
  UmUpdate u = in_arena(p.threads, [&] {
    UmUpdate next = moving.mesher.update(p.domain.psi(), hints, context_of(watch));
    if (next.mesh.status != UmStatus::Success) throw failure(next.mesh, h, p.domain.shift);
    if (certify) made.certificate = certificate_of(p.domain, next.mesh, h, moving.parameters, watch);
    return next;
  });
  made.result = std::move(u.mesh);
  made.domain = without_psi(std::move(p.domain));
  py::dict changes;
  changes["vertices_entered"] = array(u.vertices_entered);
  changes["vertices_left"] = array(u.vertices_left);
  changes["vertices_moved"] = array(u.vertices_moved);
  changes["tets_entered"] = array(u.tets_entered);
  changes["tets_left"] = array(u.tets_left);
  return py::make_tuple(std::move(made), changes);
}

py::object certificate(const Points& points,
                       const py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>& tets,
                       const py::object& psi, const Settings& settings, std::optional<double> t, double h) {
  if (tets.ndim() != 2 || tets.shape(1) != 4) throw std::invalid_argument("tets must be an array (m, 4)");
  TetMesh given{vectors(points, "points"), std::vector<Tet>(static_cast<std::size_t>(tets.shape(0)))};
  const std::int64_t* i = tets.data();
  for (Tet& tet : given.C) {
    for (int& vertex : tet) {
      if (*i < 0 || *i >= points.shape(0)) throw std::invalid_argument("tets: an index is not in the range of points");
      vertex = static_cast<int>(*i++);
    }
  }
  const Parameters parameters = parameters_of(settings);
  CertificateInput input;
  input.mesh = &given;
  input.h = h;
  std::optional<Psi> p;
  if (!psi.is_none()) {
    Box box;
    for (const Vec3& x : given.V) box.extend(x);
    p.emplace(psi_of(psi, box, t, 0));
    if (h > 0) p->domain.limit_detail(h);
    for (Vec3& x : given.V) x -= p->domain.shift;
    input.psi = p->domain.psi();
  }
  const Watch watch = watch_of(py::none());
  input.context = polls_of(watch);
  const MeshMeasures measured = in_arena(
      p ? p->threads : 0, [&] { return measures_of(certify(input), p ? &p->domain : nullptr, input.context); });
  Json json = document_head(kVersion);
  json.update(to_json(measured.mesh));
  json["valid"] = measured.is_valid;
  json["places"] = p ? json_by_fields(measured.defects) : Json(nullptr);
  json.update(to_json(judge(measured, parameters.output())));
  // Points and tets contain no information about psi, or about its source.
  if (!p) json["fits_psi"] = json["fits_input"] = nullptr;
  return dict_of(json);
}

Reconstruction reconstruct_arrays(const Points& points, const std::optional<Points>& normals, const Settings& settings,
                                  const py::object& progress, int threads) {
  OrientedPointCloud cloud;
  cloud.points = vectors(points, "points");
  if (normals) cloud.normals = vectors(*normals, "normals");
  if (normals && cloud.normals.size() != cloud.points.size()) {
    throw std::invalid_argument("normals must be an array with one normal per point, or None");
  }
  CloudFile file = given_cloud(std::move(cloud));
  const Parameters parameters = parameters_of(settings);
  return interruptible(progress, threads, [file = std::move(file), parameters](const Watch& watch) mutable {
    return reconstruct(std::move(file), parameters, watch);
  });
}

/// Reconstructs a file that `umtet reconstruct` reads.
Reconstruction reconstruct_file(const std::filesystem::path& file, const Settings& settings, const py::object& progress,
                                int threads) {
  const Parameters parameters = parameters_of(settings);
  if (const std::string problem = problem_of_columns(parameters.cloud().columns); !problem.empty())
    throw UsageError("columns: " + problem);
  return interruptible(progress, threads, [file, parameters](const Watch& watch) {
    ScanSource source = read_source(*open_source(file), parameters, polls_of(watch));
    return reconstruct(std::move(source.cloud), parameters, watch);
  });
}

/// Returns psi, its gradients (order 1) or Hessians (order 2) at points, without the GIL.
py::array_t<double> evaluate(const Reconstruction& r, const Points& points, int order) {
  std::vector<Vec3> x = vectors(points, "points");
  const LevelSet& psi = r.psi;
  const auto n = static_cast<py::ssize_t>(x.size());
  std::vector<py::ssize_t> shape = {n};
  for (int k = 0; k < order; ++k) shape.push_back(3);
  py::array_t<double> out(shape);
  double* p = out.mutable_data();
  const py::gil_scoped_release no_gil;
  tbb::parallel_for(std::size_t{0}, x.size(), [&](std::size_t i) {
    const Vec3 y = x[i] - r.report.shift;
    if (order == 0) p[i] = psi.value(y);
    if (order == 1) Eigen::Map<Vec3>(p + 3 * i) = psi.gradient(y);
    if (order == 2) Eigen::Map<Mat3>(p + 9 * i) = psi.hessian(y);
  });
  return out;
}

}  // namespace

void bind(py::module_& m) {
  register_errors(m);
  py::module_::import("atexit").attr("register")(py::cpp_function([] {
    const py::gil_scoped_release no_gil;
    while (n_left_behind > 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }));
  m.attr("__version__") = kVersion;
  py::class_<Reconstruction>(m, "LevelSet")
      .def(
          "value", [](const Reconstruction& r, const Points& points) { return evaluate(r, points, 0); },
          py::arg("points"), "Returns psi (n,) at points (n, 3). Model units, negative inside.")
      .def(
          "gradient", [](const Reconstruction& r, const Points& points) { return evaluate(r, points, 1); },
          py::arg("points"), "Returns its gradients (n, 3).")
      .def(
          "hessian", [](const Reconstruction& r, const Points& points) { return evaluate(r, points, 2); },
          py::arg("points"), "Returns its Hessians (n, 3, 3).")
      .def_property_readonly("box",
                             [](const Reconstruction& r) {
                               const Box box = r.psi.domain();
                               return array(std::vector<Vec3>{box.min(), box.max()}, r.report.shift);
                             })
      .def_property_readonly("points", [](const Reconstruction& r) { return array(r.cloud.points, Vec3::Zero()); })
      .def_property_readonly("normals", [](const Reconstruction& r) { return array(r.cloud.normals, Vec3::Zero()); })
      .def_property_readonly("report",
                             [](const Reconstruction& r) {
                               const SsdReport& fit = r.report.fit;
                               return dict_of({{"n_points", fit.n_points},
                                               {"n_nodes", fit.n_nodes},
                                               {"spacing", fit.spacing},
                                               {"smoothing", fit.smoothing},
                                               {"noise", r.report.noise},
                                               {"reason", fit.reason},
                                               {"cloud_spacing", fit.cloud_spacing},
                                               {"rms_value", fit.rms_value},
                                               {"n_opposed_normals", fit.n_opposed_normals},
                                               {"notices", texts_of(r.notices, as_keyword)}});
                             })
      .def("save", [](const Reconstruction& r, const std::filesystem::path& file) {
        write_level_set(file, r.psi, r.report.shift);
      });
  py::class_<MeshObject>(m, "Mesh")
      .def_property_readonly("points", [](const MeshObject& a) { return array(a.nodes(), a.domain.shift); })
      .def_property_readonly(
          "tets",
          [](const MeshObject& a) { return a.second ? array(a.second->mesh.C) : array(a.result.submesh.mesh.C); })
      .def_property_readonly("boundary",
                             [](const MeshObject& a) {
                               return a.second ? array(a.curved_boundary()) : array(a.result.submesh.positive_faces);
                             })
      .def_property_readonly("walls", [](const MeshObject& a) { return array(a.result.walls); })
      .def_property_readonly("boundary_vertices", [](const MeshObject& a) { return array(a.boundary_nodes()); })
      .def_property_readonly("background_vertex", [](const MeshObject& a) { return array(a.background_vertices()); })
      .def_property_readonly("background_tet",
                             [](const MeshObject& a) { return array(a.result.submesh.background_tet); })
      .def_readonly("h", &MeshObject::h)
      .def_property_readonly("notices", [](const MeshObject& a) { return texts_of(a.domain.notices, as_keyword); })
      .def_property_readonly(
          "certificate", [](const MeshObject& a) { return dict_of(a.certificate ? to_json(*a.certificate) : Json()); })
      .def("patches",
           [](const MeshObject& a, const Settings& settings) {
             py::dict patches;
             for (const auto& [name, faces] : a.patches(parameters_of(settings))) {
               const py::ssize_t k = a.second ? 6 : 3;
               patches[py::str(name)] = array(faces).reshape({py::ssize_t{-1}, k});
             }
             return patches;
           })
      .def("save", [](const MeshObject& a, const std::filesystem::path& file) {
        const py::gil_scoped_release no_gil;
        a.save(file);
      });
  py::class_<Moving>(m, "Moving")
      .def(py::init<const Settings&>())
      .def_property_readonly("h", [](const Moving& a) { return a.mesher.background().h(); })
      .def_property_readonly("n_vertices", [](const Moving& a) { return a.mesher.background().n_vertices(); })
      .def("update", &update);
  bind_regions(m);
  m.def("mesh", &mesh);
  m.def("reconstruct", &reconstruct_arrays);
  m.def("reconstruct_file", &reconstruct_file);
  m.def("certificate", &certificate);
  m.def("parameters", [] {
    std::vector<std::string> keys;
    for (const ParamField& f : params_fields()) keys.push_back(f.key);
    return keys;
  });
}

}  // namespace umtet::python

PYBIND11_MODULE(_core, m) { umtet::python::bind(m); }
