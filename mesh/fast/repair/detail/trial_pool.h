#pragma once

#include <cstddef>
#include <deque>
#include <mutex>
#include <vector>

#include "mesh/fast/repair/detail/flip_trials.h"

namespace umtet::detail {

/// A pool of FlipTrials, one per concurrent thread, each with its own copy of the classification. Every flip and every
/// target is passed to all of them, so the choice of instance does not affect results.
class TrialPool {
 public:
  /// Keeps references to its arguments. @param inside  is changed together with flip(), while no thread uses the pool
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

  /// The instance for the thread that changes the mesh, while no other thread uses the pool.
  FlipTrials& first() { return all_.front(); }

  /// Calls f(trials) with an instance that no other thread uses meanwhile. Thread-safe.
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
