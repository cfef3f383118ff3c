#pragma once

#include <memory>
#include <utility>

#include "mesh/core/implicit_function.h"

namespace umtet {

/// An implicit function that all copies of this object own together.
class SharedFunction {
 public:
  template <ImplicitFunction F>
  explicit SharedFunction(std::shared_ptr<const F> f) : ref_(*f), owner_(std::move(f)) {}

  /// Valid while a copy of this object exists.
  ImplicitFunctionRef ref() const { return ref_; }

 private:
  ImplicitFunctionRef ref_;
  std::shared_ptr<const void> owner_;
};

/// @param f  is moved into the object
template <ImplicitFunction F>
SharedFunction shared_function(F f) {
  return SharedFunction(std::make_shared<const F>(std::move(f)));
}

}  // namespace umtet
