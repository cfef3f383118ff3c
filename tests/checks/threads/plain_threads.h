#pragma once

// The part of oneTBB that the libraries use, on std::thread: ThreadSanitizer sees every step of it, and nothing of
// Debian's libtbb, whose every hand-over of work would be a race to it. For the preset tsan only: it is slow, and what
// is called from a task runs in that task's thread. The preset hides the configuration of the real one
// (__TBB_detail__config_H), so that a header of it that has no stand-in here does not compile.

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <iterator>
#include <list>
#include <memory>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <utility>
#include <vector>

namespace tbb {

namespace plain {

inline std::atomic<std::size_t> limit{4};  ///< more than this machine may have: races are looked for, not speed
inline thread_local bool in_task = false;
inline thread_local const std::atomic<bool>* ends = nullptr;  ///< of the call whose task this thread runs

/// run(k) for every k < n, by threads of which the calling one is the first. Each has its share beforehand: on a busy
/// machine the first would take all of it, and what one thread does is no race. What has not begun when a task throws
/// is left undone. \throw what the first of these threads has thrown, when all have ended
template <class F>
void run_all(std::size_t n, const F& run) {
  const std::size_t n_threads = in_task ? 1 : std::min(n, limit.load());
  if (n_threads <= 1) {
    for (std::size_t k = 0; k < n; ++k) run(k);
    return;
  }
  std::atomic<bool> end{false};
  std::vector<std::exception_ptr> errors(n_threads);
  const auto share = [&](std::size_t t) {
    in_task = true;
    ends = &end;
    try {
      for (std::size_t k = t; k < n && !end; k += n_threads) run(k);
    } catch (...) {
      errors[t] = std::current_exception();
      end = true;
    }
    in_task = false;
    ends = nullptr;
  };
  std::vector<std::thread> threads;
  for (std::size_t t = 1; t < n_threads; ++t) threads.emplace_back(share, t);
  share(0);
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace plain

inline bool is_current_task_group_canceling() { return plain::ends != nullptr && *plain::ends; }

template <class T>
class blocked_range {
 public:
  using const_iterator = T;
  blocked_range(T begin, T end, std::size_t grain = 1) : begin_(begin), end_(end), grain_(grain) {}
  T begin() const { return begin_; }
  T end() const { return end_; }
  std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }
  bool empty() const { return !(begin_ < end_); }
  std::size_t grainsize() const { return grain_; }

 private:
  T begin_, end_;
  std::size_t grain_;
};

template <class T, class F>
void parallel_for(const blocked_range<T>& range, const F& f) {
  // At most some tasks a thread: more would only be more to start.
  const std::size_t n = range.empty() ? 0 : range.size(), step = std::max({range.grainsize(), n / 32, std::size_t{1}});
  plain::run_all((n + step - 1) / step, [&](std::size_t k) {
    f(blocked_range<T>(static_cast<T>(range.begin() + k * step),
                       static_cast<T>(range.begin() + std::min(n, (k + 1) * step)), range.grainsize()));
  });
}

template <class I, class J, class F>
void parallel_for(I first, J last, const F& f) {
  parallel_for(blocked_range<I>(first, static_cast<I>(last)), [&](const blocked_range<I>& range) {
    for (I i = range.begin(); i < range.end(); ++i) f(i);
  });
}

struct simple_partitioner {};

template <class I, class J, class F>
void parallel_for(I first, J last, const F& f, simple_partitioner) {
  parallel_for(first, last, f);
}

template <class T, class Value, class F, class Join>
Value parallel_reduce(const blocked_range<T>& range, const Value& identity, const F& f, const Join& join) {
  const std::size_t n = range.empty() ? 0 : range.size(), step = std::max({range.grainsize(), n / 32, std::size_t{1}});
  std::vector<std::unique_ptr<Value>> parts((n + step - 1) / step);
  plain::run_all(parts.size(), [&](std::size_t k) {
    const blocked_range<T> part(static_cast<T>(range.begin() + k * step),
                                static_cast<T>(range.begin() + std::min(n, (k + 1) * step)), range.grainsize());
    parts[k] = std::make_unique<Value>(f(part, identity));
  });
  Value all = identity;
  for (const auto& part : parts) all = join(all, *part);
  return all;
}

template <class... F>
void parallel_invoke(const F&... f) {
  const std::array<std::function<void()>, sizeof...(F)> all = {std::cref(f)...};
  plain::run_all(all.size(), [&](std::size_t k) { all[k](); });
}

template <class Iterator, class Less = std::less<>>
void parallel_sort(Iterator begin, Iterator end, const Less& less = {}) {
  std::sort(begin, end, less);
}

class task_group {
 public:
  ~task_group() {
    if (thread_.joinable()) thread_.join();
  }
  template <class F>
  void run(const F& f) {
    wait();
    thread_ = std::thread([this, f] {
      plain::in_task = true;
      try {
        f();
      } catch (...) {
        error_ = std::current_exception();
      }
    });
  }
  void wait() {
    if (thread_.joinable()) thread_.join();
    if (const std::exception_ptr error = std::exchange(error_, nullptr)) std::rethrow_exception(error);
  }

 private:
  std::thread thread_;
  std::exception_ptr error_;
};

template <class T>
class enumerable_thread_specific {
 public:
  enumerable_thread_specific() : make_([] { return T(); }) {}
  template <class F>
  explicit enumerable_thread_specific(const F& make) : make_(make) {}
  T& local() {
    const std::lock_guard lock(mutex_);
    const auto [at, is_new] = of_.try_emplace(std::this_thread::get_id(), nullptr);
    if (is_new) at->second = &all_.emplace_back(make_());
    return *at->second;
  }

 private:
  std::function<T()> make_;
  std::mutex mutex_;
  std::list<T> all_;
  std::unordered_map<std::thread::id, T*> of_;
};

class global_control {
 public:
  enum parameter { max_allowed_parallelism };
  global_control(parameter, std::size_t value) : former_(plain::limit.exchange(value)) {}
  ~global_control() { plain::limit = former_; }
  global_control(const global_control&) = delete;
  static std::size_t active_value(parameter) { return plain::limit; }

 private:
  std::size_t former_;
};

namespace info {
inline int default_concurrency() { return 4; }
}  // namespace info

namespace this_task_arena {
inline int max_concurrency() { return static_cast<int>(plain::limit.load()); }
}  // namespace this_task_arena

}  // namespace tbb
