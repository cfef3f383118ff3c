#include "examples/swimmer/saddle_point_solver.h"

#include <fmt/format.h>
#include <petscksp.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace umtet {
namespace {

static_assert(sizeof(PetscInt) == sizeof(int) && sizeof(PetscScalar) == sizeof(double), "PETSc with int and double");

void check(PetscErrorCode code) {
  if (!code) return;
  const char* text = nullptr;
  PetscErrorMessage(code, &text, nullptr);
  throw StokesError(fmt::format("PETSc: error {} ({})", int(code), text ? text : "no text"));
}

/// Starts PETSc for this process, without its signal handlers, its file of options and its messages.
void start_petsc() {
  struct Session {
    Session() {
      static char program[] = "umtet", no_file[] = "-skip_petscrc", no_handler[] = "-no_signal_handler";
      std::array<char*, 4> words{program, no_file, no_handler, nullptr};
      int n = 3;
      char** arguments = words.data();
      check(PetscInitialize(&n, &arguments, nullptr, nullptr));
      PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
    }
    ~Session() { PetscFinalize(); }
  };
  static const Session session;
}

/// Computes the sorted rows of neighbours in the graph that connects all nodes of a tet.
void neighbour_rows(int n, std::span<const Tet> tets, std::vector<int>& row, std::vector<int>& column) {
  std::vector<int> first(std::size_t(n) + 1, 0), tet_of(4 * tets.size());
  for (const Tet& K : tets) {
    for (const int i : K) ++first[std::size_t(i) + 1];
  }
  for (std::size_t i = 0; i < std::size_t(n); ++i) first[i + 1] += first[i];
  std::vector<int> next(first.begin(), first.end() - 1);
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (const int i : tets[t]) tet_of[std::size_t(next[std::size_t(i)]++)] = int(t);
  }
  row.assign(1, 0);
  column.clear();
  std::vector<int> near;
  for (int i = 0; i < n; ++i) {
    near.assign(1, i);
    for (int k = first[std::size_t(i)]; k < first[std::size_t(i) + 1]; ++k) {
      const Tet& K = tets[std::size_t(tet_of[std::size_t(k)])];
      near.insert(near.end(), K.begin(), K.end());
    }
    std::sort(near.begin(), near.end());
    column.insert(column.end(), near.begin(), std::unique(near.begin(), near.end()));
    row.push_back(int(column.size()));
  }
}

}  // namespace

struct SaddlePointSolver::Petsc {
  Mat K = nullptr, stiffness = nullptr;
  KSP krylov = nullptr;
  PC amg = nullptr;
  PetscOptions options = nullptr;
  Vec b = nullptr, x = nullptr, part = nullptr, solved = nullptr;
  const SaddlePointSolver* owner = nullptr;

  ~Petsc() {
    KSPDestroy(&krylov);
    PCDestroy(&amg);
    PetscOptionsDestroy(&options);
    for (Vec* v : {&b, &x, &part, &solved}) VecDestroy(v);
    MatDestroy(&K);
    MatDestroy(&stiffness);
  }

  void make_krylov_solver() {
    check(PetscOptionsCreate(&options));  // for three-dimensional problems, as recommended by hypre's manual
    check(PetscOptionsInsertString(options,
                                   "-pc_hypre_boomeramg_coarsen_type HMIS -pc_hypre_boomeramg_interp_type ext+i "
                                   "-pc_hypre_boomeramg_P_max 4"));
    check(PCCreate(PETSC_COMM_SELF, &amg));
    check(PCSetType(amg, PCHYPRE));
    check(PCHYPRESetType(amg, "boomeramg"));
    check(PetscObjectSetOptions(reinterpret_cast<PetscObject>(amg), options));
    check(PCSetFromOptions(amg));
    check(KSPCreate(PETSC_COMM_SELF, &krylov));
    check(KSPSetType(krylov, KSPMINRES));
    PC pc = nullptr;
    check(KSPGetPC(krylov, &pc));
    check(PCSetType(pc, PCSHELL));
    check(PCShellSetContext(pc, this));
    check(PCShellSetApply(pc, &Petsc::precondition));
  }

  static PetscErrorCode multiply(Mat K, Vec x, Vec y) {
    void* self = nullptr;
    if (const PetscErrorCode code = MatShellGetContext(K, &self)) return code;
    const double* from = nullptr;
    double* to = nullptr;
    if (const PetscErrorCode code = VecGetArrayRead(x, &from)) return code;
    if (const PetscErrorCode code = VecGetArrayWrite(y, &to)) return code;
    static_cast<Petsc*>(self)->owner->multiply(from, to);
    VecRestoreArrayWrite(y, &to);
    return VecRestoreArrayRead(x, &from);
  }

  static PetscErrorCode precondition(PC pc, Vec r, Vec z) {
    void* self = nullptr;
    if (const PetscErrorCode code = PCShellGetContext(pc, &self)) return code;
    return static_cast<Petsc*>(self)->precondition(r, z);
  }

