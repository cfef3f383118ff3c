// How much of each phase one thread does alone: thread_bench CASE ..., a number of tets (1e6) or, with a p, of points
// (1e6p).
//
// Medians of five, in processes of their own: W1 seconds of one thread, W1' of one thread while N - 1 other processes
// do the same, which shows what the machine lacks (memory bandwidth, shared cores), and WN of N threads. If S of them
// are one thread's alone, WN = S + (W1' - S) / N (Amdahl's law), so S = (N WN - W1') / (N - 1). The last column is S as
// a share of all of W1'; the last row what the speed-up on 16 cores would be by the sum over phases of S + (W1' - S)
// / 16.

#include <oneapi/tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "body/scan/cloud_preparation.h"
#include "body/scan/level_set_fit.h"
#include "mesh/certify/certificate.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/sizes/body_size.h"
#include "mesh/universal_mesh.h"
#include "tests/support/bench_domains.h"
#include "tests/support/clouds.h"

using namespace umtet;

namespace {

constexpr int kRuns = 5;
constexpr double kManyCores = 16;

/// Seconds from each mark to the next.
class Phases {
 public:
  void begin(const std::string& name) {
    end();
    name_ = name;
    start_ = Clock::now();
  }
  void end() {
    if (name_.empty()) return;
    const std::chrono::duration<double> seconds = Clock::now() - start_;
    const auto at = std::find_if(all.begin(), all.end(), [&](const auto& p) { return p.first == name_; });
    at == all.end() ? all.emplace_back(name_, seconds.count()), void() : void(at->second += seconds.count());
    name_.clear();
  }
  std::vector<std::pair<std::string, double>> all;

 private:
  using Clock = std::chrono::steady_clock;
  std::string name_;
  Clock::time_point start_;
};

void mesh(const testing::AnalyticDomain& domain, ImplicitFunctionRef psi, double n_tets, Phases& phases) {
  const BackgroundMesh background(a15(), domain.box,
                                  h_for_tets(domain, domain.box, n_tets, ClassificationSource::Chosen));
  const Context context{.progress =
                            [&](const char* step, double part) {
                              if (part < 1 && std::string(step) != "submesh") phases.begin(step);
                            },
                        .cancelled = {}};
  UmResult result = universal_mesh(background, psi, {}, context);
  phases.begin("certificate");
  const MeshFile made{
      .mesh = {std::move(result.final), std::move(result.submesh.mesh.C)}, .point_data = {}, .cell_data = {}};
  CertificateInput input;
  input.mesh = &made.mesh;
  input.h = background.h();
  input.positive_faces = &result.submesh.positive_faces;
  input.psi = psi;
  certify(input);
  const auto file = std::filesystem::temp_directory_path() / ("threads_" + std::to_string(getpid()) + ".vtu");
  phases.begin("write");
  write_vtu(file, made);
  phases.end();
  std::filesystem::remove(file);
}

void fit(const OrientedPointCloud& cloud, Phases& phases) {
  const BodyOptions options;
  phases.begin("prepare");
  PreparedCloud prepared = prepare_cloud({cloud, {}}, "memory", options);
  phases.begin("noise");
  const Context context{.progress = [&](const char* step, double) { phases.begin(step); }, .cancelled = {}};
  fit_level_set(prepared.cloud, std::move(prepared.near), options, context);
  phases.end();
}

using Seconds = std::vector<std::pair<std::string, double>>;

/// Prints the median seconds of each phase.
void run(const std::string& text, int n_threads) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(n_threads));
  const double n = std::atof(text.c_str());
  std::vector<Phases> runs(kRuns);
  if (text.back() == 'p') {
    const OrientedPointCloud cloud = test::torus_cloud(static_cast<int>(n));
    for (Phases& phases : runs) fit(cloud, phases);
  } else {
    const testing::AnalyticDomain domain = testing::banchoff_chmutov_6();
    for (Phases& phases : runs) mesh(domain, domain, n, phases);
  }
  for (std::size_t p = 0; p < runs.front().all.size(); ++p) {
    std::vector<double> seconds;
    for (const Phases& phases : runs) seconds.push_back(phases.all.at(p).second);
    std::sort(seconds.begin(), seconds.end());
    std::printf("%s %.9g\n", runs.front().all[p].first.c_str(), seconds[kRuns / 2]);
  }
}

/// What so many processes print that run() at once: means of their medians.
Seconds of_processes(const std::string& program, const std::string& text, int n_processes, int n_threads) {
  const std::string command = program + " --threads " + std::to_string(n_threads) + " " + text;
  std::vector<FILE*> pipes;
  for (int k = 0; k < n_processes; ++k) pipes.push_back(popen(command.c_str(), "r"));
  Seconds all;
  for (FILE* pipe : pipes) {
    char name[64];
    double seconds = 0;
    for (std::size_t p = 0; std::fscanf(pipe, "%63s %lf", name, &seconds) == 2; ++p) {
      if (p == all.size()) all.emplace_back(name, 0);
      all[p].second += seconds / n_processes;
    }
    if (pclose(pipe) != 0 || all.empty()) throw std::runtime_error(command + ": failed");
  }
  return all;
}

void print(const std::string& program, const std::string& text, int n_threads) {
  const Seconds one = of_processes(program, text, 1, 1), beside = of_processes(program, text, n_threads, 1),
                many = of_processes(program, text, 1, n_threads);
  std::printf(
      "\n%s: seconds\n\n| phase | one thread | beside others | %d threads | serial | share |\n"
      "|---|---|---|---|---|---|\n",
      text.c_str(), n_threads);
  double all_one = 0, all_beside = 0, all_many = 0, all_alone = 0;
  for (const auto& [name, seconds] : one) all_one += seconds;
  for (const auto& [name, seconds] : beside) all_beside += seconds;
  for (std::size_t p = 0; p < one.size(); ++p) {
    const double w1 = beside.at(p).second, wn = many.at(p).second;
    const double alone = std::clamp((n_threads * wn - w1) / (n_threads - 1), 0., w1);
    all_many += wn, all_alone += alone;
    std::printf("| %s | %.3f | %.3f | %.3f | %.3f | %.1f %% |\n", one[p].first.c_str(), one[p].second, w1, wn, alone,
                100 * alone / all_beside);
  }
  const double at_16 = all_alone + (all_beside - all_alone) / kManyCores;
  std::printf("| all | %.3f | %.3f | %.3f: %.2f x | %.3f | %.1f %%: %.1f x on %g |\n", all_one, all_beside, all_many,
              all_one / all_many, all_alone, 100 * all_alone / all_beside, all_beside / at_16, kManyCores);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4 && std::string(argv[1]) == "--threads") {
    run(argv[3], std::atoi(argv[2]));
    return 0;
  }
  const int n_threads =
      std::max(2, static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)));
  for (int k = 1; k < argc; ++k) print(argv[0], argv[k], n_threads);
  return 0;
}
