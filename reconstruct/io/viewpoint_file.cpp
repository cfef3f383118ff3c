#include "reconstruct/io/viewpoint_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>

#include "reconstruct/cloud/cloud_file.h"

namespace umtet {

std::vector<Vec3> read_viewpoints(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::system_error(errno, std::generic_category(), file.string() + ": cannot be opened");
  std::vector<Vec3> points;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    std::istringstream words(line.substr(0, line.find('#')));
    Vec3 x;
    if (!(words >> std::ws) || words.eof()) continue;
    if (!(words >> x[0] >> x[1] >> x[2]) || !x.allFinite()) {
      throw CloudRefused(
          fmt::format("{}:{}: not three numbers; a line of a viewpoint is x y z", file.string(), number));
    }
    points.push_back(x);
  }
  if (points.empty()) throw CloudRefused(file.string() + ": no viewpoint; give lines x y z");
  return points;
}

}  // namespace umtet
