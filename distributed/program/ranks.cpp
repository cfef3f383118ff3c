#include "distributed/program/ranks.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/body.h"
#include "distributed/exchange/phase.h"
#include "distributed/program/besides_mesh.h"
#include "distributed/program/freed_memory.h"
#include "distributed/program/rank_command.h"
#include "distributed/program/same_call.h"
#include "distributed/program/shared_level_set.h"
#include "distributed/program/together.h"
#include "pipeline/case/memory.h"

namespace umtet {
namespace {

// Phases in which rank 0 works alone: with psi, with the boundary, and after files that all ranks write.
constexpr const char *kPsi = "alone_psi", *kMeasures = "alone_measures", *kFiles = "alone_files";

struct NextPhase {
  const char* name;
  ~NextPhase() { begin_phase(name); }
};

/// Returns whether the common levels of both are identical: the same coefficients in memory.
bool begin_alike(const LevelSet& a, const LevelSet& b) {
  bool same = &a.coarsest() == &b.coarsest();
  for (int level = 1; same && level < std::min(a.n_levels(), b.n_levels()); ++level)
    same = &a.band(level) == &b.band(level);
  return same;
}

}  // namespace

/// Does collective work on rank 0.
/// @param then  name of the following phase, in which rank 0 works alone
template <class F>
auto Ranks::with_all(const char* then, const F& work) const {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads_));
  const NextPhase next{then};
  return together(comm_, work);
}

class Ranks::Handle final : public WrittenInParts {
 public:
  Handle(Ranks& ranks, std::int64_t mesh) : ranks_(ranks), mesh_(mesh) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  std::int64_t number() const { return mesh_; }
  ~Handle() override {
    say(ranks_.comm_, {RankOrder::Drop, mesh_});
    ranks_.held_.erase(mesh_);
  }
  CurvedInParts curve(const Domain& domain, const ClosestPointParams& params) const override {
    say(ranks_.comm_, {RankOrder::Curve, mesh_});
    const ImplicitFunctionRef psi = domain.psi();
    return ranks_.with_all(kMeasures, [&] { return ranks_.held_.at(mesh_).curve(psi, params); });
  }
  void write(const std::filesystem::path& file, MeshState state, bool moving_alone,
             const BoundaryData& data) const override {
    say(ranks_.comm_, {RankOrder::Write, mesh_, static_cast<std::int64_t>(state), moving_alone ? 1 : 0},
        {file.string()});
    ranks_.with_all(kFiles, [&] { ranks_.held_.at(mesh_).write(file, state, moving_alone, data); });
  }
  void write_quality(const std::filesystem::path& file) const override {
    say(ranks_.comm_, {RankOrder::WriteQuality, mesh_}, {file.string()});
    ranks_.with_all(kFiles, [&] { ranks_.held_.at(mesh_).write_quality(file); });
  }
  std::vector<std::filesystem::path> write_pieces(const std::filesystem::path& file, PieceFormat format,
                                                  const PieceData* data) const override {
    RankCommand command{RankOrder::WritePieces, mesh_, static_cast<std::int64_t>(format)};
    command.has_data = data ? 1 : 0;
    say(ranks_.comm_, command, {file.string()});
    return ranks_.with_all(kFiles, [&] { return ranks_.held_.at(mesh_).write_pieces(file, format, data); });
  }

 private:
  Ranks& ranks_;
  std::int64_t mesh_;
};

int Ranks::n() const {
  int n = 1;
  MPI_Comm_size(comm_, &n);
  return n;
}

/// Sends psi to the other ranks, unless they have it. Only rank 0 holds the bands that h does not resolve; if a smaller
/// h requires them, psi is sent again. `shared_` does not contain the last band of a fit. It is not needed for the
/// comparison, because there is only one band for the levels before it.
void Ranks::share(const LevelSet& psi) {
  const bool is_there = shared_ && psi.n_levels() <= n_shared_ && begin_alike(*shared_, psi);
  if (is_there && psi.n_levels() == n_shared_) return;
  RankCommand command{is_there ? RankOrder::CutLevelSet : RankOrder::LevelSet};
  command.spacing = psi.spacing();
  say(comm_, command);
  shared_ = is_there ? psi : with_all(kPsi, [&] { return shared_level_set(comm_, psi); });
  n_shared_ = psi.n_levels();
}

