// umtet._distributed: the C++ code of umtet.mesh(comm=...), which umtet/_parts.py documents. It is a separate module so
// that umtet does not require MPI. Exceptions and LevelSet are defined in umtet._core.

#include <mpi.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <tbb/info.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/body.h"
#include "body/option_names.h"
#include "distributed/exchange/collect.h"
#include "distributed/mesh/vertex_owners.h"
#include "distributed/program/ranks.h"
#include "distributed/program/serve.h"
#include "distributed/program/together.h"
#include "distributed/solver/curved_solver_part.h"
#include "distributed/solver/solver_part.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/domain/load_domain.h"
#include "pipeline/memory/jobs.h"
#include "pipeline/reports/certificate_json.h"
#include "python/arguments.h"

namespace py = pybind11;

namespace umtet::python {
namespace {

/// A copy of a communicator of mpi4py, given by its number in Fortran. A copy keeps messages of umtet separate from
/// messages of the user.
class Communicator {
 public:
  explicit Communicator(int number) { MPI_Comm_dup(MPI_Comm_f2c(static_cast<MPI_Fint>(number)), &comm_); }
  ~Communicator() { MPI_Comm_free(&comm_); }
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;
  operator MPI_Comm() const { return comm_; }

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
};

/// The arguments of the call in Python.
struct Request {
  py::object psi;
  Settings settings;
  std::optional<double> t;
  int threads;
};

/// Nodes are vertices and, for second order, mid-sides.
struct MeshPart {
  TakenMesh taken;
  SolverPart part;
  std::optional<CurvedSolverPart> curved;  ///< for second order
  double h = 0;
  std::string certificate;  ///< JSON
};

bool is_of_grid(const Request& request, const Parameters& parameters) {
  return request.psi.is_none() && !parameters.mesh().level_set.empty();
}

/// \throw UsageError for a mesh that only one process can make
void require_ranks(const Parameters& parameters) {
  if (const std::optional<Message> reason = for_one_process(parameters))
    throw UsageError(*reason + " is for one process: several of them mesh in a lattice without walls");
}

Psi psi_asked_for(const Request& request, const Parameters& parameters, int threads) {
  if (is_of_grid(request, parameters)) return {nullptr, grid_domain(parameters), threads};
  return psi_of(request.psi, parse_box(parameters.mesh().box), request.t, threads);
}

/// The ranks on a machine share its processors; only the calling thread evaluates a callable.
int threads_of(int n_here, const Request& request) {
  if (PyCallable_Check(request.psi.ptr()) != 0) return 1;
  return request.threads > 0 ? request.threads : std::max(1, tbb::info::default_concurrency() / n_here);
}

Json parameters_of_mesh(const Parameters& parameters) { return parameters.section("mesh"); }

/// Makes the mesh on rank 0.
MeshPart make(MPI_Comm comm, const Request& request, const py::object& progress) {
  const int n_here = n_ranks_here(comm), threads = threads_of(n_here, request);
  std::optional<Parameters> parameters;
  Ranks ranks(comm, n_here, [&] { return parameters_of_mesh(*parameters); });
  MeshPart made;
  try {
    parameters = parameters_of(request.settings);
    require_ranks(*parameters);
    ranks.set_threads(threads);
    Psi psi = psi_asked_for(request, *parameters, threads);
    const Watch watch = watch_of(progress);
    in_arena(threads, [&] {
      MeshAttempt best = make_mesh(psi.domain, *parameters, watch, &ranks);
      if (!best.parts) {
        throw UsageError({Setting(option::background, "a15"),
                          " is needed: where edges follow the body, one process makes the mesh"});
      }
      made.taken = ranks.release(*best.parts);
      made.h = best.h;
      made.certificate = to_json(verdict_on(std::move(best.measured), *parameters)).dump();
    });
  } catch (...) {
    ranks.end(static_cast<int>(ExitCode::Bug));
    throw;
  }
  ranks.end(0);
  return made;
}

/// Helps rank 0 on the other ranks. @return empty if rank 0 has thrown
std::optional<MeshPart> help(MPI_Comm comm, const Request& request) {
  const int threads = threads_of(n_ranks_here(comm), request);
  std::shared_ptr<Function> function;
  const auto parameters = [&] { return parameters_of(request.settings); };
  const auto domain = [&] {
    const py::gil_scoped_acquire gil;
    Psi psi = psi_asked_for(request, parameters(), threads);
    function = std::move(psi.function);
    return std::move(psi.domain);
  };
  std::optional<TakenMesh> taken;
  const int code = in_arena(threads, [&] { return serve(comm, parameters, domain, &taken); });
  if (code != 0 || !taken) return std::nullopt;
  return MeshPart{std::move(*taken), {}, std::nullopt, 0, ""};
}

/// Computes the numbering for solvers. Collective.
void add_numbers(MPI_Comm comm, MeshPart& a) {
  const DistributedMesh& mesh = a.taken.mesh;
  const VertexOwners owners(comm, mesh);
  a.part = solver_part(comm, mesh, owners);
  if (a.taken.curved)
    a.curved = curved_solver_part(comm, mesh, owners, a.taken.curved->edges, a.taken.curved->parts, a.part);
}

std::optional<MeshPart> mesh(int number, const py::object& psi, const Settings& settings, std::optional<double> t,
                             const py::object& progress, int threads) {
  const Communicator comm(number);
  const Request request{psi, settings, t, threads};
  std::optional<MeshPart> made;
  if (rank_in(comm) == 0) {
    made = make(comm, request, progress);
  } else {
    made = help(comm, request);
    if (!made) return std::nullopt;
  }
  const py::gil_scoped_release no_gil;
  together(comm, [&] {
    add_numbers(comm, *made);
    MPI_Bcast(&made->h, 1, MPI_DOUBLE, 0, comm);
    std::vector<char> text(made->certificate.begin(), made->certificate.end());
    broadcast(comm, text);
    made->certificate.assign(text.begin(), text.end());
  });
  return made;
}

const std::vector<Vec3>& points(const MeshPart& a) {
  return a.taken.curved ? a.taken.curved->parts.mesh.V : a.taken.mesh.mesh.V;
}

py::array_t<int> tets(const MeshPart& a) {
  return a.taken.curved ? array(a.taken.curved->parts.mesh.C) : array(a.taken.mesh.mesh.C);
}

/// Background ids of the nodes; -1 for mid-sides.
std::vector<std::int64_t> background_vertices(const MeshPart& a) {
  std::vector<std::int64_t> ids = a.taken.mesh.background_vertex;
  ids.resize(points(a).size(), -1);
  return ids;
}

/// For each other rank, the nodes that it also has, in the order of their numbers in the whole mesh, which is the same
/// on both ranks.
py::dict shared(const MeshPart& a) {
  std::map<int, std::vector<int>> by_rank;
  const Sharers& s = a.curved ? a.curved->sharers : a.part.sharers;
  for (std::size_t k = 0; k < s.vertex.size(); ++k)
    for (std::size_t i = s.begin[k]; i < s.begin[k + 1]; ++i) by_rank[s.rank[i]].push_back(s.vertex[k]);
  py::dict result;
  for (const auto& [rank, nodes] : by_rank) result[py::int_(rank)] = array(nodes);
  return result;
}

template <class Face>
py::dict by_patch(const SolverPart& part, const std::vector<Face>& faces) {
  py::dict result;
  for (std::size_t p = 0; p < part.patches.size(); ++p) {
    std::vector<Face> some;
    for (std::size_t f = 0; f < faces.size(); ++f)
      if (part.patch[f] == static_cast<int>(p)) some.push_back(faces[f]);
    result[py::str(part.patches[p])] = array(some);
  }
  return result;
}

}  // namespace

void bind(py::module_& m) {
  using A = const MeshPart&;
  py::class_<MeshPart>(m, "MeshPart")
      .def_property_readonly("points", [](A a) { return array(points(a), Vec3::Zero()); })
      .def_property_readonly("tets", &tets)
      .def_property_readonly("boundary",
                             [](A a) { return a.curved ? array(a.curved->boundary) : array(a.part.boundary); })
      .def_property_readonly("boundary_vertices",
                             [](A a) { return array(a.curved ? a.curved->boundary_nodes : a.part.boundary_vertices); })
      .def_property_readonly("global_vertex",
                             [](A a) { return array(a.curved ? a.curved->global_node : a.part.global_vertex); })
      .def_property_readonly("global_tet", [](A a) { return array(a.part.global_tet); })
      .def_property_readonly("global_face", [](A a) { return array(a.part.global_face); })
      .def_property_readonly("solver_vertex",
                             [](A a) { return array(a.curved ? a.curved->solver_node : a.part.solver_vertex); })
      .def_property_readonly("owner", [](A a) { return array(a.curved ? a.curved->owner : a.part.owner); })
      .def_property_readonly("background_vertex", [](A a) { return array(background_vertices(a)); })
      .def_property_readonly("background_tet", [](A a) { return array(a.taken.mesh.background_tet); })
      .def_property_readonly("n_vertices", [](A a) { return a.curved ? a.curved->n_nodes : a.part.n_vertices; })
      .def_property_readonly("n_tets", [](A a) { return a.part.n_tets; })
      .def_readonly("h", &MeshPart::h)
      .def_property_readonly("certificate",
                             [](A a) { return py::module_::import("json").attr("loads")(a.certificate); })
      .def_property_readonly("shared", &shared)
      .def_property_readonly("patches", [](A a) {
        return a.curved ? by_patch(a.part, a.curved->boundary) : by_patch(a.part, a.part.boundary);
      });
  m.def("mesh", &mesh);
}

}  // namespace umtet::python

PYBIND11_MODULE(_distributed, m) { umtet::python::bind(m); }
