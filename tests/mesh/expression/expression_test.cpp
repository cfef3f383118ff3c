#include "mesh/expression/expression.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "mesh/core/implicit_function.h"

namespace umtet {
namespace {

const Vec3 kProbe(.7, -1.3, 1.9);

TEST(Expression, ReadsSignsAndPowersAsMathematicsDoes) {
  const double x = kProbe[0], y = kProbe[1], z = kProbe[2];
  const std::pair<const char*, double> cases[] = {
      {"-x^2", -x * x},
      {"(-x)^2", x * x},
      {"x+2^-1", x + .5},
      {"x^2^3", std::pow(x, 8)},
      {"2^3^2*x", 512 * x},
      {"x-y-z", x - y - z},
      {"x/y/z", x / y / z},
      {"x/y*z", x / y * z},
      {"2*-x", -2 * x},
      {"+x", x},
      {"x^-2", 1 / (x * x)},
      {"-x^-2", -1 / (x * x)},
      {"2^-x", std::pow(2, -x)},
      {"1e-3*x + 2.5E2", 1e-3 * x + 250},
      {" .5 * x + 5. ", .5 * x + 5},
      {"007*x", 7 * x},
      {"x + 1/3", x + 1. / 3},
      {"log(z) + x*exp(1)", std::log(z) + x * std::exp(1)},
      {"sqrt(x)+x^.5+x^(1/3)", 2 * std::sqrt(x) + std::cbrt(x)},
      {"sin(pi*x)*cos(y)-tan(z)", std::sin(M_PI * x) * std::cos(y) - std::tan(z)},
      {"asin(x)+acos(x/2)+atan(z)", std::asin(x) + std::acos(x / 2) + std::atan(z)},
      {"sinh(x)+cosh(y)+tanh(z)", std::sinh(x) + std::cosh(y) + std::tanh(z)},
  };
  for (const auto& [text, expected] : cases) {
    // 8 ulp of the largest term: powers are products.
    EXPECT_NEAR(Expression(text).value(kProbe), expected, 2e-15 * std::max(1., std::abs(expected))) << text;
  }
}

TEST(Expression, DecimalNumbersAreExact) {
  EXPECT_EQ(Expression("x+0.1").value(Vec3::Zero()), 0.1);
  EXPECT_EQ(Expression("x+1234567890.123").value(Vec3::Zero()), 1234567890.123);
  EXPECT_EQ(Expression("x+1e300").value(Vec3::Zero()), 1e300);
}

void expect_derivatives_match_central_differences(const std::string& text, const Vec3& x) {
  const Expression psi(text);
  Vec3 g;
  Mat3 H;
  EXPECT_EQ(psi.evaluate(x, &g, &H), psi.value(x)) << text;
  const ImplicitFunctionRef f = psi;
  EXPECT_EQ(g, f.gradient(x)) << text;
  const double step = 1e-5;  // truncation step^2 f''' / 6 ~ 1e-10 * |f'''|, rounding 1e-16 / step ~ 1e-11
  for (int i = 0; i < 3; ++i) {
    const Vec3 e = step * Vec3::Unit(i);
    const double scale = std::max(1., g.norm()) + H.norm();
    EXPECT_NEAR((psi.value(x + e) - psi.value(x - e)) / (2 * step), g[i], 1e-7 * scale) << text;
    const Vec3 row = (f.gradient(x + e) - f.gradient(x - e)) / (2 * step);
    EXPECT_LT((row - H.col(i)).norm(), 1e-7 * scale) << text;
  }
  EXPECT_EQ(H, H.transpose());
}

TEST(Expression, DerivativesMatchCentralDifferences) {
  for (const char* text : {"x^2+y^2+z^2-1", "(sqrt(x^2+y^2)-1)^2+z^2-.16", "sin(3*x)*exp(y*z)+x/(2+y^2)",
                           "atan(x*y)+log(5+z)^3-cosh(x-z)", "(x^2+9/4*y^2+z^2-1)^3-x^2*z^3-9/80*y^2*z^3", "2^(x*z)",
                           "x^(y*z)+(x+z)^(1+x*y)", "tan(x*y)*asin(x/3)-tanh(z)/acos(.1*y)",
                           "x^5-.1*(x-y*z)^7+(x*y+z)^11-x^-3*y^-6", "(x*y)^1.5*-(x*y)^2.5+sqrt(x*z)*x^-.5"}) {
    expect_derivatives_match_central_differences(text, Vec3(.7, 1.3, 1.1));
  }
}

/// before ... before middle after ... after
std::string repeated(int n, const std::string& before, const std::string& middle, const std::string& after) {
  std::string text;
  for (int k = 0; k < n; ++k) text += before;
  text += middle;
  for (int k = 0; k < n; ++k) text += after;
  return text;
}

TEST(Expression, BracketsAndSignsHaveALimit) {
  EXPECT_EQ(Expression(repeated(400, "(", "x", ")")).value(kProbe), kProbe.x());
  for (const std::string& text :
       {repeated(2000, "(", "x", ")"), repeated(4000, "-", "x", ""), repeated(2000, "x^", "x", "")}) {
    EXPECT_THROW(Expression{text}, ExpressionError);
  }
}

TEST(Expression, LongFormulasHaveDerivatives) {
  // In closed form their second derivatives have a million to fifty million terms.
  std::string product = "x", balls = "y";
  for (int k = 1; k < 150; ++k) product += "*(1+sin(x+y/" + std::to_string(k) + ")/99)";
  for (int k = 1; k < 80; ++k) balls += "+exp(-((x-." + std::to_string(k) + ")^2+(y-.2)^2+(z-.3)^2)/.1)";
  for (const std::string& text :
       {repeated(300, "x*(1+", "y*z", ")"), repeated(200, "sin(z+x*", "y", ")"), product, balls}) {
    expect_derivatives_match_central_differences(text, Vec3(.4, .3, .2));
  }
}

TEST(Expression, PowersOfPowersAreWhatTheyLookLike) {
  double tower = 2;
  std::string text = "z";
  for (int k = 0; k < 90; ++k) {  // found by fuzzing: it took minutes
    text = "y^.5^" + text;
    tower = std::pow(.4, std::pow(.5, tower));
  }
  EXPECT_NEAR(Expression(text).value({0, .4, 2}), tower, 1e-15);
  EXPECT_EQ(Expression("x^184467440737051615^-12+y^9").value({2, 1, 0}), 2);
}

TEST(Expression, TowersOfNumbersAreRefusedBeforeTheyAreComputed) {
  // Found by fuzzing. Such a number is infinite as a double.
  for (const char* text : {"x*9^9^9^9^.3", "x*3^-9^9^9^9^.3", "x*exp(exp(1000))", "x*2^exp(9)"}) {
    try {
      Expression{text};
      ADD_FAILURE() << text;
    } catch (const ExpressionError& e) {
      EXPECT_NE(std::string(e.what()).find("out of range"), std::string::npos) << e.what();
    }
  }
  EXPECT_NEAR(Expression("x*2^pi^.5").value({1, 0, 0}), std::pow(2, std::sqrt(std::acos(-1))), 1e-14);
}

TEST(Expression, RefusalsNameTheColumn) {
  const std::pair<const char*, std::size_t> cases[] = {{"", 1},           {"   ", 1},         {"x y", 3},
                                                       {"x^2+foo(y)", 5}, {"x**2", 3},        {"x)", 2},
                                                       {"x+", 3},         {"((((", 5},        {"x+abs(y)", 3},
                                                       {"x, y", 2},       {"x = y", 3},       {"x<y", 2},
                                                       {"x?y:z", 2},      {"\"x\"", 1},       {"1e999*x", 1},
                                                       {"x+1/0", 5},      {"x+0^z", 1},  // a value, but no derivative
                                                       {"x/(1-1)", 4},    {"log(0)+x", 5},    {"x^1001", 3},
                                                       {"9^9^9^9", 5},    {"(x^900)^900", 9}, {"3+4", 1},
                                                       {"sqrt(-1)*x", 1}, {"tan(pi/2)*x", 5}, {"x^2 + y^2 $", 11},
                                                       {"2x", 2},         {"x*0", 1},         {"(-2)^x", 1},
                                                       {"1.2.3*x", 4},    {"sin x", 1},       {"sin()", 5},
                                                       {"x+sin(x", 8},    {"e*x", 1},         {"_pi*x", 1},
                                                       {"x\xc3\xa9", 2},  {"t+x", 1},         {"1e9999999999*x", 1}};
  for (const auto& [text, column] : cases) {
    try {
      Expression psi(text);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const ExpressionError& e) {
      EXPECT_EQ(e.column, column) << text << "\n" << e.what();
      EXPECT_NE(std::string(e.what()).find("column " + std::to_string(column)), std::string::npos);
    }
  }
}

TEST(Expression, RefusalsSayWhatIsWrongInWholeCharacters) {
  const std::pair<const char*, const char*> cases[] = {{"x**2", "unexpected \"*\" (a power is written x^2)"},
                                                       {"min(x,y)", "column 1: min is not smooth"},
                                                       {"x+\xc3\xa9", "unexpected character \xc3\xa9\n"},
                                                       {"x*/2", "unexpected \"/\""}};
  for (const auto& [text, message] : cases) {
    try {
      Expression psi(text);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const ExpressionError& e) {
      EXPECT_NE(std::string(e.what()).find(message), std::string::npos) << e.what();
    }
  }
}

TEST(Expression, AnyTextIsAnExpressionOrARefusal) {
  const std::vector<std::string> tokens = {"x", "y", "z", "pi", "1",    "0",    ".5",   "2", "+",   "-",    "*", "/",
                                           "^", "(", ")", " ",  "sin(", "log(", "sqrt", "e", "1e3", "tan(", "-", ","};
  unsigned long state = 1;
  int accepted = 0;
  for (int n = 0; n < 6000; ++n) {
    std::string text;
    for (int k = 0; k < 1 + n % 9; ++k) {
      state = state * 6364136223846793005ul + 1442695040888963407ul;
      text += tokens[(state >> 33) % tokens.size()];
    }
    try {
      Expression(text).value(kProbe);
      ++accepted;
    } catch (const ExpressionError& e) {
      EXPECT_GE(e.column, 1u);
      EXPECT_LE(e.column, text.size() + 1) << text;
    }
  }
  EXPECT_GT(accepted, 100);  // else the generator tests refusals only
}

TEST(Expression, TimeIsTheDecimalNumberItLooksLike) {
  EXPECT_EQ(Expression("x+1e20*(10*t-1)", .1).value({2, 0, 0}), 2);  // with the double nearest to .1 it is 5553
  EXPECT_EQ(Expression("x*t", -.5).value({3, 0, 0}), -1.5);
  EXPECT_EQ(Expression("sin(t*x)+y", 0.).value({3, 4, 0}), 4);
  EXPECT_EQ(ImplicitFunctionRef(Expression("x^t", 3.)).gradient({2, 0, 0}).x(), 12);
  EXPECT_EQ(Expression("x+t", 1e-5).value({1, 0, 0}), 1 + 1e-5);
  EXPECT_THROW(Expression("x+t"), ExpressionError);
  EXPECT_THROW(Expression("1/t+x", 0.), ExpressionError);
}

TEST(Expression, EveryReadingOfATextIsTheSameFunction) {
  // Sums with terms of both signs as factors and as bases.
  for (const char* text :
       {"((.6*(x-.3)-.8*y+1/7*z-1.1)^2+(.8*(x-.3)+.6*y-z/3)^2-1)*((.3*x-.7*z+y/9)^3-(y-.1*x)^2+.9)",
        "(x-.1*y)*(z-x/3)*(y-.7*z)-(.1*x-.2*y+.4)^5", "((x-.3*y)^2*(z-.7)-(y-z/3)^3)^-2*(x-z*(y-.9*x))-.1",
        "sin((x-.3*y)*(y-z/7))/(x-1.7*y-.1*z)^2-exp((z-.3*x)^3)", "((x-.3*y)*sqrt(x-y/7)-(x-.3*y)^2)^3+(x-z/9)^y"}) {
    const Expression first(text);
    for (int n = 0; n < 50; ++n) {
      const Expression again(text);
      for (int k = 0; k < 20; ++k) {
        const Vec3 x(3 + std::sin(k), std::cos(2. * k), std::sin(3. * k));
        Vec3 g, same_g;
        Mat3 H, same_H;
        ASSERT_EQ(first.value(x), again.value(x)) << text;
        first.evaluate(x, &g, nullptr);
        again.evaluate(x, &same_g, nullptr);
        ASSERT_EQ(g, same_g) << text;
        ASSERT_EQ(first.evaluate(x, &g, &H), again.evaluate(x, &same_g, &same_H)) << text;
        ASSERT_EQ(H, same_H) << text;
        ASSERT_EQ(g, same_g) << text;
      }
    }
  }
}

TEST(Expression, ThreadsSeeTheSameFunction) {
  const Expression psi("sin(3*x)*exp(y*z)+x^3-.1");
  const int n = 20000;
  std::vector<double> parallel(n);
  const auto point = [](int i) { return Vec3(std::sin(i), std::cos(2. * i), std::sin(3. * i)); };
  tbb::parallel_for(0, n, [&](int i) { parallel[i] = psi.value(point(i)); });
  for (int i = 0; i < n; ++i) ASSERT_EQ(parallel[i], psi.value(point(i)));
}

TEST(Expression, BlanksAndLineBreaksDoNotCount) {
  const Vec3 x(.3, -.2, .7);
  EXPECT_EQ(Expression("x ^2\n\t+ y*\r\n z").value(x), Expression("x^2+y*z").value(x));
}

}  // namespace
}  // namespace umtet
