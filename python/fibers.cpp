#include "python/fibers.h"

#include <boost/context/protected_fixedsize_stack.hpp>
#include <memory>
#include <utility>

namespace umtet::python {

namespace context = boost::context;
namespace {

// So many questions make a block, at most: the call of Python is then a thousandth of the work, and what the waiting
// calls have on their stacks fits into a cache of the second or third level.
constexpr std::size_t kFibers = 512;
// Bytes. The deepest call (smoothing a vertex of 128 tets) has some thirty thousand on its stack; of what is not
// touched the system keeps no pages.
constexpr std::size_t kStack = 1 << 18;

/// The fiber that is running in this thread, if any.
thread_local void* running = nullptr;

/// Unwinds the calls that wait when another one has failed.
struct Abandoned {};

}  // namespace

struct Fibers::Fiber {
  Fibers* owner;
  context::fiber self;    ///< where it waits
  context::fiber caller;  ///< who has resumed it
  Question* question = nullptr;
  bool is_done = true;  ///< with all calls of the loop
};

struct Fibers::Loop {
  std::size_t n;
  const std::function<void(std::size_t)>& f;
  std::size_t next = 0;
  std::exception_ptr error = nullptr;  ///< the first one: nothing more is begun
};

Fibers::Fibers(std::function<void(std::span<Question* const>)> answer) : answer_(std::move(answer)) {}

Fibers::~Fibers() {
  for (const auto& fiber : fibers_) resume(*fiber);  // without a loop they return
}

bool Fibers::is_inside() const { return running && static_cast<Fiber*>(running)->owner == this; }

void Fibers::resume(Fiber& fiber) {
  void* const outer = std::exchange(running, &fiber);
  fiber.self = std::move(fiber.self).resume();
  running = outer;
}

/// Calls of one loop after the other, until it is resumed without one.
context::fiber Fibers::run(Fiber& fiber, context::fiber&& caller) {
  fiber.caller = std::move(caller);
  while (Loop* loop = fiber.owner->loop_) {
    fiber.is_done = false;
    while (loop->next < loop->n && !loop->error) {
      try {
        loop->f(loop->next++);
      } catch (const Abandoned&) {
      } catch (...) {
        if (!loop->error) loop->error = std::current_exception();
      }
    }
    fiber.is_done = true;
    fiber.caller = std::move(fiber.caller).resume();
  }
  return std::move(fiber.caller);
}

void Fibers::ask(Question& question) {
  Fiber& fiber = *static_cast<Fiber*>(running);
  fiber.question = &question;
  fiber.caller = std::move(fiber.caller).resume();
  if (loop_->error) throw Abandoned();
}

void Fibers::for_each(std::size_t n, const std::function<void(std::size_t)>& f) {
  if (running || loop_) {
    for (std::size_t i = 0; i < n; ++i) f(i);
    return;
  }
  Loop loop{n, f};
  loop_ = &loop;
  std::vector<Question*> questions;
  std::size_t n_used = 0;
  const auto collect = [&](Fiber& fiber) {
    resume(fiber);
    if (fiber.question) questions.push_back(std::exchange(fiber.question, nullptr));
  };
  while (true) {
    for (std::size_t k = 0; k < n_used; ++k) {
      if (!fibers_[k]->is_done) collect(*fibers_[k]);
    }
    while (n_used < kFibers && loop.next < n && !loop.error) {
      if (n_used == fibers_.size()) {
        fibers_.push_back(std::make_unique<Fiber>());
        Fiber& made = *fibers_.back();
        made.owner = this;
        made.self = context::fiber(std::allocator_arg, context::protected_fixedsize_stack(kStack),
                                   [&made](context::fiber&& caller) { return run(made, std::move(caller)); });
      }
      collect(*fibers_[n_used++]);
    }
    if (questions.empty()) break;
    try {
      if (!loop.error) answer_(questions);
    } catch (...) {
      loop.error = std::current_exception();
    }
    questions.clear();
  }
  loop_ = nullptr;
  if (loop.error) std::rethrow_exception(loop.error);
}

}  // namespace umtet::python