void Ranks::take(int level, const Lattice& lattice, int half_width, std::vector<SsdSample> samples) {
  say(comm_, {RankOrder::TakeSamples, 0, level});
  bands_.insert_or_assign(level,
                          with_all(kPsi, [&] { return band_part(comm_, lattice, half_width, std::move(samples)); }));
}

LevelSet Ranks::refine(const LevelSet& psi, double kappa, double tolerance, int max_iterations,
                       const std::function<void(double)>& go_on, BandReport& report) {
  share(psi);
  RankCommand command{RankOrder::Refine};
  command.kappa = kappa;
  command.tolerance = tolerance;
  command.max_iterations = max_iterations;
  say(comm_, command);
  BandPart part = std::move(bands_.extract(psi.n_levels()).mapped());
  // An exception of go_on(), in particular after a signal, does not end all ranks at once. It is rethrown, as in one
  // process, when the other ranks have finished.
  std::exception_ptr thrown;
  const auto go_on_together = [&](double residual) {
    if (thrown) return;
    try {
      go_on(residual);
    } catch (...) {
      thrown = std::current_exception();
    }
  };
  LevelSet finer = with_all(
      kPsi, [&] { return refine_parts(comm_, psi, std::move(part), command.refine_params(), go_on_together, report); });
  n_shared_ = finer.n_levels();
  if (thrown) std::rethrow_exception(thrown);
  return finer;
}

void Ranks::tell(const Domain& domain) {
  RankCommand command{RankOrder::Domain};
  command.is_fitted = domain.fitted.has_value();
  command.has_t = t_.has_value();
  command.t = t_.value_or(0);
  command.set_box(domain.box);
  say(comm_, command);
  const std::string difference = with_all(kPsi, [&] { return difference_of_calls(comm_, call_()); });
  if (!difference.empty()) throw CallsDiffer(difference);
}

void Ranks::forget_domain(std::optional<double> t) {
  has_told_ = false;
  t_ = t;
}

std::optional<MadeInParts> Ranks::make(const BackgroundMesh& background, const Box& box, const Domain& domain,
                                       const FastParams& params, const std::vector<Vec3>& seeds,
                                       const RoundedPlaces& places) {
  if (domain.fitted) share(*domain.level_set);
  if (!std::exchange(has_told_, true)) tell(domain);
  RankCommand command{RankOrder::Make, next_++};
  command.lattice_h = background.h();
  command.set_box(box);
  command.set_places(places);
  say(comm_, command, {{}, seeds});
  const ImplicitFunctionRef psi = domain.psi();
  std::optional<MadeInParts> made = with_all(kMeasures, [&]() -> std::optional<MadeInParts> {
    const double held = bytes_besides_mesh(domain, places.h);
    const auto at = held_.try_emplace(command.mesh, comm_, background, psi, params, seeds, places, held).first;
    if (!at->second.is_made()) return std::nullopt;
    MadeInParts summary = at->second.summary(psi);
    give_back_freed_memory();
    return summary;
  });
  // Created after the collective work, because its destructor tells the other ranks to drop the mesh, even if there is
  // none.
  auto handle = std::make_shared<const Handle>(*this, command.mesh);
  if (made) made->mesh = std::move(handle);
  return made;
}

double Ranks::allowed_bytes(const Parameters& parameters) const {
  give_back_freed_memory();                                                     // freed memory would count as used
  const double of_one = parameters.output().max_memory > 0 ? 1 : 1. / n_here_;  // ranks share a machine
  return of_one * n() * umtet::allowed_bytes(parameters);
}

TakenMesh Ranks::release(const MeshInParts& mesh) {
  const std::int64_t number = dynamic_cast<const Handle&>(mesh).number();
  say(comm_, {RankOrder::Release, number});
  return std::move(held_.at(number)).release();
}

void Ranks::end(int code) { say(comm_, {RankOrder::End, code}); }

int n_ranks_here(MPI_Comm comm) {
  int n = 1;
  MPI_Comm here = MPI_COMM_NULL;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  MPI_Comm_size(here, &n);
  MPI_Comm_free(&here);
  return n;
}

}  // namespace umtet
