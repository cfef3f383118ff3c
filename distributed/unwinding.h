#pragma once

#include <exception>

namespace umtet {

/// A member of what is destroyed by collective calls: whether something has been thrown since it was made. Others may
/// not know of that and wait elsewhere. together() ends them, but only once all destructors have returned: these then
/// call nothing that is collective.
class Unwinding {
 public:
  explicit operator bool() const { return std::uncaught_exceptions() > n_; }

 private:
  int n_ = std::uncaught_exceptions();
};

}  // namespace umtet
