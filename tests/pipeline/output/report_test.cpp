// The built program, from outside: when there is a report, and of what.

#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

TEST_F(Program, ReportsAreOfTheCertificateBesideThem) {
  const fs::path report = folder / "egg/report.html";
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000 --no-report").code, 0);
  EXPECT_FALSE(fs::exists(report));
  EXPECT_EQ(run("report egg").code, 0);
  const std::string read_back = content(report);
  EXPECT_NE(read_back.find(Json::parse(content(folder / "egg/certificate.json"))["run"]["checksum"].get<std::string>()),
            std::string::npos);
  const auto made = fs::last_write_time(report);
  EXPECT_EQ(run("run egg").code, 0);
  EXPECT_EQ(fs::last_write_time(report), made);
  EXPECT_EQ(run("run egg --patch-angle 30").code, 0);
  EXPECT_NE(fs::last_write_time(report), made) << "it shows other patches now";
  EXPECT_EQ(run("run egg --min-quality .99").code, 6);
  EXPECT_TRUE(content(report).find("class=\"verdict fail\"") != std::string::npos);
  EXPECT_EQ(run("run egg --min-quality 0 --no-report").code, 0);
  EXPECT_FALSE(fs::exists(report));
  EXPECT_EQ(run("report nowhere").code, 2);
  std::ofstream(folder / "egg/certificate.json") << "{}";
  EXPECT_EQ(run("report egg").code, 8);
}

TEST_F(Program, ReportOfARunIsThatOfItsFiles) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000").code, 0);
  const std::string in_memory = content(folder / "egg/report.html");
  ASSERT_EQ(run("report egg").code, 0);
  EXPECT_TRUE(content(folder / "egg/report.html") == in_memory);
  ASSERT_EQ(run("mesh egg --tets 2000 --no-report").code, 0);
  EXPECT_FALSE(fs::exists(folder / "egg/report.html"));
}

}  // namespace
}  // namespace umtet
