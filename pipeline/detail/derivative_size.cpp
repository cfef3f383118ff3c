#include "pipeline/detail/derivative_size.h"

namespace umtet {
namespace {

/// How much text e, a first and a second derivative of it take.
struct Sizes {
  double e = 0, first = 0, second = 0;
  bool is_constant() const { return first == 0; }
};

Sizes sum(const Sizes& a, const Sizes& b) { return {a.e + b.e, a.first + b.first, a.second + b.second}; }

/// a b, a'b + ab', a''b + 2 a'b' + ab''. Terms with a derivative that vanishes are none.
Sizes product(const Sizes& a, const Sizes& b) {
  const auto term = [](bool vanishes, double x, double y) { return vanishes ? 0 : x + y; };
  const bool no_a = a.is_constant(), no_b = b.is_constant();
  return {a.e + b.e, term(no_a, a.first, b.e) + term(no_b, a.e, b.first),
          term(no_a, a.second, b.e) + 2 * term(no_a || no_b, a.first, b.first) + term(no_b, a.e, b.second)};
}

/// f(g), f'(g) g', f''(g) g'^2 + f'(g) g''.
Sizes chain(const Sizes& g) {
  if (g.is_constant()) return {1 + g.e, 0, 0};
  return {1 + g.e, 1 + g.e + g.first, 2 * (1 + g.e) + 2 * g.first + g.second};
}

Sizes sizes_of(const GiNaC::ex& e) {
  if (GiNaC::is_a<GiNaC::symbol>(e)) return {1, 1, 0};
  if (e.nops() == 0) return {1, 0, 0};
  Sizes all = sizes_of(e.op(0));
  if (GiNaC::is_a<GiNaC::power>(e)) {
    const Sizes exponent = sizes_of(e.op(1));
    return exponent.is_constant() ? sum(chain(all), exponent)
                                  : chain(product(exponent, chain(all)));  // a^b = exp(b log a)
  }
  const bool is_sum = GiNaC::is_a<GiNaC::add>(e), is_product = GiNaC::is_a<GiNaC::mul>(e);
  if (!is_sum && !is_product) return chain(all);
  for (std::size_t k = 1; k < e.nops(); ++k) {
    const Sizes next = sizes_of(e.op(k));
    all = is_sum ? sum(all, next) : product(all, next);
  }
  return all;
}

}  // namespace

double second_derivative_size(const GiNaC::ex& e) { return sizes_of(e).second; }

}  // namespace umtet
