#pragma once

#include <cstddef>
#include <deque>
#include <mutex>
#include <vector>

#include "mesh/fast/detail/flip_trials.h"

namespace umtet::detail {

/// FlipTrials for as many threads as ask for one at a time: each has its own copy of the classification. All are told
/// of every flip and of every target, so that it does not matter which of them is taken.
class TrialPool {
 public:
  /// Keeps what it is given by reference. @param inside  is changed together with flip(), while no thread asks
  TrialPool(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
            const ClassificationParams& classification, const RepairParams& params, const Positions& positions,
            const IdSet& inside)
      : background_(background),
        links_(links),
        psi_(psi),
        classification_(classification),
        params_(params),
        positions_(positions),
        inside_(inside),
        target_(params.target) {
    free_.push_back(add());
  }

  /// For the thread that changes the mesh, while no other one asks.
  FlipTrials& first() { return all_.front(); }

  /// f(trials), with trials that no other thread has meanwhile. Thread-safe.
  template <class F>
  auto with_one(const F& f) {
    const Borrowed borrowed(*this);
    return f(*borrowed.trials);
  }

  void flip(std::int64_t v) {
    for (FlipTrials& trials : all_) trials.flip(v);
  }
  void retry_with(double target, const FlipEffort& effort) {
    target_ = target, effort_ = effort;
    for (FlipTrials& trials : all_) trials.retry_with(target, effort);
  }
  std::size_t tries() const { return sum(&FlipTrials::tries); }
  std::size_t psi_evaluations() const { return sum(&FlipTrials::psi_evaluations); }

 private:
  struct Borrowed {
    explicit Borrowed(TrialPool& from) : pool(from), trials(from.take()) {}
    ~Borrowed() { pool.give_back(trials); }
    Borrowed(const Borrowed&) = delete;
    Borrowed& operator=(const Borrowed&) = delete;
    TrialPool& pool;
    FlipTrials* trials;
  };

  FlipTrials* add() {
    FlipTrials& made = all_.emplace_back(background_, links_, psi_, classification_, params_, positions_, inside_);
    made.retry_with(target_, effort_);
    return &made;
  }
  FlipTrials* take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (free_.empty()) return add();
    FlipTrials* trials = free_.back();
    free_.pop_back();
    return trials;
  }
  void give_back(FlipTrials* trials) {
    const std::lock_guard<std::mutex> lock(mutex_);
    free_.push_back(trials);
  }
  std::size_t sum(std::size_t FlipTrials::*count) const {
    std::size_t n = 0;
    for (const FlipTrials& trials : all_) n += trials.*count;
    return n;
  }

  const BackgroundMesh& background_;
  const VertexLinks& links_;
  ImplicitFunctionRef psi_;
  const ClassificationParams& classification_;
  const RepairParams& params_;
  const Positions& positions_;
  const IdSet& inside_;
  double target_;
  FlipEffort effort_;
  std::mutex mutex_;
  std::deque<FlipTrials> all_;
  std::vector<FlipTrials*> free_;
};

}  // namespace umtet::detail
