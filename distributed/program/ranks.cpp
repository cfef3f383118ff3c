#include "distributed/program/ranks.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "distributed/collect.h"
#include "distributed/io/shared_file.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/domain/background_choice.h"
#include "pipeline/meshing/library_params.h"

namespace umtet {
namespace {

enum class Order : std::int64_t { Make, Write, WriteQuality, Drop, End };

/// What rank 0 says.
struct Command {
  Order order = Order::End;
  std::int64_t mesh = 0;   ///< its number; of the end the exit code
  std::int64_t state = 0;  ///< a MeshState
  std::int64_t moving_alone = 0;
  double lattice_h = 0, h = 0, shift[3] = {}, rounding = 0;

  RoundedPlaces places() const { return {h, Vec3(shift[0], shift[1], shift[2]), rounding}; }
};

/// @param text  a file
void say(MPI_Comm comm, Command& command, std::string& text) {
  MPI_Bcast(&command, sizeof command, MPI_BYTE, 0, comm);
  std::vector<char> bytes(text.begin(), text.end());
  broadcast(comm, bytes);
  text.assign(bytes.begin(), bytes.end());
}

/// What goes wrong on one rank, while others wait for it, ends all: with its reason and its exit code.
template <class F>
auto together(MPI_Comm comm, const F& work) {
  try {
    return work();
  } catch (const KnownToAll&) {
    throw;
  } catch (...) {
    const Failure failure = failure_of(std::current_exception());
    std::fprintf(stderr, "umtet: rank %d: %s\n", rank_in(comm), failure.message.c_str());
    std::fflush(stderr);
    MPI_Abort(comm, static_cast<int>(failure.code));
    throw;  // not reached
  }
}

/// A rank other than 0.
class Server {
 public:
  Server(MPI_Comm comm, const std::function<RankInput()>& input) : comm_(comm), input_(input) {}

  int operator()() {
    for (;;) {
      Command command;
      std::string file;
      say(comm_, command, file);
      if (command.order == Order::End) return static_cast<int>(command.mesh);
      try {
        together(comm_, [&] { obey(command, file); });
      } catch (const KnownToAll&) {
        // Rank 0 says it.
      }
    }
  }

 private:
  void obey(const Command& command, const std::string& file);

  MPI_Comm comm_;
  const std::function<RankInput()>& input_;
  std::optional<RankInput> have_;
  std::optional<UmParams> params_;
  std::map<std::int64_t, HeldMesh> held_;
};

void Server::obey(const Command& command, const std::string& file) {
  if (command.order == Order::Make) {
    if (!have_) {
      have_.emplace(input_());
      params_ = um_params(have_->parameters);
    }
    have_->domain.limit_detail(command.lattice_h);
    const BackgroundMesh background(tiling_of(have_->parameters), have_->domain.box, command.lattice_h);
    const ImplicitFunctionRef psi = have_->domain.psi();
    const auto at = held_.try_emplace(command.mesh, comm_, background, psi, params_->fast, command.places()).first;
    if (at->second.is_made()) at->second.summary(psi);
    return;
  }
  const auto at = held_.find(command.mesh);
  if (command.order == Order::Write)
    at->second.write(file, static_cast<MeshState>(command.state), command.moving_alone != 0);
  if (command.order == Order::WriteQuality) at->second.write_quality(file);
  if (command.order == Order::Drop) held_.erase(at);
}

}  // namespace

class Ranks::Handle final : public MeshInParts {
 public:
  Handle(Ranks& ranks, std::int64_t mesh) : ranks_(ranks), mesh_(mesh) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() override {
    Command command{Order::Drop, mesh_};
    std::string no_file;
    say(ranks_.comm_, command, no_file);
    ranks_.held_.erase(mesh_);
  }
  void write(const std::filesystem::path& file, MeshState state, bool moving_alone) const override {
    Command command{Order::Write, mesh_, static_cast<std::int64_t>(state), moving_alone ? 1 : 0};
    std::string name = file.string();
    say(ranks_.comm_, command, name);
    together(ranks_.comm_, [&] { ranks_.held_.at(mesh_).write(file, state, moving_alone); });
  }
  void write_quality(const std::filesystem::path& file) const override {
    Command command{Order::WriteQuality, mesh_};
    std::string name = file.string();
    say(ranks_.comm_, command, name);
    together(ranks_.comm_, [&] { ranks_.held_.at(mesh_).write_quality(file); });
  }

 private:
  Ranks& ranks_;
  std::int64_t mesh_;
};

std::optional<MadeInParts> Ranks::make(const BackgroundMesh& background, ImplicitFunctionRef psi,
                                       const FastParams& params, const RoundedPlaces& places) {
  Command command{Order::Make, next_++, 0, 0, background.h(), places.h, {}, places.rounding};
  std::copy_n(places.shift.data(), 3, command.shift);
  std::string no_file;
  say(comm_, command, no_file);
  return together(comm_, [&]() -> std::optional<MadeInParts> {
    const auto at = held_.try_emplace(command.mesh, comm_, background, psi, params, places).first;
    auto handle = std::make_shared<const Handle>(*this, command.mesh);
    if (!at->second.is_made()) return std::nullopt;
    MadeInParts made = at->second.summary(psi);
    made.mesh = std::move(handle);
    return made;
  });
}

void Ranks::end(int code) {
  Command command{Order::End, code};
  std::string no_file;
  say(comm_, command, no_file);
}

int serve(MPI_Comm comm, const std::function<RankInput()>& input) { return Server(comm, input)(); }

}  // namespace umtet
