#include "mesh/expression/formula_parser.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>
#include <tuple>

#include "mesh/expression/expression.h"

namespace umtet {
namespace {

constexpr std::size_t kMaxText = 4096;
constexpr double kMaxExponent = 1000;
constexpr double kMaxDecades = 300;  // of a number: doubles end at 308
constexpr double kPole = 1e15;       // tan of the double nearest to pi / 2 is 1.6e16
constexpr int kMaxDepth = 1000;      // a level takes about 1 kB of the stack

constexpr std::array<std::pair<std::string_view, Operator>, 12> kFunctions{{{"sin", Operator::Sin},
                                                                            {"cos", Operator::Cos},
                                                                            {"tan", Operator::Tan},
                                                                            {"asin", Operator::Asin},
                                                                            {"acos", Operator::Acos},
                                                                            {"atan", Operator::Atan},
                                                                            {"sinh", Operator::Sinh},
                                                                            {"cosh", Operator::Cosh},
                                                                            {"tanh", Operator::Tanh},
                                                                            {"exp", Operator::Exp},
                                                                            {"log", Operator::Log},
                                                                            {"sqrt", Operator::Sqrt}}};
constexpr std::array<std::string_view, 8> kKinks{"abs", "fabs", "min", "max", "sign", "floor", "ceil", "round"};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

/// A part of the formula: an operation of the tape, or a number.
struct Part {
  std::size_t column;  ///< start in the text, 1-based
  int operation = -1;  ///< -1: the number
  double number = 0;
  double exponent = 1;  ///< of a power with a number as exponent
  bool is_number() const { return operation < 0; }
};

class Parser {
 public:
  Parser(const std::string& text, std::optional<double> t) : text_(text), t_(t) {}
  Tape parse();

 private:
  [[noreturn]] void refuse(std::size_t column, const std::string& message) const {
    throw ExpressionError(text_, column, message);
  }
  [[noreturn]] void refuse_next() const;
  char peek();
  bool take(char c);

  Part sum();
  Part product();
  Part signed_power();
  Part atom();
  Part number();
  Part name();

  Part unary(Operator f, const Part& a, std::size_t column);
  Part binary(Operator f, const Part& a, const Part& b);
  Part power(const Part& base, const Part& exponent);
  Part whole_power(const Part& base, int n);
  Part operation(Operator f, std::size_t column, int a = -1, int b = -1, double c = 0);
  Part constant(double value, std::size_t column, std::size_t culprit) const;

