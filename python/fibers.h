#pragma once

#include <boost/context/fiber.hpp>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "mesh/core/implicit_function.h"

namespace umtet::python {

/// A question to psi, and where the answer goes.
struct Question {
  Vec3 x;
  double value = 0;
  Vec3* gradient;  ///< null where it is not wanted
  Mat3* hessian;
};

/// Calls that wait on stacks of their own, in one thread, until a block of questions is answered.
///
/// An algorithm written for one point then asks in blocks as it is: a line search of a vertex waits while those of the
/// other vertices go on. A switch takes some ten nanoseconds.
class Fibers {
 public:
  /// @param answer  fills the values, gradients and Hessians of a block. What it throws ends for_each().
  explicit Fibers(std::function<void(std::span<Question* const>)> answer);
  ~Fibers();
  Fibers(const Fibers&) = delete;
  Fibers& operator=(const Fibers&) = delete;

  /// As SideBySide::for_each(): up to kFibers calls are under way at a time. Within one of its calls it is a plain
  /// loop.
  void for_each(std::size_t n, const std::function<void(std::size_t)>& f);
  /// True in the f of a for_each() of this thread.
  bool is_inside() const;
  /// Returns with the answer. \pre is_inside() \throw what ends for_each()
  void ask(Question& question);

 private:
  struct Fiber;
  struct Loop;
  static boost::context::fiber run(Fiber& fiber, boost::context::fiber&& caller);
  void resume(Fiber& fiber);

  std::function<void(std::span<Question* const>)> answer_;
  std::vector<std::unique_ptr<Fiber>> fibers_;  ///< kept, as a stack costs more than a call
  Loop* loop_ = nullptr;                        ///< the one under way
};

}  // namespace umtet::python
