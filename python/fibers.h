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

/// A request for psi at a point, with the destination of the result.
struct Question {
  Vec3 x;
  double value = 0;
  Vec3* gradient;  ///< null if not requested
  Mat3* hessian;
};

/// Cooperative fibers: calls that wait on separate stacks, in one thread, until a block of questions is answered.
///
/// An algorithm written for one point can thus evaluate in blocks without changes: while the line search of one vertex
/// waits, those of other vertices continue. A switch takes about ten nanoseconds.
class Fibers {
 public:
  /// @param answer  computes the values, gradients and Hessians of a block. An exception ends for_each().
  explicit Fibers(std::function<void(std::span<Question* const>)> answer);
  ~Fibers();
  Fibers(const Fibers&) = delete;
  Fibers& operator=(const Fibers&) = delete;

  /// As SideBySide::for_each(), with up to kFibers calls in progress at a time. A nested call is a plain loop.
  void for_each(std::size_t n, const std::function<void(std::size_t)>& f);
  /// True inside the f of a for_each() of this thread.
  bool is_inside() const;
  /// Waits for the answer. \pre is_inside() \throw the exception that ends for_each()
  void ask(Question& question);

 private:
  struct Fiber;
  struct Loop;
  static boost::context::fiber run(Fiber& fiber, boost::context::fiber&& caller);
  void resume(Fiber& fiber);

  std::function<void(std::span<Question* const>)> answer_;
  std::vector<std::unique_ptr<Fiber>> fibers_;  ///< kept for reuse, because a stack costs more than a call
  Loop* loop_ = nullptr;                        ///< the loop in progress
};

}  // namespace umtet::python
