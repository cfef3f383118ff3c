#pragma once

#include <string>
#include <utility>
#include <vector>

namespace umtet {

/// A formula and its derivatives as assignments in muParser's language, to be made in this order.
struct Assignments {
  std::vector<std::pair<std::string, std::string>> texts;  ///< name, text in earlier names, constants, x, y, z
  std::vector<std::pair<std::string, double>> constants;
  std::vector<std::string> results;  ///< texts of psi; its x y z; its xx xy xz yy yz zz; the empty one is 0
};

/// An assignment costs muParser as much as five operations: what is used once, and is no base of a power, is written
/// where it is used.
void inline_single_uses(Assignments& all);

}  // namespace umtet