  /// z = diag(amg, amg, amg, 1 / pressure_weight) r
  PetscErrorCode precondition(Vec r, Vec z) {
    const std::vector<double>& weight = owner->pressure_weight_;
    const std::size_t n = weight.size();
    const double* from = nullptr;
    double* to = nullptr;
    if (const PetscErrorCode code = VecGetArrayRead(r, &from)) return code;
    if (const PetscErrorCode code = VecGetArrayWrite(z, &to)) return code;
    for (std::size_t c = 0; c < 3; ++c) {
      double* in = nullptr;
      if (const PetscErrorCode code = VecGetArrayWrite(part, &in)) return code;
      for (std::size_t i = 0; i < n; ++i) in[i] = from[4 * i + c];
      VecRestoreArrayWrite(part, &in);
      if (const PetscErrorCode code = PCApply(amg, part, solved)) return code;
      const double* out = nullptr;
      if (const PetscErrorCode code = VecGetArrayRead(solved, &out)) return code;
      for (std::size_t i = 0; i < n; ++i) to[4 * i + c] = out[i];
      VecRestoreArrayRead(solved, &out);
    }
    for (std::size_t i = 0; i < n; ++i) to[4 * i + 3] = from[4 * i + 3] / weight[i];
    VecRestoreArrayWrite(z, &to);
    return VecRestoreArrayRead(r, &from);
  }
};

SaddlePointSolver::SaddlePointSolver(int n_nodes, std::span<const Tet> tets) {
  start_petsc();
  neighbour_rows(n_nodes, tets, row_, column_);
  blocks_.resize(16 * column_.size());
  stiffness_.resize(column_.size());
  pressure_weight_.resize(std::size_t(n_nodes));

  petsc_ = std::make_unique<Petsc>();
  Petsc& P = *petsc_;
  P.owner = this;
  check(MatCreateShell(PETSC_COMM_SELF, 4 * n_nodes, 4 * n_nodes, 4 * n_nodes, 4 * n_nodes, &P, &P.K));
  check(MatShellSetOperation(P.K, MATOP_MULT, reinterpret_cast<void (*)()>(&Petsc::multiply)));
  check(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n_nodes, n_nodes, row_.data(), column_.data(), stiffness_.data(),
                                  &P.stiffness));
  check(MatSetOption(P.K, MAT_SYMMETRIC, PETSC_TRUE));
  check(VecCreateSeq(PETSC_COMM_SELF, 4 * n_nodes, &P.b));
  check(VecDuplicate(P.b, &P.x));
  check(VecCreateSeq(PETSC_COMM_SELF, n_nodes, &P.part));
  check(VecDuplicate(P.part, &P.solved));
  P.make_krylov_solver();
}

SaddlePointSolver::~SaddlePointSolver() = default;

std::size_t SaddlePointSolver::at(int i, int j) const {
  const auto begin = column_.begin() + row_[std::size_t(i)], end = column_.begin() + row_[std::size_t(i) + 1];
  return std::size_t(std::lower_bound(begin, end, j) - column_.begin());
}

void SaddlePointSolver::multiply(const double* x, double* y) const {
  constexpr std::size_t kGrain = 2048;  // rows, some 100 microseconds: less work does not justify waking a thread
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, row_.size() - 1, kGrain), [&](const auto& rows) {
    for (std::size_t i = rows.begin(); i < rows.end(); ++i) {
      Eigen::Vector4d sum = Eigen::Vector4d::Zero();
      for (std::size_t k = std::size_t(row_[i]); k < std::size_t(row_[i + 1]); ++k) {
        sum +=
            Eigen::Map<const Eigen::Matrix4d>(&blocks_[16 * k]) * Eigen::Map<const Eigen::Vector4d>(x + 4 * column_[k]);
      }
      Eigen::Map<Eigen::Vector4d>(y + 4 * i) = sum;
    }
  });
}

void SaddlePointSolver::clear() {
  std::fill(blocks_.begin(), blocks_.end(), 0.);
  std::fill(stiffness_.begin(), stiffness_.end(), 0.);
  std::fill(pressure_weight_.begin(), pressure_weight_.end(), 0.);
}

void SaddlePointSolver::set_up() {
  Petsc& P = *petsc_;
  for (Mat A : {P.K, P.stiffness}) {  // tells PETSc that the arrays have changed
    check(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  }
  check(PCSetOperators(P.amg, P.stiffness, P.stiffness));
  check(PCSetUp(P.amg));
  check(KSPSetOperators(P.krylov, P.K, P.K));
}

KrylovReport SaddlePointSolver::solve(std::span<const double> b, std::span<double> x, double tolerance,
                                      int max_iterations) {
  Petsc& P = *petsc_;
  check(KSPSetTolerances(P.krylov, tolerance, PETSC_DEFAULT, PETSC_DEFAULT, max_iterations));
  std::vector<double> history(std::size_t(max_iterations) + 2);
  check(KSPSetResidualHistory(P.krylov, history.data(), PetscInt(history.size()), PETSC_TRUE));
  check(VecPlaceArray(P.b, b.data()));
  check(VecPlaceArray(P.x, x.data()));
  const PetscErrorCode code = KSPSolve(P.krylov, P.b, P.x);
  VecResetArray(P.b);
  VecResetArray(P.x);
  check(code);
  KSPConvergedReason reason{};
  KrylovReport report;
  PetscInt n_history = 0;
  check(KSPGetConvergedReason(P.krylov, &reason));
  check(KSPGetIterationNumber(P.krylov, &report.iterations));
  check(KSPGetResidualHistory(P.krylov, nullptr, &n_history));
  check(KSPSetResidualHistory(P.krylov, nullptr, 0, PETSC_TRUE));
  if (n_history && history[0] > 0) report.residual = history[std::size_t(n_history) - 1] / history[0];
  if (reason < 0) {
    throw StokesError(fmt::format("MINRES: {} after {} iterations with {} unknowns; relative residual {:.3g}",
                                  KSPConvergedReasons[reason], report.iterations, b.size(), report.residual));
  }
  return report;
}

}  // namespace umtet
