// Measures what other values of the tunable parameters do to meshes.
//
//   sensitivity [--only TEXT] [--seed N] [--threads N] > data/constants/sensitivity.csv
//
// Each of 126 bodies (bodies.h) is meshed with the default parameters, and with each other value of each parameter, one
// at a time. A line of the table is a parameter, a value and a measure (fit.h): the mean with the defaults, the mean
// difference that the value makes, paired by body, with its 95 % confidence interval, the p of a sign-flip test, and
// what they say together:
//
//   as good  the interval lies within the tolerance of the measure
//   better, worse  the interval leaves out 0, p < .01 (hundreds of comparisons are made), the mean exceeds the
//   tolerance open     these bodies cannot tell
//
// Bodies without a mesh with either are left out of all measures but "failed". --seed takes other bodies, on which a
// finding can be checked; --only takes parameters whose name has the text in it. The same bytes for any number of
// threads.

#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tools/sensitivity/fit.h"
#include "tools/sensitivity/statistics.h"
#include "tools/sensitivity/tunables.h"

using namespace umtet;
using namespace umtet::sensitivity;

namespace {

constexpr double kSurely = .01;

struct Request {
  std::string only;
  std::uint64_t seed = 0;
  bool lists_bodies = false;
  std::size_t threads = std::thread::hardware_concurrency();
};

/// Calls f(k) for all bodies, each by one thread from its beginning to its end.
template <class F>
void for_each_body(std::size_t n, std::size_t n_threads, const F& f) {
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    tbb::task_arena(1).execute([&] {
      for (std::size_t k = next++; k < n; k = next++) f(k);
    });
  };
  std::vector<std::jthread> threads;
  for (std::size_t k = 1; k < n_threads; ++k) threads.emplace_back(work);
  work();
}

std::vector<Subject> subjects(const Request& request) {
  std::vector<Body> list = bodies(request.seed);
  std::vector<std::optional<Subject>> made(list.size());
  for_each_body(list.size(), request.threads, [&](std::size_t k) { made[k].emplace(subject(std::move(list[k]))); });
  std::vector<Subject> all;
  for (std::optional<Subject>& one : made) all.push_back(std::move(*one));
  return all;
}

std::vector<Measured> measure(const std::vector<Subject>& all, const Request& request, const Settings& settings,
                              bool is_moving) {
  std::vector<Measured> list(all.size());
  for_each_body(all.size(), request.threads,
                [&](std::size_t k) { list[k] = is_moving ? fit_moving(all[k], settings) : fit(all[k], settings); });
  return list;
}

const char* verdict(const MeasureKind& kind, const Paired& d) {
  if (std::abs(d.low) <= kind.tolerance && std::abs(d.high) <= kind.tolerance) return "as good";
  if (d.low * d.high <= 0 || d.p >= kSurely || std::abs(d.mean) < kind.tolerance) return "open";
  return (d.mean > 0) == kind.more_is_better ? "better" : "worse";
}

void print_row(const std::string& name, double value, double standard, std::size_t i, std::size_t n, double mean,
               const Paired& d) {
  const MeasureKind& kind = kMeasureKinds[i];
  std::printf("%s,%.6g,%.6g,%s%s,%zu,%.4g,%.3g,%.3g,%.3g,%.2g,%s\n", name.c_str(), value, standard,
              std::string(kind.name).c_str(), kind.in_percent ? "_percent" : "", n, mean, d.mean, d.low, d.high, d.p,
              verdict(kind, d));
}

void compare(const Tunable& tunable, double value, const std::vector<Measured>& standard,
             const std::vector<Measured>& other) {
  const double default_value = tunable.get({});
  for (std::size_t i = 0; i < kMeasures; ++i) {
    std::vector<double> differences;
    double sum = 0;
    bool is_zero = true;
    for (std::size_t k = 0; k < standard.size(); ++k) {
      const Measured &a = standard[k], &b = other[k];
      if (i != kFailed && (a[kFailed] != 0 || b[kFailed] != 0)) continue;
      is_zero &= a[i] == 0 && b[i] == 0;
      sum += a[i];
      differences.push_back(kMeasureKinds[i].in_percent && a[i] != 0 ? 100 * (b[i] / a[i] - 1) : b[i] - a[i]);
    }
    const std::size_t n = differences.size();
    if (n == 0 || (is_zero && i != kFailed)) continue;  // not measured here
    print_row(tunable.name, value, default_value, i, n, sum / static_cast<double>(n), paired(differences));
  }
}

/// What the defaults make of each body.
void print_bodies(const std::vector<Subject>& all, const std::vector<Measured>& measured) {
  std::printf("body");
  for (const MeasureKind& kind : kMeasureKinds) std::printf(",%s", std::string(kind.name).c_str());
  for (std::size_t k = 0; k < all.size(); ++k) {
    std::printf("\n%s", all[k].body.name.c_str());
    for (const double value : measured[k]) std::printf(",%.5g", value);
  }
  std::printf("\n");
}

Request request_of(int argc, char** argv) {
  Request request;
  for (int i = 1; i < argc; i += 2) {
    const bool has_value = i + 1 < argc;
    if (std::strcmp(argv[i], "--bodies") == 0) {
      request.lists_bodies = true;
      --i;
    } else if (has_value && std::strcmp(argv[i], "--only") == 0) {
      request.only = argv[i + 1];
    } else if (has_value && std::strcmp(argv[i], "--seed") == 0) {
      request.seed = std::strtoull(argv[i + 1], nullptr, 10);
    } else if (has_value && std::strcmp(argv[i], "--threads") == 0) {
      request.threads = std::strtoull(argv[i + 1], nullptr, 10);
    } else {
      std::fprintf(stderr, "usage: sensitivity [--bodies] [--only TEXT] [--seed N] [--threads N] > TABLE.csv\n");
      std::exit(2);
    }
  }
  return request;
}

}  // namespace

int main(int argc, char** argv) {
  const Request request = request_of(argc, argv);
  const std::vector<Subject> all = subjects(request);
  std::vector<char> same(all.size());
  for_each_body(all.size(), request.threads, [&](std::size_t k) { same[k] = is_fast_mesh(all[k], {}); });
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (same[k] != 0) continue;
    std::fprintf(stderr, "sensitivity: %s is not meshed as fast_mesh() does: fit() is out of date\n",
                 all[k].body.name.c_str());
    return 1;
  }
  if (request.lists_bodies) {
    print_bodies(all, measure(all, request, {}, false));
    return 0;
  }
  std::optional<std::vector<Measured>> standard[2];
  std::printf("parameter,value,default,measure,bodies,with default,difference,low,high,p,verdict\n");
  for (const Tunable& tunable : tunables()) {
    if (tunable.name.find(request.only) == std::string::npos) continue;
    auto& of_default = standard[tunable.is_of_moving];
    if (!of_default) of_default = measure(all, request, {}, tunable.is_of_moving);
    for (const double value : tunable.values) {
      Settings settings;
      tunable.set(settings, value);
      compare(tunable, value, *of_default, measure(all, request, settings, tunable.is_of_moving));
      std::fflush(stdout);
      std::fprintf(stderr, "%s = %g\n", tunable.name.c_str(), value);
    }
  }
  return 0;
}
