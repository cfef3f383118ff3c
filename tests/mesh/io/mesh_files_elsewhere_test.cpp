// What gmsh and meshio read of our files.

#include <gtest/gtest.h>

#include "tests/support/mesh_files.h"
#include "tests/support/shell.h"

namespace umtet {
namespace {

using namespace test;

TEST(TetMeshIo, GmshReadsOurFiles) {
  if (!test::succeeds("gmsh --version")) GTEST_SKIP() << "gmsh is not installed";
  const Shape shape = sample();
  for (const Format& format : formats()) {
    if (format.name.ends_with(".vtu")) continue;  // the gmsh of Debian 12 writes VTK files of its own kind only
    const fs::path path = scratch(format.name), again = scratch("again.msh");
    format.write(path, shape);
    const std::string out =
        test::shell("gmsh " + path.string() + " -save -save_all -format msh22 -o " + again.string());
    EXPECT_NE(out.find(std::to_string(shape.mesh.V.size()) + " nodes"), std::string::npos) << out;
    EXPECT_EQ(out.find("Error"), std::string::npos) << out;
    EXPECT_EQ(out.find("Warning"), std::string::npos) << out;
    EXPECT_EQ(read_tet_mesh(again).mesh.C.size(), shape.mesh.C.size()) << format.name;
    const std::string text = bytes_of(again);
    if (format.name.ends_with(".msh")) {
      EXPECT_NE(text.find("2 2 \"boundary\""), std::string::npos) << format.name;
      EXPECT_NE(text.find("3 1 \"body\""), std::string::npos) << format.name;
    }
    fs::remove(path);
    fs::remove(again);
  }
}

TEST(TetMeshIo, MeshioReadsOurFiles) {
  const std::string python = test::kPython;
  if (!test::succeeds(python + " -c 'import meshio'")) GTEST_SKIP() << "meshio is not installed";
  const Shape shape = sample();
  const fs::path script = with_bytes("read.py",
                                     "import sys, meshio\n"
                                     "for path in sys.argv[1:]:\n"
                                     "    m = meshio.read(path)\n"
                                     "    n = {}\n"
                                     "    for c in m.cells: n[c.type] = n.get(c.type, 0) + len(c.data)\n"
                                     "    g = sorted((k, *map(int, v)) for k, v in m.field_data.items())\n"
                                     "    print('read', len(m.points), n.get('tetra'), n.get('triangle', 0), g)\n");
  std::string command = python + " " + script.string(), expected;
  const std::string counts =
      "read " + std::to_string(shape.mesh.V.size()) + " " + std::to_string(shape.mesh.C.size()) + " ";
  for (const Format& format : formats()) {
    const fs::path path = scratch(format.name);
    format.write(path, shape);
    command.append(" ").append(path.string());
    expected += counts + std::to_string(format.name == "a.vtu" ? 0 : shape.boundary.size()) +
                (format.name.ends_with(".msh") ? " [('body', 1, 3), ('boundary', 2, 2)]\n" : " []\n");
  }
  std::string out = test::shell(command);
  for (auto at = out.find("\n\n"); at != std::string::npos; at = out.find("\n\n"))
    out.erase(at, 1);  // meshio prints those
  EXPECT_NE(out.find(expected), std::string::npos) << out << "expected\n" << expected;
  for (const Format& format : formats()) fs::remove(scratch(format.name));
  fs::remove(script);
}

}  // namespace
}  // namespace umtet
