#include "pipeline/expression/detail/expression_reader.h"

#include <muParser.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "pipeline/expression/detail/decimal_fraction.h"
#include "pipeline/expression/expression.h"

namespace umtet {
namespace {

// Longer texts are not formulas.
constexpr std::size_t kMaxText = 4096;
// x^n with a larger exponent overflows double even for |x| = 2.
constexpr double kMaxExponent = 1000;

/// muParser passes numbers to its operators; here the numbers are handles: indices of the expressions built so far.
/// Thus one library parses the text, and GiNaC receives the result instead of parsing the text again.
class Builder {
 public:
  Builder(const std::string& text, std::optional<double> t) : text_(text), t_(t) {}

  GiNaC::ex build();
  const std::array<GiNaC::realsymbol, 3>& symbols() const { return symbols_; }

 private:
  struct Node {
    GiNaC::ex e;
    std::size_t column;  ///< start in the text, 1-based
  };

  double add(const GiNaC::ex& e, std::size_t column);
  Node& node(double handle) { return nodes_[static_cast<std::size_t>(handle)]; }
  int read_leaf(const char* s, int* pos, double* handle);
  GiNaC::numeric number(const std::string& digits, std::size_t column) const;
  std::optional<double> constant(const GiNaC::ex& e) const;
  GiNaC::ex power(const Node& base, const Node& exponent) const;

  template <class F>
  double binary(double a, double b, F&& f);
  template <class F>
  double unary(double a, F&& f);

  GiNaC::ex time() const;

  const std::string& text_;
  std::optional<double> t_;
  std::array<GiNaC::realsymbol, 3> symbols_{GiNaC::realsymbol("x"), GiNaC::realsymbol("y"), GiNaC::realsymbol("z")};
  std::vector<Node> nodes_;

