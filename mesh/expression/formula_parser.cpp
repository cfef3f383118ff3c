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

constexpr std::array<std::string_view, 4> kFolds{"abs", "fabs", "min", "max"};  // in a piecewise formula
constexpr std::array<Operator, 7> kIncreasing{Operator::Asin, Operator::Atan, Operator::Sinh, Operator::Tanh,
                                              Operator::Exp,  Operator::Log,  Operator::Sqrt};
constexpr std::size_t kMostLeaves = 256;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

/// A part of the formula: an operation of the tape, or a number.
struct Part {
  std::size_t column;  ///< start in the text, 1-based
  int operation = -1;  ///< -1: the number
  double number = 0;
  double exponent = 1;  ///< of a power with a number as exponent
  int fold = -1;        ///< a max or min of two parts, by its number; -1: none
  bool is_number() const { return operation < 0 && fold < 0; }
  bool is_fold() const { return fold >= 0; }
};

/// max or min of two parts.
struct Fold {
  bool is_max;
  Part left, right;
};

class Parser {
 public:
  Parser(const std::string& text, std::optional<double> t, bool has_folds)
      : text_(text), t_(t), has_folds_(has_folds) {}
  Tape parse();
  PiecewiseFormula parse_piecewise();

 private:
  [[noreturn]] void refuse(std::size_t column, const std::string& message) const {
    throw ExpressionError(text_, column, message);
  }
  [[noreturn]] void refuse_next() const;
  char peek();
  bool take(char c);

