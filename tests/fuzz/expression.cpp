#include "mesh/expression/expression.h"

#include <cstdlib>
#include <string>

/// A function that can be evaluated with its derivatives, or a refusal with a place in the text.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const umtet::Expression psi(text, .5);
    umtet::Vec3 gradient;
    umtet::Mat3 hessian;
    for (const umtet::Vec3& x : {umtet::Vec3(0, 0, 0), umtet::Vec3(.3, -.7, 1.1)}) {
      psi.evaluate(x, nullptr, nullptr);
      psi.evaluate(x, &gradient, &hessian);
    }
  } catch (const umtet::ExpressionError& error) {
    if (error.column < 1 || error.column > size + 1) std::abort();
  }
  return 0;
}
