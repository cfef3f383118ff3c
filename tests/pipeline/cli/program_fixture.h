#pragma once

// The built program, called from outside, in a folder of its own with the cloud of an egg.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace umtet {
namespace fs = std::filesystem;
using Json = nlohmann::json;

inline std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream s;
  s << in.rdbuf();
  return s.str();
}

/// Removes the block that is different every time.
inline std::string without_run(const fs::path& file) {
  Json json = Json::parse(content(file));
  json.erase("run");
  return json.dump();
}

class Program : public ::testing::Test {
 protected:
  struct Result {
    int code;
    std::string out, err;
  };

  void SetUp() override {
    fs::remove_all(folder);
    fs::create_directories(folder);
    // 600 points of an ellipsoid with half axes 1, .8, .6.
    std::ofstream ply(cloud);
    ply.precision(17);
    ply << "ply\nformat ascii 1.0\nelement vertex 600\n";
    for (const char* p : {"x", "y", "z", "nx", "ny", "nz"}) ply << "property double " << p << "\n";
    ply << "end_header\n";
    for (int i = 0; i < 600; ++i) {
      const double z = 1 - (2 * i + 1) / 600., r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
      const double u[3] = {r * std::cos(a), r * std::sin(a), z}, n[3] = {u[0], u[1] / .8, u[2] / .6};
      const double l = std::hypot(n[0], n[1], n[2]);
      ply << u[0] << ' ' << .8 * u[1] << ' ' << .6 * u[2] << ' ' << n[0] / l << ' ' << n[1] / l << ' ' << n[2] / l
          << '\n';
    }
  }
  void TearDown() override { fs::remove_all(folder); }

  /// Arguments are words without quotes; `shell` goes in front, e.g. "ulimit -f 100;".
  Result run(const std::string& arguments, const std::string& shell = "") const {
    const fs::path out = folder / "stdout", err = folder / "stderr";
    const std::string call = "cd '" + folder.string() + "'; " + shell + " '" + UMTET_PROGRAM + "' " + arguments +
                             " >'" + out.string() + "' 2>'" + err.string() + "'";
    const int status = std::system(call.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content(out), content(err)};
  }
  /// A cloud of the given points and normals.
  void write_cloud(const std::string& name, const std::function<std::string(const double (&)[6])>& line_of) const {
    std::istringstream in(content(cloud));
    std::ofstream out(folder / name);
    out.precision(17);
    std::string line;
    while (std::getline(in, line) && line != "end_header") out << line << '\n';
    out << line << '\n';
    double x[6];
    while (in >> x[0] >> x[1] >> x[2] >> x[3] >> x[4] >> x[5]) out << line_of(x) << '\n';
  }
  /// Every file of a case but what no one looks at.
  std::map<fs::path, std::string> files_of(const std::string& name) const {
    std::map<fs::path, std::string> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder / name)) {
      const std::string path = entry.path().string();
      if (!entry.is_regular_file() || path.ends_with(".lock") || path.find("/.next/") != std::string::npos) continue;
      files[entry.path()] = content(entry.path());
    }
    return files;
  }
  std::string name_in(const fs::path& p) const { return (folder / p).string(); }

  const fs::path folder = fs::temp_directory_path() / ("umtet_program_" + std::to_string(::getpid()));
  const fs::path cloud = folder / "egg.ply";
  const std::string ball = "mesh --implicit 'x^2+y^2+z^2-1' --box -1.3,-1.3,-1.3,1.3,1.3,1.3 --tets 3000 -o ball ";
};

}  // namespace umtet
