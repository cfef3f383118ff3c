#pragma once

#include <exception>

namespace umtet {

/// Member of objects with collective destructors: tells whether an exception has been thrown since its construction.
/// Other ranks may not know of the exception and wait elsewhere. together() ends them, but only after all destructors
/// have returned, so these must not make collective calls then.
class Unwinding {
 public:
  explicit operator bool() const { return std::uncaught_exceptions() > n_; }

 private:
  int n_ = std::uncaught_exceptions();
};

}  // namespace umtet
