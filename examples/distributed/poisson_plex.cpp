// -Laplace u = 1 in a ball, u = 0 on its boundary, by PETSc on the mesh of several processes: each gives DMPlex the
// tets that it has, and nobody has the whole mesh.
//
//     mpirun -n 4 build/mpi/examples/poisson_plex [H [SOLUTION]]
//
// The first process prints the largest error at a vertex: u = (1 - r^2) / 6. SOLUTION gets u, doubles by the numbers of
// vertices in the whole mesh, which are the same for any number of processes.

#include <petscdmplex.h>
#include <petscksp.h>
#include <petscsf.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <vector>

#include "distributed/exchange/collect.h"
#include "distributed/mesh/distributed_mesh.h"
#include "distributed/solver/solver_part.h"
#include "mesh/background/background_mesh.h"

namespace {

using namespace umtet;

struct Ball {
  double value(const Vec3& x) const { return x.squaredNorm() - 1; }
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
    if (gradient) *gradient = 2 * x;
    if (hessian) *hessian = 2 * Mat3::Identity();
    return value(x);
  }
};

/// The tets as PETSc has them. DMPlex wants vertices numbered by one process after the other: solver_vertex.
struct Plex {
  DM dm = nullptr;
  PetscInt first = 0;       ///< point of the first vertex
  std::vector<int> vertex;  ///< of the own part, of each point from there on
};

/// The own vertices in the order that DMPlex has given them: each is said to be the k-th that some rank owns.
PetscErrorCode name_vertices(const SolverPart& part, PetscInt n_owned, PetscSF sf, Plex* plex) {
  PetscFunctionBeginUser;
  int n_ranks = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &n_ranks);
  std::vector<PetscInt> owned(static_cast<std::size_t>(n_ranks)), first(1, 0);
  MPI_Allgather(&n_owned, 1, MPIU_INT, owned.data(), 1, MPIU_INT, PETSC_COMM_WORLD);
  for (const PetscInt n : owned) first.push_back(first.back() + n);
  std::map<std::int64_t, int> by_number;
  for (std::size_t v = 0; v < part.solver_vertex.size(); ++v) by_number[part.solver_vertex[v]] = static_cast<int>(v);
  PetscInt n_vertices = 0;
  const PetscSFNode* places = nullptr;
  PetscCall(PetscSFGetGraph(sf, nullptr, &n_vertices, nullptr, &places));
  for (PetscInt k = 0; k < n_vertices; ++k)
    plex->vertex.push_back(by_number.at(first[static_cast<std::size_t>(places[k].rank)] + places[k].index));
  PetscFunctionReturn(0);
}

PetscErrorCode make_plex(const DistributedMesh& mesh, const SolverPart& part, Plex* plex) {
  PetscFunctionBeginUser;
  std::vector<PetscInt> cells;
  std::vector<PetscReal> places;
  for (const Tet& t : mesh.mesh.C)
    for (const int v : t) cells.push_back(static_cast<PetscInt>(part.solver_vertex[v]));
  for (std::size_t v = 0; v < part.owner.size(); ++v) {
    if (part.owner[v] == rank_in(PETSC_COMM_WORLD))
      places.insert(places.end(), mesh.mesh.V[v].data(), mesh.mesh.V[v].data() + 3);
  }
  const auto n_cells = static_cast<PetscInt>(mesh.mesh.C.size()), n_owned = static_cast<PetscInt>(places.size() / 3);
  PetscSF vertices = nullptr;
  PetscInt last = 0;
  PetscCall(DMPlexCreateFromCellListParallelPetsc(PETSC_COMM_WORLD, 3, n_cells, n_owned,
                                                  static_cast<PetscInt>(part.n_vertices), 4, PETSC_TRUE, cells.data(),
                                                  3, places.data(), &vertices, nullptr, &plex->dm));
  PetscCall(DMPlexGetDepthStratum(plex->dm, 0, &plex->first, &last));
  PetscCall(name_vertices(part, n_owned, vertices, plex));
  PetscCall(PetscSFDestroy(&vertices));
  PetscFunctionReturn(0);
}

/// One number at each vertex, given on the boundary.
PetscErrorCode number_unknowns(const Plex& plex, const SolverPart& part) {
  PetscFunctionBeginUser;
  std::vector<char> is_on_boundary(part.owner.size(), 0);
  for (const int v : part.boundary_vertices) is_on_boundary[v] = 1;
  PetscSection section = nullptr;
  const PetscInt n = static_cast<PetscInt>(plex.vertex.size()), zero = 0;
  PetscCall(PetscSectionCreate(PETSC_COMM_WORLD, &section));
  PetscCall(PetscSectionSetChart(section, 0, plex.first + n));  // PETSc 3.18 reads beyond one that begins elsewhere
  for (PetscInt k = 0; k < n; ++k) {
    PetscCall(PetscSectionSetDof(section, plex.first + k, 1));
    if (is_on_boundary[plex.vertex[k]]) PetscCall(PetscSectionSetConstraintDof(section, plex.first + k, 1));
  }
  PetscCall(PetscSectionSetUp(section));
  for (PetscInt k = 0; k < n; ++k)
    if (is_on_boundary[plex.vertex[k]]) PetscCall(PetscSectionSetConstraintIndices(section, plex.first + k, &zero));
  PetscCall(DMSetLocalSection(plex.dm, section));
  PetscCall(PetscSectionDestroy(&section));
  PetscFunctionReturn(0);
}

