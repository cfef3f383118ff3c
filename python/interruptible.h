#pragma once

#include <pybind11/pybind11.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <thread>
#include <type_traits>
#include <utility>

#include "python/arguments.h"

namespace umtet::python {

/// Number of abandoned threads that still work; they end at the next poll of their job.
inline std::atomic<int> n_left_behind{0};

/// Watch of a job in a separate thread, which `stopped` stops. It uses Python only while the caller waits.
Watch watch_in_thread(const pybind11::object& progress, std::shared_ptr<std::atomic<bool>> stopped);

/// Runs f(watch) in a separate thread and waits for it without the GIL. Ctrl-C is therefore handled immediately, also
/// in steps that do not poll; f is then abandoned and ends by itself.
/// @param f  owns all data that it uses, and no Python objects
template <class F>
auto interruptible(const pybind11::object& progress, int threads, F f) {
  using Result = std::invoke_result_t<F&, const Watch&>;
  const auto stopped = std::make_shared<std::atomic<bool>>(false);
  std::packaged_task<Result()> task([f = std::move(f), watch = watch_in_thread(progress, stopped), threads]() mutable {
    tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
    return arena.execute([&] { return f(watch); });
  });
  std::future<Result> result = task.get_future();
  std::thread worker([task = std::move(task)]() mutable {
    task();
    task = {};  // frees its data before the interpreter may end
    --n_left_behind;
  });
  ++n_left_behind;
  const pybind11::gil_scoped_release no_gil;
  while (result.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) {
    const pybind11::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() == 0) continue;
    *stopped = true;  // with the GIL: no callback is running or will run
    worker.detach();
    throw pybind11::error_already_set();
  }
  worker.join();
  return result.get();
}

}  // namespace umtet::python
