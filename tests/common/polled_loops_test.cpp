#include "common/polled_loops.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

namespace umtet {
namespace {

TEST(PolledLoops, ReachEveryValueOnceAndPollFromTheCallingThreadOnly) {
  constexpr std::size_t kValues = 100'000, kPerPoll = 100;
  for (const std::size_t threads : {1, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    std::size_t n_polls = 0;
    const std::thread::id caller = std::this_thread::get_id();
    const Context context{.cancelled = [&] {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      return ++n_polls == 0;
    }};
    std::vector<int> visits(kValues);
    polled_parallel_for(kValues, kPerPoll, context, [&](std::size_t i) { ++visits[i]; });
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), static_cast<std::ptrdiff_t>(kValues)) << threads;
    EXPECT_GE(n_polls, threads == 1 ? kValues / kPerPoll : 1);
    const auto sum = polled_parallel_sum<std::uint64_t>(7, kValues, 64, kPerPoll, context,
                                                        [](std::size_t i, std::uint64_t& s) { s += i; });
    EXPECT_EQ(sum, std::uint64_t{kValues} * (kValues - 1) / 2 - 21) << threads;
  }
}

TEST(PolledLoops, EndForAllThreadsWhenTheCallerIsTold) {
  constexpr std::size_t kValues = 1'000'000'000;  // a thousandth takes a busy machine's time slices many times over
  constexpr std::chrono::seconds kPatience{1};    // on one processor there may be no other thread
  for (const std::size_t threads : {1, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    for (const int after : {1, 2}) {  // before the loop, and within it
      int n_polls = 0;
      std::atomic<std::size_t> n_visits = 0;
      const auto others_have_begun = [&] { return n_visits > 0 || threads == 1 || n_polls == 1; };
      const Context told{.cancelled = [&] {
        if (++n_polls < after) return false;
        const auto end = std::chrono::steady_clock::now() + kPatience;
        while (!others_have_begun() && std::chrono::steady_clock::now() < end) std::this_thread::yield();
        return true;
      }};
      const auto visit = [&](std::size_t) {
        ++n_visits;
        std::this_thread::yield();
      };
      EXPECT_THROW(polled_parallel_for(kValues, 1, told, visit), Cancelled);
      EXPECT_EQ(n_polls, after);
      EXPECT_LT(n_visits, kValues / 1000) << threads;  // less than the others had begun
    }
  }
}

TEST(PolledLoops, PollOnceWhereThereIsNothingToDo) {
  int n_polls = 0;
  const Context context{.cancelled = [&] { return ++n_polls, false; }};
  polled_parallel_for(0, 1, context, [](std::size_t) { FAIL(); });
  EXPECT_EQ(polled_parallel_sum<int>(5, 5, 1, 1, context, [](std::size_t, int& s) { ++s; }), 0);
  EXPECT_EQ(n_polls, 2);
}

}  // namespace
}  // namespace umtet
