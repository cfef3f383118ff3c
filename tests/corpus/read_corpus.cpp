// read_corpus FILE ...: what the libraries say to files of the corpus, without the program around them. A line for
// every file and reader: file, reader and answer with tabs between them; the answer is `accepted` or the words of a
// refusal. corpus_test.py compares them with its table.

#include <cstdio>
#include <filesystem>
#include <string>

#include "mesh/io/tet_mesh_io.h"
#include "reconstruct/io/feature_lines_io.h"
#include "reconstruct/io/grid_io.h"
#include "reconstruct/io/level_set_io.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/io/triangle_mesh_io.h"

namespace {

template <class Refusal, class Read>
void answer(const std::filesystem::path& file, const char* reader, Read read) {
  std::string text = "accepted";
  try {
    read(file);
  } catch (const Refusal& refused) {
    text = refused.what();
  }
  std::printf("%s\t%s\t%s\n", file.c_str(), reader, text.c_str());
}

/// The triangles of the lines in the corpus.
umtet::TriangleMesh cube() {
  umtet::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.V.emplace_back(i >> 2 & 1, i >> 1 & 1, i & 1);
  const int sides[][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
  for (const auto& [a, b, c, d] : sides) {
    mesh.F.push_back({a, b, c});
    mesh.F.push_back({a, c, d});
  }
  return mesh;
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::filesystem::path file = argv[i];
    const std::string kind = file.extension();
    if (kind == ".vtu" || kind == ".msh" || kind == ".mesh" || kind == ".inp" || kind == ".tets") {
      answer<umtet::MeshFileRefused>(file, "read_tet_mesh", umtet::read_tet_mesh);
    } else if (kind == ".vti") {
      answer<umtet::LevelSetRefused>(file, "read_level_set", umtet::read_level_set);
    } else if (kind == ".nrrd" || kind == ".nii" || kind == ".vtk" || kind == ".grid") {
      answer<umtet::GridRefused>(file, "read_grid", [](const auto& path) { return umtet::read_grid(path); });
    } else if (kind == ".feat" || kind == ".eMesh" || kind == ".lines") {
      answer<umtet::CloudRefused>(file, "read_feature_lines", [](const std::filesystem::path& path) {
        umtet::TriangleMesh mesh = cube();
        return umtet::add_lines(mesh, umtet::read_feature_lines(path), path);
      });
    } else if (umtet::holds_triangles(file)) {
      answer<umtet::CloudRefused>(file, "read_triangles", [](const auto& path) { return umtet::read_triangles(path); });
    } else {
      answer<umtet::CloudRefused>(file, "read_scan", [](const auto& path) { return umtet::read_scan(path); });
      answer<umtet::CloudRefused>(file, "read_point_cloud",
                                  [](const auto& path) { return umtet::read_point_cloud(path); });
    }
  }
}