  // muParser's callbacks are plain function pointers; they find their builder here.
  static thread_local Builder* active_;
  friend struct Callbacks;
};

thread_local Builder* Builder::active_ = nullptr;

double Builder::add(const GiNaC::ex& e, std::size_t column) {
  nodes_.push_back({e, column});
  return static_cast<double>(nodes_.size() - 1);
}

GiNaC::numeric Builder::number(const std::string& digits, std::size_t column) const {
  try {
    return fraction_of_decimal(digits);
  } catch (const std::out_of_range&) {
    throw ExpressionError(text_, column, "the number " + digits + " is out of range");
  }
}

/// Returns the time as an exact fraction: 0.1 is a tenth, as in the text.
GiNaC::ex Builder::time() const {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.begin(), digits.end(), std::abs(*t_)).ptr;
  const GiNaC::numeric n = number(std::string(digits.begin(), end), 1);
  return *t_ < 0 ? -n : n;
}

/// Reads numbers, and names that are not functions. \return whether the text at `s` starts with one
int Builder::read_leaf(const char* s, int* pos, double* handle) {
  const std::size_t column = static_cast<std::size_t>(*pos) + 1;
  if (const std::size_t n = length_of_decimal(s); n > 0) {
    *handle = add(number(std::string(s, n), column), column);
    *pos += static_cast<int>(n);
    return 1;
  }
  std::string name;
  for (; std::isalnum(static_cast<unsigned char>(*s)) || *s == '_'; ++s) name += *s;
  GiNaC::ex e;
  if (name == "x" || name == "y" || name == "z") {
    e = symbols_[static_cast<std::size_t>(name[0] - 'x')];
  } else if (name == "pi") {
    e = GiNaC::Pi;
  } else if (name == "t" && t_) {
    e = time();
  } else {
    return 0;
  }
  *handle = add(e, column);
  *pos += static_cast<int>(name.size());
  return 1;
}

/// Returns the value of an expression that does not depend on x, y, z, even if GiNaC keeps it symbolic, such as 2^pi;
/// nothing if the value is not real.
std::optional<double> Builder::constant(const GiNaC::ex& e) const {
  if (GiNaC::is_a<GiNaC::numeric>(e)) return GiNaC::ex_to<GiNaC::numeric>(e).to_double();
  for (const GiNaC::realsymbol& s : symbols_) {
    if (e.has(s)) return {};
  }
  const GiNaC::ex value = e.evalf();
  if (!GiNaC::is_a<GiNaC::numeric>(value) || !GiNaC::ex_to<GiNaC::numeric>(value).is_real()) return {};
  return GiNaC::ex_to<GiNaC::numeric>(value).to_double();
}

GiNaC::ex Builder::power(const Node& base, const Node& exponent) const {
  // Checked before the power is computed: CLN would allocate memory for 9^9^9^9^.3 to the last digit.
  if (const std::optional<double> n = constant(exponent.e)) {
    double decades = 0;
    if (const std::optional<double> b = constant(base.e)) decades = *n * std::log10(std::abs(*b));
    if (std::abs(*n) > kMaxExponent || (std::isfinite(decades) && std::abs(decades) > 300)) {
      throw ExpressionError(text_, exponent.column, "the power is out of range");
    }
  }
  GiNaC::ex e = GiNaC::pow(base.e, exponent.e);
  if (GiNaC::is_a<GiNaC::power>(e) && GiNaC::is_a<GiNaC::numeric>(e.op(1)) &&
      GiNaC::abs(GiNaC::ex_to<GiNaC::numeric>(e.op(1))) > GiNaC::numeric(static_cast<long>(kMaxExponent))) {
    throw ExpressionError(text_, exponent.column, "the power is out of range");
  }
  return e;
}

/// Runs one operation of GiNaC and adds the position in the text to its errors.
template <class F>
double Builder::binary(double a, double b, F&& f) {
  const Node left = node(a), right = node(b);
  try {
    const GiNaC::ex e = f(left, right);
    if (const std::optional<double> value = constant(e); value && !std::isfinite(*value)) {
      throw ExpressionError(text_, left.column, "a constant is out of range");
    }
    return add(e, left.column);
  } catch (const ExpressionError&) {
    throw;
  } catch (const std::exception& e) {  // GiNaC: pole_error, overflow_error, invalid_argument
    throw ExpressionError(text_, right.column, std::string("no value: ") + e.what());
  }
}

template <class F>
double Builder::unary(double a, F&& f) {
  return binary(a, a, [&](const Node& n, const Node&) { return GiNaC::ex(f(n.e)); });
}

struct Callbacks {
  using Node = Builder::Node;
  static int leaf(const char* s, int* pos, double* v) { return Builder::active_->read_leaf(s, pos, v); }
  static double plus(double a, double b) {
    return Builder::active_->binary(a, b, [](const Node& l, const Node& r) { return GiNaC::ex(l.e + r.e); });
  }
  static double minus(double a, double b) {
    return Builder::active_->binary(a, b, [](const Node& l, const Node& r) { return GiNaC::ex(l.e - r.e); });
  }
  static double times(double a, double b) {
    return Builder::active_->binary(a, b, [](const Node& l, const Node& r) { return GiNaC::ex(l.e * r.e); });
  }
  static double over(double a, double b) {
    return Builder::active_->binary(a, b, [](const Node& l, const Node& r) {
      if (r.e.is_zero()) throw std::overflow_error("division by zero");
      return GiNaC::ex(l.e / r.e);
    });
  }
  static double power(double a, double b) {
    Builder& builder = *Builder::active_;
    return builder.binary(a, b, [&](const Node& l, const Node& r) { return builder.power(l, r); });
  }
  static double negate(double a) {
    return Builder::active_->unary(a, [](const GiNaC::ex& e) { return -e; });
  }
  static double identity(double a) { return a; }

#define UMTET_FUNCTION(name)                                                              \
  static double name##_(double a) {                                                       \
    return Builder::active_->unary(a, [](const GiNaC::ex& e) { return GiNaC::name(e); }); \
  }
  UMTET_FUNCTION(sin)
  UMTET_FUNCTION(cos)
  UMTET_FUNCTION(tan)
  UMTET_FUNCTION(asin)
  UMTET_FUNCTION(acos)
  UMTET_FUNCTION(atan)
  UMTET_FUNCTION(sinh)
  UMTET_FUNCTION(cosh)
  UMTET_FUNCTION(tanh)
  UMTET_FUNCTION(exp)
  UMTET_FUNCTION(log)
  UMTET_FUNCTION(sqrt)
#undef UMTET_FUNCTION
};

const std::pair<const char*, mu::fun_type1> kFunctions[] = {
    {"sin", Callbacks::sin_},   {"cos", Callbacks::cos_},   {"tan", Callbacks::tan_},   {"asin", Callbacks::asin_},
    {"acos", Callbacks::acos_}, {"atan", Callbacks::atan_}, {"sinh", Callbacks::sinh_}, {"cosh", Callbacks::cosh_},
    {"tanh", Callbacks::tanh_}, {"exp", Callbacks::exp_},   {"log", Callbacks::log_},   {"sqrt", Callbacks::sqrt_}};