  const std::string& text_;
  std::optional<double> t_;
  std::size_t at_ = 0;
  int depth_ = 0;
  Tape tape_;
  std::map<std::tuple<Operator, int, int, std::uint64_t>, int> known_;
};

/// Returns all bytes of the character that begins at byte k.
std::string character(const std::string& text, std::size_t k) {
  std::size_t n = 1;
  while (k + n < text.size() && (static_cast<unsigned char>(text[k + n]) & 0xc0) == 0x80) ++n;
  return text.substr(k, n);
}

char Parser::peek() {
  while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  return at_ < text_.size() ? text_[at_] : '\0';
}

bool Parser::take(char c) {
  if (peek() != c) return false;
  ++at_;
  return true;
}

/// Refuses the token at which the parser stands.
void Parser::refuse_next() const {
  const std::size_t column = at_ + 1;
  if (at_ >= text_.size()) refuse(text_.size() + 1, "the expression ends too early");
  const char c = text_[at_];
  if (c == '*' || c == '/' || c == '^')
    refuse(column, std::string("unexpected \"") + c + "\" (a power is written x^2)");
  if (c == '(' || c == ')') refuse(column, std::string("unexpected bracket \"") + c + "\"");
  if (!is_of_name(c) && c != '.' && c != '+' && c != '-')
    refuse(column, "unexpected character " + character(text_, at_));
  std::size_t end = at_ + 1;
  while (is_of_name(c) && end < text_.size() && is_of_name(text_[end])) ++end;
  refuse(column, "unexpected \"" + text_.substr(at_, end - at_) + "\"");
}

Tape Parser::parse() {
  if (text_.find_first_not_of(" \t") == std::string::npos) refuse(1, "the expression is empty");
  if (text_.size() > kMaxText) refuse(kMaxText + 1, "longer than " + std::to_string(kMaxText) + " characters");
  const Part psi = sum();
  if (peek() != '\0') refuse_next();
  if (psi.is_number()) refuse(1, "the formula does not depend on x, y or z");
  tape_.operations.resize(static_cast<std::size_t>(psi.operation) + 1);
  return std::move(tape_);
}

Part Parser::sum() {
  Part a = product();
  for (;;) {
    if (take('+')) {
      a = binary(Operator::Add, a, product());
    } else if (take('-')) {
      a = binary(Operator::Subtract, a, product());
    } else {
      return a;
    }
  }
}

Part Parser::product() {
  Part a = signed_power();
  for (;;) {
    if (take('*')) {
      a = binary(Operator::Multiply, a, signed_power());
    } else if (take('/')) {
      a = binary(Operator::Divide, a, signed_power());
    } else {
      return a;
    }
  }
}

Part Parser::signed_power() {
  if (++depth_ > kMaxDepth)
    refuse(at_ + 1, "more than " + std::to_string(kMaxDepth) + " levels of brackets, signs and powers");
  peek();
  const std::size_t column = at_ + 1;
  Part a;
  if (take('-')) {
    const Part b = signed_power();
    a = b.is_number() ? constant(-b.number, column, column) : operation(Operator::SubtractFrom, column, b.operation);
  } else if (take('+')) {
    a = signed_power();
  } else {
    a = atom();
    if (take('^')) a = power(a, signed_power());
  }
  --depth_;
  return a;
}

Part Parser::atom() {
  const char c = peek();
  if (take('(')) {
    const Part a = sum();
    if (!take(')')) at_ < text_.size() ? refuse_next() : refuse(at_ + 1, "a closing bracket is missing");
    return a;
  }
  if (is_digit(c) || (c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1]))) return number();
  if (is_of_name(c)) return name();
  refuse_next();
}

Part Parser::number() {
  const char* begin = text_.data() + at_;
  double value = 0;
  const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
  const std::string digits(begin, end);
  if (error == std::errc::result_out_of_range) refuse(at_ + 1, "the number " + digits + " is out of range");
  const std::size_t column = at_ + 1;
  at_ += digits.size();
  return {column, -1, value};
}

Part Parser::name() {
  const std::size_t column = at_ + 1;
  std::size_t end = at_;
  while (end < text_.size() && is_of_name(text_[end])) ++end;
  const std::string_view name = std::string_view(text_).substr(at_, end - at_);
  const auto follow = [&](const Part& a) { return at_ = end, a; };
  if (name == "x") return follow(operation(Operator::X, column));
  if (name == "y") return follow(operation(Operator::Y, column));
  if (name == "z") return follow(operation(Operator::Z, column));
  if (name == "pi") return follow({column, -1, std::acos(-1.)});
  if (name == "t" && t_) return follow({column, -1, *t_});
  for (const auto& [word, f] : kFunctions) {
    if (name != word) continue;
    at_ = end;
    if (!take('(')) refuse(column, std::string(word) + " needs its argument in brackets");
    const Part a = sum();
    if (!take(')')) at_ < text_.size() ? refuse_next() : refuse(at_ + 1, "a closing bracket is missing");
    return unary(f, a, column);
  }
  if (std::find(kKinks.begin(), kKinks.end(), name) != kKinks.end()) {
    refuse(column, std::string(name) + " is not smooth; psi must be C2");
  }
  refuse(column, "unknown name \"" + std::string(name) +
                     "\" (known: x y z pi, in umtet evolve t, sin cos tan asin acos atan sinh cosh tanh exp log sqrt)");
}

/// Returns a number that was computed at `column`; `culprit` is the column of the operand to name if there is no value.
Part Parser::constant(double value, std::size_t column, std::size_t culprit) const {
  if (std::isnan(value)) refuse(culprit, "not real: the root or logarithm of a negative number, or similar");
  if (std::isinf(value)) refuse(column, "a constant is out of range");
  return {column, -1, value};
}

