#include "mesh/expression/expression.h"

#include <utility>

#include "mesh/expression/formula_parser.h"

namespace umtet {

ExpressionError::ExpressionError(const std::string& text, std::size_t column, const std::string& message)
    : std::runtime_error("column " + std::to_string(column) + ": " + message + "\n  " + text + "\n  " +
                         std::string(column - 1, ' ') + "^"),
      column(column) {}

Expression::Expression(std::string text, std::optional<double> t)
    : text_(std::move(text)), tape_(parse_formula(text_, t)) {}

}  // namespace umtet
