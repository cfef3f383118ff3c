// umtet_swimmer -o FOLDER simulates the swimmer of [Rangarajan2018, Section 4.3] over one stroke: 17 instants with two
// Stokes flows each, on meshes that are parts of one universal mesh of the channel.
//
//   umtet_swimmer -o stroke                            300 000 tets, some minutes
//   umtet_swimmer -o quick --tets 40000 --steps 4      seconds
//
// FOLDER contains swimmer.csv, swimmer.svg, swimmer.pvd, fields/NNN.vtu. Exit codes are the exit codes of umtet; 6 is
// also returned if no flow is found.

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "examples/swimmer/channel_mesher.h"
#include "examples/swimmer/swim_files.h"

namespace umtet {
namespace {

struct Call {
  std::string folder;
  double n_tets = 300000;
  bool fields = true;
  int threads = tbb::info::default_concurrency();
  SwimParams swim;
};

void complain(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stderr); }

void run(const Call& call) {
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin = Clock::now();
  const SwimFiles files(call.folder);
  const ChannelMesher mesher(call.n_tets);
  complain(fmt::format("channel: {} tets, edges of {:.3f}\n{:>7} {:>9} {:>9} {:>7} {:>8} {:>6}\n", mesher.tets().size(),
                       mesher.background().h(), "t", "z0'", "z0", "min Q", "tets", "s"));
  std::vector<SwimRow> rows;
  swim(mesher.n_vertices(), mesher.tets(), mesher, call.swim,
       [&](const SwimStep& step, const FluidMesh& fluid, const ForceFreeMotion& motion) {
         if (call.fields) files.write_fields(rows.size(), fluid, mesher.tets(), motion);
         const Clock::time_point end = Clock::now();
         rows.push_back({step, min_quality(fluid, mesher.tets()), fluid.tets.size(), fluid.volume_gap,
                         std::chrono::duration<double>(end - begin).count()});
         begin = end;
         files.write_tables(rows, call.fields);
         const SwimRow& row = rows.back();
         complain(fmt::format("{:7.3f} {:9.5f} {:9.5f} {:7.3f} {:8} {:6.1f}\n", step.t, step.velocity, step.z0,
                              row.min_quality, row.n_tets, row.seconds));
         stop_if_interrupted();
         return true;
       });
}

int run_program(int argc, char** argv) {
  Call call;
  CLI::App app{"The swimmer of Rangarajan, Kabaria & Lew (2018), Section 4.3"};
  app.add_option("-o,--output", call.folder, "folder for swimmer.csv, swimmer.svg, swimmer.pvd and fields/")
      ->required();
  app.add_option("--tets", call.n_tets, "approximate number of tets of the channel")
      ->check(CLI::Range(1e4, 2e7))
      ->capture_default_str();
  app.add_option("--steps", call.swim.steps, "number of forward Euler steps")
      ->check(CLI::Range(1, 999))
      ->capture_default_str();
  app.add_option("--dt", call.swim.dt, "time of a step")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--t0", call.swim.t0, "first instant; a stroke is -8 to 8")->capture_default_str();
  app.add_option("--threads", call.threads)->check(CLI::Range(1, 1024))->capture_default_str();
  app.add_flag("!--no-fields", call.fields, "leave out the .vtu files and swimmer.pvd");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::Usage);
  }
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(call.threads));
  try {
    run(call);
  } catch (const StokesError& error) {
    complain(fmt::format("umtet_swimmer: {}\n", error.what()));
    return static_cast<int>(ExitCode::GateFailed);
  } catch (...) {
    const Failure failure = failure_of(std::current_exception());
    complain(fmt::format("umtet_swimmer: {}\n", failure.message));
    return static_cast<int>(failure.code);
  }
  return 0;
}

}  // namespace
}  // namespace umtet

int main(int argc, char** argv) {
  umtet::install_signal_handlers();
  return umtet::run_program(argc, argv);
}