  Part whole();
  Part fold(bool is_max, const Part& a, const Part& b);
  template <class F>
  Part distribute(const Part& a, bool turns, const F& f);
  Part negative(const Part& a, std::size_t column);
  Part fold_of_arguments(std::string_view name, std::size_t column);
  void refuse_fold(const Part& a, const char* where) const;
  int add_nodes(const Part& a, PiecewiseFormula& formula, std::map<int, int>& tape_of) const;

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
  bool has_folds_;
  int depth_ = 0;
  std::vector<Fold> folds_;
  std::size_t n_leaves_ = 0;  ///< of folds made so far
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
  while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r'))
    ++at_;
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

Part Parser::whole() {
  if (text_.find_first_not_of(" \t") == std::string::npos) refuse(1, "the expression is empty");
  if (text_.size() > kMaxText) refuse(kMaxText + 1, "longer than " + std::to_string(kMaxText) + " characters");
  const Part psi = sum();
  if (peek() != '\0') refuse_next();
  if (psi.is_number()) refuse(1, "the formula does not depend on x, y or z");
  return psi;
}

Tape Parser::parse() {
  const Part psi = whole();
  tape_.operations.resize(static_cast<std::size_t>(psi.operation) + 1);
  return std::move(tape_);
}

/// The operations that one of them needs, renumbered.
Tape needed_for(const Tape& all, int last) {
  std::vector<int> number(static_cast<std::size_t>(last) + 1, -1);
  number[last] = 0;
  for (int k = last; k >= 0; --k) {
    if (number[k] < 0) continue;
    const Operation& o = all.operations[k];
    if (o.a >= 0) number[o.a] = 0;
    if (o.b >= 0) number[o.b] = 0;
  }
  Tape tape;
  for (int k = 0; k <= last; ++k) {
    if (number[k] < 0) continue;
    number[k] = static_cast<int>(tape.operations.size());
    Operation o = all.operations[k];
    if (o.a >= 0) o.a = number[o.a];
    if (o.b >= 0) o.b = number[o.b];
    tape.operations.push_back(o);
  }
  return tape;
}

PiecewiseFormula Parser::parse_piecewise() {
  const Part psi = whole();
  PiecewiseFormula formula;
  std::map<int, int> tape_of;
  add_nodes(psi, formula, tape_of);
  return formula;
}

/// Adds the nodes of a part; returns the number of its own.
int Parser::add_nodes(const Part& a, PiecewiseFormula& formula, std::map<int, int>& tape_of) const {
  PiecewiseFormula::Node node;
  if (a.is_fold()) {
    const Fold& f = folds_[static_cast<std::size_t>(a.fold)];
    node.is_leaf = false;
    node.is_max = f.is_max;
    node.left = add_nodes(f.left, formula, tape_of);
    node.right = add_nodes(f.right, formula, tape_of);
  } else {
    const auto [at, is_new] = tape_of.try_emplace(a.operation, static_cast<int>(formula.tapes.size()));
    if (is_new) formula.tapes.push_back(needed_for(tape_, a.operation));
    node.tape = at->second;
  }
  formula.nodes.push_back(node);
  return static_cast<int>(formula.nodes.size()) - 1;
}

Part Parser::fold(bool is_max, const Part& a, const Part& b) {
  if (a.is_number() && b.is_number())
    return {a.column, -1, is_max ? std::max(a.number, b.number) : std::min(a.number, b.number)};
  for (const Part* p : {&a, &b})
    if (p->is_number()) refuse(p->column, "a number in max, min or abs is no boundary");
  if (!a.is_fold() && a.operation == b.operation) return a;
  if (++n_leaves_ > kMostLeaves) refuse(a.column, "max, min and abs make more than 256 smooth functions");
  folds_.push_back({is_max, a, b});
  Part p{a.column};
  p.fold = static_cast<int>(folds_.size()) - 1;
  return p;
}

/// f of every smooth part. @param turns  f decreases: max becomes min
template <class F>
Part Parser::distribute(const Part& a, bool turns, const F& f) {
  if (!a.is_fold()) return f(a);
  const Fold of = folds_[static_cast<std::size_t>(a.fold)];  // a copy: the list grows
  const Part left = distribute(of.left, turns, f), right = distribute(of.right, turns, f);
  return fold(of.is_max != turns, left, right);
}

Part Parser::negative(const Part& a, std::size_t column) {
  return distribute(a, true, [&](const Part& b) {
    return b.is_number() ? constant(-b.number, column, column) : operation(Operator::SubtractFrom, column, b.operation);
  });
}

void Parser::refuse_fold(const Part& a, const char* where) const {
  if (a.is_fold()) refuse(a.column, std::string("max, min or abs in ") + where + ": the edge cannot be found");
}

/// The arguments of max, min or abs, behind the bracket.
Part Parser::fold_of_arguments(std::string_view name, std::size_t column) {
  Part a = sum();
  if (name == "abs" || name == "fabs") {
    a = a.is_number() ? Part{a.column, -1, std::abs(a.number)} : fold(true, a, negative(a, column));
  } else {
    if (peek() != ',') refuse(at_ + 1, std::string(name) + " needs two arguments or more, between commas");
    while (take(',')) a = fold(name == "max", a, sum());
  }
  if (!take(')')) at_ < text_.size() ? refuse_next() : refuse(at_ + 1, "a closing bracket is missing");
  return a;
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
    a = negative(b, column);
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
  if (has_folds_ && std::find(kFolds.begin(), kFolds.end(), name) != kFolds.end()) {
    at_ = end;
    if (!take('(')) refuse(column, std::string(name) + " needs its arguments in brackets");
    return fold_of_arguments(name, column);
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
  if (a.is_fold()) {
    if (std::find(kIncreasing.begin(), kIncreasing.end(), f) == kIncreasing.end())
      refuse_fold(a, "a function that does not increase");
    return distribute(a, false, [&](const Part& b) { return unary(f, b, column); });
  }
  if (!a.is_number()) return operation(f, column, a.operation);
  const double value = apply(f, a.number);
  if (f == Operator::Log && a.number == 0) refuse(a.column, "no value: log of zero");
  if (f == Operator::Tan && std::abs(value) > kPole) refuse(a.column, "no value: tan has a pole here");
  return constant(value, column, column);
}

Part Parser::binary(Operator f, const Part& a, const Part& b) {
  if (a.is_fold() || b.is_fold()) {
    const bool is_sum = f == Operator::Add || f == Operator::Subtract;
    if (!is_sum && !a.is_number()) refuse_fold(b, f == Operator::Multiply ? "a product" : "a divisor");
    if (!is_sum && !b.is_number()) refuse_fold(a, f == Operator::Multiply ? "a product" : "a quotient");
    if (f == Operator::Divide) refuse_fold(b, "a divisor");
    if (a.is_fold()) {
      if (f == Operator::Multiply && b.number == 0) return {a.column, -1, 0};
      const bool turns = !is_sum && b.number < 0;
      return distribute(a, turns, [&](const Part& part) { return binary(f, part, b); });
    }
    if (f == Operator::Multiply && a.number == 0) return {a.column, -1, 0};
    const bool turns = f == Operator::Subtract || (f == Operator::Multiply && a.number < 0);
    return distribute(b, turns, [&](const Part& part) { return binary(f, a, part); });
  }
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
  refuse_fold(base, "a power");
  refuse_fold(exponent, "a power");
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

Tape parse_formula(const std::string& text, std::optional<double> t) { return Parser(text, t, false).parse(); }

PiecewiseFormula parse_piecewise_formula(const std::string& text, std::optional<double> t) {
  return Parser(text, t, true).parse_piecewise();
}

}  // namespace umtet
