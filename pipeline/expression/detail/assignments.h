#pragma once

#include <string>
#include <utility>
#include <vector>

namespace umtet {

/// A formula and its derivatives as assignments in muParser's language, to be executed in this order.
struct Assignments {
  std::vector<std::pair<std::string, std::string>> texts;  ///< name, and text in earlier names, constants, x, y, z
  std::vector<std::pair<std::string, double>> constants;
  std::vector<std::string> results;  ///< texts of psi; its derivatives x y z; xx xy xz yy yz zz; an empty text is 0
};

/// Inlines texts that are used once and are not the base of a power: an assignment costs muParser as much as five
/// operations.
void inline_single_uses(Assignments& all);

}  // namespace umtet