Part Parser::operation(Operator f, std::size_t column, int a, int b, double c) {
  const auto [known, is_new] =
      known_.try_emplace({f, a, b, std::bit_cast<std::uint64_t>(c)}, static_cast<int>(tape_.operations.size()));
  if (is_new) tape_.operations.push_back({f, a, b, c});
  return {column, known->second};
}

Part Parser::unary(Operator f, const Part& a, std::size_t column) {
  if (!a.is_number()) return operation(f, column, a.operation);
  const double value = apply(f, a.number);
  if (f == Operator::Log && a.number == 0) refuse(a.column, "no value: log of zero");
  if (f == Operator::Tan && std::abs(value) > kPole) refuse(a.column, "no value: tan has a pole here");
  return constant(value, column, column);
}

Part Parser::binary(Operator f, const Part& a, const Part& b) {
  if (f == Operator::Divide && b.is_number() && b.number == 0) refuse(b.column, "no value: division by zero");
  if (a.is_number() && b.is_number()) return constant(apply(f, a.number, b.number), a.column, a.column);
  if (!a.is_number() && !b.is_number()) return operation(f, a.column, a.operation, b.operation);
  const Part& part = a.is_number() ? b : a;
  const double c = a.is_number() ? a.number : b.number;
  const bool is_first = &part == &a;
  if (f == Operator::Add) return operation(Operator::AddNumber, a.column, part.operation, -1, c);
  if (f == Operator::Multiply) {
    return c == 0 ? Part{a.column, -1, 0} : operation(Operator::MultiplyBy, a.column, part.operation, -1, c);
  }
  if (f == Operator::Subtract) {
    return is_first ? operation(Operator::AddNumber, a.column, part.operation, -1, -c)
                    : operation(Operator::SubtractFrom, a.column, part.operation, -1, c);
  }
  return operation(is_first ? Operator::DivideBy : Operator::DivideNumber, a.column, part.operation, -1, c);
}

/// base^n, n >= 1, by squares and products.
Part Parser::whole_power(const Part& base, int n) {
  if (n == 1) return base;
  const Part half = whole_power(base, n / 2);
  const Part square = operation(Operator::Square, base.column, half.operation);
  return n % 2 == 0 ? square : operation(Operator::Multiply, base.column, square.operation, base.operation);
}

Part Parser::power(const Part& base, const Part& exponent) {
  if (!exponent.is_number()) {
    if (!base.is_number()) return operation(Operator::Power, base.column, base.operation, exponent.operation);
    if (base.number <= 0) refuse(1, "no derivative: the base of a variable power is not positive");
    return operation(Operator::NumberTo, base.column, exponent.operation, -1, base.number);
  }
  const double n = exponent.number;
  const double decades = base.is_number() ? n * std::log10(std::abs(base.number)) : 0;
  if (std::abs(n * base.exponent) > kMaxExponent || (std::isfinite(decades) && std::abs(decades) > kMaxDecades)) {
    refuse(exponent.column, "the power is out of range");
  }
  if (base.is_number()) {
    if (base.number == 0 && n < 0) refuse(base.column, "no value: division by zero");
    return constant(std::pow(base.number, n), base.column, base.column);
  }
  if (n == 0) return {base.column, -1, 1};
  constexpr double kMostProducts = 64;  // beyond, pow() is as fast
  Part p;
  if (std::abs(n) == .5) {
    p = operation(Operator::Sqrt, base.column, base.operation);
  } else if (n == std::trunc(n) && std::abs(n) <= kMostProducts) {
    p = whole_power(base, static_cast<int>(std::abs(n)));
  } else {
    p = operation(Operator::ToNumber, base.column, base.operation, -1, std::abs(n));
  }
  if (n < 0) p = operation(Operator::DivideNumber, base.column, p.operation, -1, 1);
  p.exponent = n * base.exponent;
  return p;
}

}  // namespace

Tape parse_formula(const std::string& text, std::optional<double> t) { return Parser(text, t).parse(); }

}  // namespace umtet