/// Returns a muParser that knows only the grammar of the header.
mu::Parser grammar() {
  mu::Parser p;
  p.ClearConst();
  p.ClearFun();
  p.ClearInfixOprt();
  p.ClearPostfixOprt();
  p.EnableBuiltInOprt(false);
  p.AddValIdent(Callbacks::leaf);
  p.DefineOprt("+", Callbacks::plus, mu::prADD_SUB, mu::oaLEFT, true);
  p.DefineOprt("-", Callbacks::minus, mu::prADD_SUB, mu::oaLEFT, true);
  p.DefineOprt("*", Callbacks::times, mu::prMUL_DIV, mu::oaLEFT, true);
  p.DefineOprt("/", Callbacks::over, mu::prMUL_DIV, mu::oaLEFT, true);
  p.DefineOprt("^", Callbacks::power, mu::prPOW, mu::oaRIGHT, true);
  p.DefineInfixOprt("-", Callbacks::negate);
  p.DefineInfixOprt("+", Callbacks::identity);
  for (const auto& [name, f] : kFunctions) p.DefineFun(name, f, true);
  return p;
}

/// Returns the token of an error. muParser takes everything up to the next blank or bracket as a token, and appends a
/// blank to the text.
std::string offending_token(const mu::ParserError& e) {
  const std::string& token = e.GetToken();
  if (!token.empty() && std::string("+-*/^").find(token[0]) != std::string::npos) return token.substr(0, 1);
  return token.substr(0, token.find_last_not_of(" \t") + 1);
}

std::string refusal(const mu::ParserError& e) {
  const std::string token = offending_token(e);
  if (token == "*" || token == "/" || token == "^") return "unexpected \"" + token + "\" (a power is written x^2)";
  switch (e.GetCode()) {
    case mu::ecUNASSIGNABLE_TOKEN:
      for (const auto& [name, f] : kFunctions) {
        if (token == name) return token + " needs its argument in brackets";
      }
      return "unknown name \"" + token +
             "\" (known: x y z pi, in umtet evolve t, sin cos tan asin acos atan sinh cosh tanh exp log sqrt)";
    case mu::ecUNEXPECTED_EOF:
      return "the expression ends too early";
    case mu::ecMISSING_PARENS:
      return "a closing bracket is missing";
    case mu::ecUNEXPECTED_PARENS:
      return "unexpected bracket \"" + token + "\"";
    case mu::ecTOO_MANY_PARAMS:
    case mu::ecTOO_FEW_PARAMS:
      return "functions take one argument";
    default:
      return token.empty() ? e.GetMsg() : "unexpected \"" + token + "\"";
  }
}

/// Refuses functions of other languages that are not C2.
void refuse_kinks(const std::string& text) {
  for (std::size_t k = 0; k < text.size();) {
    std::size_t end = k;
    while (end < text.size() && (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '_')) ++end;
    const std::string name = text.substr(k, end - k);
    for (const char* kink : {"abs", "fabs", "min", "max", "sign", "floor", "ceil", "round"}) {
      if (name == kink) throw ExpressionError(text, k + 1, name + " is not smooth; psi must be C2");
    }
    k = std::max(end, k + 1);
  }
}

/// Returns all bytes of the character that begins at byte k.
std::string character(const std::string& text, std::size_t k) {
  std::size_t n = 1;
  while (k + n < text.size() && (static_cast<unsigned char>(text[k + n]) & 0xc0) == 0x80) ++n;
  return text.substr(k, n);
}

GiNaC::ex Builder::build() {
  if (text_.find_first_not_of(" \t") == std::string::npos) throw ExpressionError(text_, 1, "the expression is empty");
  if (text_.size() > kMaxText) throw ExpressionError(text_, kMaxText + 1, "longer than 4096 characters");
  refuse_kinks(text_);
  for (std::size_t k = 0; k < text_.size(); ++k) {  // muParser accepts further signs: , ? : = " ...
    const unsigned char c = static_cast<unsigned char>(text_[k]);
    if (!(c < 128 && (std::isalnum(c) || std::string(" \t._+-*/^()").find(text_[k]) != std::string::npos))) {
      throw ExpressionError(text_, k + 1, "unexpected character " + character(text_, k));
    }
  }
  active_ = this;
  try {
    mu::Parser p = grammar();
    p.SetExpr(text_);
    GiNaC::ex e = node(p.Eval()).e;
    for (const GiNaC::realsymbol& s : symbols_) {
      if (e.has(s)) {
        if (e.has(GiNaC::I)) throw ExpressionError(text_, 1, "not real: it contains the root of a negative number");
        return e;
      }
    }
    throw ExpressionError(text_, 1, "the formula does not depend on x, y or z");
  } catch (const mu::ParserError& e) {
    const long pos = e.GetPos();
    const std::size_t column = pos < 0 ? text_.size() + 1 : std::min<std::size_t>(pos + 1, text_.size() + 1);
    throw ExpressionError(text_, column, refusal(e));
  }
}

}  // namespace

SymbolicExpression read_expression(const std::string& text, std::optional<double> t) {
  Builder builder(text, t);
  GiNaC::ex psi = builder.build();
  return {std::move(psi), builder.symbols()};
}

}  // namespace umtet
