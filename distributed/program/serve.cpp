#include "distributed/program/serve.h"

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "body/sizing/background_choice.h"
#include "distributed/exchange/phase.h"
#include "distributed/fit/part_refine.h"
#include "distributed/io/shared_file.h"
#include "distributed/program/held_mesh.h"
#include "distributed/program/rank_command.h"
#include "distributed/program/same_call.h"
#include "distributed/program/shared_level_set.h"
#include "distributed/program/together.h"
#include "pipeline/domain/load_domain.h"

namespace umtet {
namespace {

/// A rank other than 0.
class Server {
 public:
  Server(MPI_Comm comm, const std::function<Parameters()>& parameters, const std::function<Domain()>& domain,
         std::optional<TakenMesh>* taken)
      : comm_(comm), ask_parameters_(parameters), ask_domain_(domain), taken_(taken) {}

  int operator()() {
    for (;;) {
      begin_phase("wait");
      const Heard heard = hear(comm_);
      if (heard.command.order == RankOrder::End) return static_cast<int>(heard.command.mesh);
      try {
        together(comm_, [&] { obey(heard.command, heard.attached); });
      } catch (const KnownToAll&) {
        // Rank 0 prints the message.
      }
    }
  }

 private:
  void obey(const RankCommand& command, const Attached& attached);
  const Parameters& parameters();
  void take_samples(int level);
  void refine(const RankCommand& command);
  void take_level_set(const RankCommand& command);
  void take_domain(const RankCommand& command);
  void make(const RankCommand& command, const std::vector<Vec3>& seeds);

  MPI_Comm comm_;
  const std::function<Parameters()>& ask_parameters_;
  const std::function<Domain()>& ask_domain_;
  std::optional<TakenMesh>* taken_;
  std::optional<Parameters> parameters_;
  std::map<int, BandPart> bands_;  ///< bands to be refined
  std::optional<LevelSet> psi_;    ///< psi with the levels that h resolves
  Domain domain_;
  bool is_fitted_ = false;  ///< psi is fitted to samples: the level set of domain_ is psi_
  std::map<std::int64_t, HeldMesh> held_;
};

void Server::obey(const RankCommand& command, const Attached& attached) {
  const auto at = held_.find(command.mesh);
  const PieceData none;  // only rank 0 has data
  switch (command.order) {
    case RankOrder::LevelSet:
    case RankOrder::CutLevelSet:
      return take_level_set(command);
    case RankOrder::TakeSamples:
      return take_samples(static_cast<int>(command.state));
    case RankOrder::Refine:
      return refine(command);
    case RankOrder::Domain:
      return take_domain(command);
    case RankOrder::Make:
      return make(command, attached.seeds);
    case RankOrder::Curve:
      at->second.curve(domain_.psi(), um_params(parameters().mesh()).paper.closest_point);
      return;
    case RankOrder::Write:
      // Files do not need it, and psi is not evaluated between them.
      if (psi_) psi_->forget_below(std::numeric_limits<double>::infinity());
      return at->second.write(attached.file, static_cast<MeshState>(command.state), command.moving_alone != 0, {});
    case RankOrder::WriteQuality:
      return at->second.write_quality(attached.file);
    case RankOrder::WritePieces:
      at->second.write_pieces(attached.file, static_cast<PieceFormat>(command.state),
                              command.has_data ? &none : nullptr);
      return;
    case RankOrder::Release:
      taken_->emplace(std::move(at->second).release());
      return;
    case RankOrder::Drop:
      held_.erase(at);
      return;
    case RankOrder::End:
      return;  // operator() handles it before
  }
}

const Parameters& Server::parameters() {
  if (!parameters_) parameters_ = ask_parameters_();
  return *parameters_;
}

void Server::take_samples(int level) {
  parameters();  // also sets the number of threads
  bands_.insert_or_assign(level, band_part(comm_, {}, 0, {}));
}

void Server::refine(const RankCommand& command) {
  BandReport of_rank_0;
  BandPart part = std::move(bands_.extract(psi_->n_levels()).mapped());
  psi_ = refine_parts(
      comm_, *psi_, std::move(part), command.refine_params(), [](double) {}, of_rank_0);
}

void Server::take_level_set(const RankCommand& command) {
  domain_.level_set.reset();
  if (command.order == RankOrder::CutLevelSet) {
    psi_ = psi_->band_limited(command.spacing);
  } else {
    psi_.reset();
    psi_ = shared_level_set(comm_, std::nullopt);
  }
}

void Server::take_domain(const RankCommand& command) {
  if (!difference_of_calls(comm_, parameters().section("mesh")).empty()) return;  // rank 0 prints the message
  if (!command.is_fitted) {
    domain_ = ask_domain_     ? ask_domain_()
              : command.has_t ? formula_domain(parameters(), command.t)
                              : load_domain(CasePaths(), parameters());
    return;
  }
  is_fitted_ = true;
  domain_.box = command.given_box();
}

void Server::make(const RankCommand& command, const std::vector<Vec3>& seeds) {
  if (is_fitted_) domain_.level_set = psi_;
  const BackgroundMesh background(tiling_of(parameters().mesh()), command.given_box(), command.lattice_h);
  const UmParams params = um_params(parameters().mesh());
  const ImplicitFunctionRef psi = domain_.psi();
  const auto at = held_.try_emplace(command.mesh, comm_, background, psi, params.fast, seeds, command.places()).first;
  if (at->second.is_made()) at->second.summary(psi);
}

}  // namespace

int serve(MPI_Comm comm, const std::function<Parameters()>& parameters, const std::function<Domain()>& domain,
          std::optional<TakenMesh>* taken) {
  return Server(comm, parameters, domain, taken)();
}

}  // namespace umtet
