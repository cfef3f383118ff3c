#include "pipeline/expression/detail/chain_rule.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <locale>
#include <map>
#include <sstream>
#include <unordered_map>

namespace umtet {
namespace {

constexpr std::array<std::pair<std::size_t, std::size_t>, 6> kPairs{{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};

/// The value and the derivatives of an operation, as names and digits; an empty text is 0.
struct Term {
  std::string value;
  std::array<std::string, 3> gradient;
  std::array<std::string, 6> hessian;
};

/// The partial derivatives of an operation with two operands; with one operand, the derivatives with respect to the
/// other are 0.
struct Partials {
  std::array<std::string, 2> first;
  std::array<std::string, 3> second;  ///< 00 01 11
};

/// Products and sums of texts; an empty text is 0.
std::string times(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return "";
  return a == "1" ? b : b == "1" ? a : a + "*" + b;
}
std::string plus(const std::string& a, const std::string& b) { return a.empty() ? b : b.empty() ? a : a + "+" + b; }

bool is_number(const GiNaC::ex& e) {
  if (GiNaC::is_a<GiNaC::symbol>(e)) return false;
  return std::all_of(e.begin(), e.end(), is_number);
}

class Writer {
 public:
  explicit Writer(int order) : order_(order) {}

  Assignments write_all(const GiNaC::ex& psi);

 private:
  const std::string& key(const GiNaC::ex& e);
  std::vector<GiNaC::ex> operands(const GiNaC::ex& e);
  bool begins_with_minus(const GiNaC::ex& sum);
  GiNaC::ex with_signs(const GiNaC::ex& e);
  GiNaC::ex factor(const GiNaC::ex& e);
  std::string keep(const std::string& text);
  std::string number(const GiNaC::ex& e);
  std::string write(const GiNaC::ex& e);
  std::string write_power(const std::string& base, const GiNaC::ex& exponent);
  Term kept(const Term& t);
  Term term(const GiNaC::ex& e);
  Term sum(const std::vector<GiNaC::ex>& terms);
  Term product(const Term& a, const Term& b);
  Term operation(const GiNaC::ex& e);
  void differentiate(Term& f, const Partials& partials, const Term& a, const Term& b) const;

  const int order_;
  Assignments result_;
  std::unordered_map<std::string, std::string> names_;  ///< text -> name
  std::map<GiNaC::ex, std::string, GiNaC::ex_is_less> keys_;
  std::map<std::string, std::pair<GiNaC::realsymbol, GiNaC::ex>> sums_;  ///< key -> the symbol of that name, the sum
};

/// Returns e as text. Operands of sums and products are in the order of their keys: GiNaC's order depends on addresses,
/// and rounding would differ from run to run.
const std::string& Writer::key(const GiNaC::ex& e) {
  if (const auto known = keys_.find(e); known != keys_.end()) return known->second;
  std::ostringstream text;
  text.imbue(std::locale::classic());
  if (e.nops() == 0) {
    text << e;
  } else {
    text << (GiNaC::is_a<GiNaC::function>(e) ? GiNaC::ex_to<GiNaC::function>(e).get_name()
             : GiNaC::is_a<GiNaC::add>(e)    ? "+"
             : GiNaC::is_a<GiNaC::mul>(e)    ? "*"
                                             : "^");
    for (const GiNaC::ex& operand : operands(e)) text << '(' << key(operand) << ')';
  }
  return keys_[e] = text.str();
}

std::vector<GiNaC::ex> Writer::operands(const GiNaC::ex& e) {
  std::vector<GiNaC::ex> all(e.begin(), e.end());
  if (GiNaC::is_a<GiNaC::add>(e) || GiNaC::is_a<GiNaC::mul>(e)) {
    std::sort(all.begin(), all.end(), [this](const GiNaC::ex& a, const GiNaC::ex& b) { return key(a) < key(b); });
  }
  return all;
}

/// Returns whether the term with the smallest key, ignoring signs and numbers, is negative.
bool Writer::begins_with_minus(const GiNaC::ex& sum) {
  std::string least;
  bool is_negative = false;
  for (const GiNaC::ex& term : sum) {
    if (GiNaC::is_a<GiNaC::numeric>(term)) continue;
    GiNaC::numeric coefficient(1);
    if (GiNaC::is_a<GiNaC::mul>(term)) {
      for (const GiNaC::ex& factor : term) {
        if (GiNaC::is_a<GiNaC::numeric>(factor)) coefficient = GiNaC::ex_to<GiNaC::numeric>(factor);
      }
    }
    const std::string& name = key(term / coefficient);
    if (!least.empty() && least < name) continue;
    least = name;
    is_negative = coefficient.is_negative();
  }
  return is_negative;
}

/// Returns e with symbols in place of sums that are factors or bases of whole powers. From such sums GiNaC extracts the
/// sign of their first term. Which term is first depends on addresses, and on the number of symbols created before;
/// here it is the term with the smallest key.
GiNaC::ex Writer::with_signs(const GiNaC::ex& e) {
  if (is_number(e)) return e;
  if (GiNaC::is_a<GiNaC::function>(e)) {
    return GiNaC::function(GiNaC::ex_to<GiNaC::function>(e).get_serial(), with_signs(e.op(0)));
  }
  if (GiNaC::is_a<GiNaC::power>(e)) {
    const bool is_whole = e.op(1).info(GiNaC::info_flags::integer);
    // GiNaC writes (1/u)^1.5 as u^-1.5, but not (-1/v)^1.5, which is the same where v is -u.
    if (!is_whole && e.op(1).info(GiNaC::info_flags::positive)) {
      const GiNaC::ex u = -1 / e.op(0);
      if (GiNaC::is_a<GiNaC::add>(u)) return GiNaC::pow(-with_signs(u), -e.op(1));
    }
    return GiNaC::pow(is_whole ? factor(e.op(0)) : with_signs(e.op(0)), with_signs(e.op(1)));
  }
  if (!GiNaC::is_a<GiNaC::add>(e) && !GiNaC::is_a<GiNaC::mul>(e)) return e;
  GiNaC::exvector parts;
  for (const GiNaC::ex& part : e) parts.push_back(GiNaC::is_a<GiNaC::add>(e) ? with_signs(part) : factor(part));
  return GiNaC::is_a<GiNaC::add>(e) ? GiNaC::ex(GiNaC::add(parts)) : GiNaC::ex(GiNaC::mul(parts));
}

GiNaC::ex Writer::factor(const GiNaC::ex& e) {
  if (is_number(e) || !GiNaC::is_a<GiNaC::add>(e)) return with_signs(e);
  GiNaC::ex s = with_signs(e);
  const int sign = begins_with_minus(s) ? -1 : 1;
  s = sign * s;
  const std::string name = key(s);
  return sign * sums_.try_emplace(name, GiNaC::realsymbol(name), s).first->second.first;
}

/// Assigns `text` to a name and returns the name; returns `text` if it is a name or digits.
std::string Writer::keep(const std::string& text) {
  if (std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isalnum(c); })) return text;
  const auto [known, is_new] = names_.try_emplace(text, "v" + std::to_string(result_.texts.size()));
  if (is_new) result_.texts.emplace_back(known->second, text);
  return known->second;
}

/// Returns the double nearest to a number, as a name; NaN if it is not real, as asin(2).
std::string Writer::number(const GiNaC::ex& e) {
  const GiNaC::ex value = e.evalf();
  const bool is_real = GiNaC::is_a<GiNaC::numeric>(value) && GiNaC::ex_to<GiNaC::numeric>(value).is_real();
  const double v = is_real ? GiNaC::ex_to<GiNaC::numeric>(value).to_double() : std::numeric_limits<double>::quiet_NaN();
  if (v == 1) return "1";  // times() handles 1
  const std::string name = "k" + std::to_string(result_.constants.size());
  const auto [known, is_new] = names_.try_emplace("number " + key(e), name);
  if (is_new) result_.constants.emplace_back(name, v);
  return known->second;
}

/// Writes products and roots instead of muParser's ^, which is pow() except for squares, cubes and fourth powers of a
/// name.
std::string Writer::write_power(const std::string& base, const GiNaC::ex& exponent) {
  if (GiNaC::is_a<GiNaC::numeric>(exponent)) {
    const GiNaC::numeric n = GiNaC::ex_to<GiNaC::numeric>(exponent);
    if (n.is_negative()) return "1/" + keep(write_power(base, -n));
    if (n == GiNaC::numeric(1, 2)) return "sqrt(" + base + ")";
    if (n.is_integer() && n <= 64) {
      const int k = n.to_int();
      if (k == 1) return base;
      if (k <= 4) return base + "^" + std::to_string(k);
      if (k <= 8) return write_power(base, (k + 1) / 2) + "*" + write_power(base, k / 2);
      if (k % 2 == 0) return keep(write_power(base, k / 2)) + "^2";
      return base + "*" + keep(write_power(base, k - 1));
    }
  }
  return base + "^" + write(exponent);
}

/// Assigns the parts of an expression in names, such as a partial derivative. \return its name
std::string Writer::write(const GiNaC::ex& e) {
  if (is_number(e)) return number(e);
  if (GiNaC::is_a<GiNaC::symbol>(e)) return key(e);
  if (GiNaC::is_a<GiNaC::power>(e)) return keep(write_power(write(e.op(0)), e.op(1)));
  if (GiNaC::is_a<GiNaC::function>(e)) {
    return keep(GiNaC::ex_to<GiNaC::function>(e).get_name() + "(" + write(e.op(0)) + ")");
  }
  std::string text;
  for (const GiNaC::ex& operand : operands(e)) {
    text = GiNaC::is_a<GiNaC::add>(e) ? plus(text, write(operand)) : times(text.empty() ? "1" : text, write(operand));
  }
  return keep(text);
}

/// Sets the derivatives of f(a, b).
void Writer::differentiate(Term& f, const Partials& partials, const Term& a, const Term& b) const {
  const auto& [f_a, f_b] = partials.first;
  const auto& [f_aa, f_ab, f_bb] = partials.second;
  for (std::size_t i = 0; i < 3; ++i) f.gradient[i] = plus(times(f_a, a.gradient[i]), times(f_b, b.gradient[i]));
  for (std::size_t m = 0; m < 6; ++m) {
    const auto [i, j] = kPairs[m];
    const auto second = [&, i = i, j = j](const std::string& f_kl, const Term& k, const Term& l) {
      return times(f_kl, times(k.gradient[i], l.gradient[j]));
    };
    f.hessian[m] =
        plus(plus(times(f_a, a.hessian[m]), times(f_b, b.hessian[m])),
             plus(plus(second(f_aa, a, a), second(f_bb, b, b)), plus(second(f_ab, a, b), second(f_ab, b, a))));
  }
}

Term Writer::sum(const std::vector<GiNaC::ex>& terms) {
  Term all;
  for (const GiNaC::ex& e : terms) {
    const Term t = term(e);
    all.value = plus(all.value, t.value);
    for (std::size_t i = 0; i < 3; ++i) all.gradient[i] = plus(all.gradient[i], t.gradient[i]);
    for (std::size_t m = 0; m < 6; ++m) all.hessian[m] = plus(all.hessian[m], t.hessian[m]);
  }
  return all;
}

Term Writer::product(const Term& a, const Term& b) {
  Term f;
  f.value = times(a.value, b.value);
  differentiate(f, {{b.value, a.value}, {"", order_ > 1 ? "1" : "", ""}}, a, b);
  return f;
}

/// Handles a power or a function: its partial derivatives are the derivatives of the same operation on symbols named as
/// the operands.
Term Writer::operation(const GiNaC::ex& e) {
  std::vector<Term> of;
  GiNaC::exvector names;
  for (const GiNaC::ex& operand : operands(e)) {
    of.push_back(term(operand));
    names.push_back(is_number(operand) ? operand : GiNaC::ex(GiNaC::realsymbol(of.back().value)));
  }
  const bool is_power = GiNaC::is_a<GiNaC::power>(e);
  const GiNaC::ex f = is_power ? GiNaC::pow(names[0], names[1])
                               : GiNaC::ex(GiNaC::function(GiNaC::ex_to<GiNaC::function>(e).get_serial(), names[0]));
  Term t;
  t.value = write(f);
  const GiNaC::realsymbol value(t.value);
  const auto by = [](const GiNaC::ex& g, const GiNaC::ex& name) {
    return GiNaC::is_a<GiNaC::symbol>(name) ? g.diff(GiNaC::ex_to<GiNaC::symbol>(name)) : GiNaC::ex(0);
  };
  const auto text = [&](const GiNaC::ex& g) { return g.is_zero() ? "" : write(g.subs(f == value)); };
  of.resize(2);  // the second operand of a function is 0
  names.resize(2);
  Partials partials;
  for (std::size_t k = 0; order_ > 0 && k < 2; ++k) partials.first[k] = text(by(f, names[k]));
  for (std::size_t k = 0; order_ > 1 && k < 3; ++k) {
    partials.second[k] = text(by(by(f, names[k / 2]), names[(k + 1) / 2]));
  }
  differentiate(t, partials, of[0], of[1]);
  return t;
}

Term Writer::kept(const Term& t) {
  Term names;
  names.value = keep(t.value);
  for (std::size_t i = 0; i < 3; ++i) names.gradient[i] = keep(t.gradient[i]);
  for (std::size_t m = 0; m < 6; ++m) names.hessian[m] = keep(t.hessian[m]);
  return names;
}

/// Assigns the value and derivatives of e.
Term Writer::term(const GiNaC::ex& e) {
  Term t;
  if (is_number(e)) {
    t.value = number(e);
    return t;
  }
  if (GiNaC::is_a<GiNaC::symbol>(e)) {
    t.value = key(e);
    if (const auto s = sums_.find(t.value); s != sums_.end()) return kept(sum(operands(s->second.second)));
    if (order_ > 0) t.gradient[static_cast<std::size_t>(t.value[0] - 'x')] = "1";
    return t;
  }
  if (GiNaC::is_a<GiNaC::add>(e)) return kept(sum(operands(e)));
  if (!GiNaC::is_a<GiNaC::mul>(e)) return kept(operation(e));
  t.value = "1";
  for (const GiNaC::ex& factor : operands(e)) t = kept(product(t, term(factor)));
  return t;
}

Assignments Writer::write_all(const GiNaC::ex& psi) {
  const Term t = term(with_signs(psi));
  result_.results = {t.value};
  if (order_ > 0) result_.results.insert(result_.results.end(), t.gradient.begin(), t.gradient.end());
  if (order_ > 1) result_.results.insert(result_.results.end(), t.hessian.begin(), t.hessian.end());
  return std::move(result_);
}

}  // namespace

Assignments chain_rule(const GiNaC::ex& psi, int order) {
  Assignments all = Writer(order).write_all(psi);
  inline_single_uses(all);
  return all;
}

}  // namespace umtet