/// Integrals of grad phi_i . grad phi_j and of phi_i over each tet.
PetscErrorCode assemble(const Plex& plex, Mat A, Vec b) {
  PetscFunctionBeginUser;
  PetscInt begin = 0, end = 0;
  Vec places = nullptr, local = nullptr;
  PetscSection of_places = nullptr;
  PetscCall(DMGetCoordinatesLocal(plex.dm, &places));
  PetscCall(DMGetCoordinateSection(plex.dm, &of_places));
  PetscCall(DMGetLocalVector(plex.dm, &local));
  PetscCall(VecSet(local, 0));
  PetscCall(DMPlexGetHeightStratum(plex.dm, 0, &begin, &end));
  for (PetscInt c = begin; c < end; ++c) {
    PetscScalar* x = nullptr;
    PetscInt n = 0;
    PetscCall(DMPlexVecGetClosure(plex.dm, of_places, places, c, &n, &x));
    const Eigen::Map<const Eigen::Matrix<double, 3, 4>> corners(x);
    Eigen::Matrix4d barycentric;  // of a point (1, x): its inverse holds the gradients
    barycentric << Eigen::RowVector4d::Ones(), corners;
    const double volume = std::abs(barycentric.determinant()) / 6;
    const Eigen::Matrix<double, 4, 3> gradients = barycentric.inverse().rightCols<3>();
    const Eigen::Matrix4d stiffness = volume * gradients * gradients.transpose();
    const Eigen::Vector4d load = Eigen::Vector4d::Constant(volume / 4);
    PetscCall(DMPlexVecRestoreClosure(plex.dm, of_places, places, c, &n, &x));
    PetscCall(DMPlexMatSetClosure(plex.dm, nullptr, nullptr, A, c, stiffness.data(), ADD_VALUES));
    PetscCall(DMPlexVecSetClosure(plex.dm, nullptr, local, c, load.data(), ADD_VALUES));
  }
  PetscCall(VecSet(b, 0));
  PetscCall(DMLocalToGlobal(plex.dm, local, ADD_VALUES, b));
  PetscCall(DMRestoreLocalVector(plex.dm, &local));
  PetscCall(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

/// u at the vertices of the own part, by a direct solver.
PetscErrorCode solve(const Plex& plex, std::vector<double>* u) {
  PetscFunctionBeginUser;
  Mat A = nullptr;
  Vec b = nullptr, x = nullptr, local = nullptr;
  KSP ksp = nullptr;
  PC pc = nullptr;
  PetscCall(DMCreateMatrix(plex.dm, &A));
  PetscCall(DMCreateGlobalVector(plex.dm, &b));
  PetscCall(VecDuplicate(b, &x));
  PetscCall(assemble(plex, A, b));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &ksp));
  PetscCall(KSPSetOperators(ksp, A, A));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCLU));
  PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  PetscCall(KSPSetFromOptions(ksp));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(DMGetLocalVector(plex.dm, &local));
  PetscCall(VecSet(local, 0));  // the boundary
  PetscCall(DMGlobalToLocal(plex.dm, x, INSERT_VALUES, local));
  const PetscScalar* values = nullptr;
  PetscCall(VecGetArrayRead(local, &values));
  for (std::size_t k = 0; k < plex.vertex.size(); ++k) (*u)[plex.vertex[k]] = values[k];
  PetscCall(VecRestoreArrayRead(local, &values));
  PetscCall(DMRestoreLocalVector(plex.dm, &local));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&b));
  PetscCall(MatDestroy(&A));
  PetscFunctionReturn(0);
}

struct Value {
  std::int64_t vertex;
  double u, error;
};

void say(const DistributedMesh& mesh, const SolverPart& part, const std::vector<double>& u, const char* file) {
  std::vector<Value> values;
  for (std::size_t v = 0; v < u.size(); ++v)
    values.push_back({part.global_vertex[v], u[v], std::abs(u[v] - (1 - mesh.mesh.V[v].squaredNorm()) / 6)});
  values = gathered(PETSC_COMM_WORLD, values);
  if (rank_in(PETSC_COMM_WORLD) != 0) return;
  std::vector<double> solution(part.n_vertices);
  double error = 0;
  for (const Value& value : values) {
    solution[static_cast<std::size_t>(value.vertex)] = value.u;
    error = std::max(error, value.error);
  }
  std::printf("%zu tets; largest error %.2e\n", part.n_tets, error);
  if (file)
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(solution.data()),
               static_cast<std::streamsize>(sizeof(double) * solution.size()));
}

PetscErrorCode run(double h, const char* file) {
  PetscFunctionBeginUser;
  const BackgroundMesh background(a15(), Box(Vec3::Constant(-1.3), Vec3::Constant(1.3)), h);
  const DistributedMesh mesh = distributed_mesh(PETSC_COMM_WORLD, background, Ball{});
  PetscCheck(mesh.status == PartsStatus::Success, PETSC_COMM_WORLD, PETSC_ERR_ARG_OUTOFRANGE, "no mesh at this h");
  const SolverPart part = solver_part(PETSC_COMM_WORLD, mesh);
  Plex plex;
  PetscCall(make_plex(mesh, part, &plex));
  PetscCall(number_unknowns(plex, part));
  std::vector<double> u(mesh.mesh.V.size(), 0);
  PetscCall(solve(plex, &u));
  say(mesh, part, u, file);
  PetscCall(DMDestroy(&plex.dm));
  PetscFunctionReturn(0);
}

}  // namespace

int main(int argc, char** argv) {
  PetscCall(PetscInitialize(&argc, &argv, nullptr, nullptr));
  PetscCall(run(argc > 1 ? std::atof(argv[1]) : .1, argc > 2 ? argv[2] : nullptr));
  PetscCall(PetscFinalize());
  return 0;
}
