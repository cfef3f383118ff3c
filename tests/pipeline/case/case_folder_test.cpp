#include "pipeline/case/case_folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <system_error>

#include "pipeline/case/artefact.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/record.h"

namespace umtet {
namespace {
namespace fs = std::filesystem;
using Kind = StageState::Kind;

class CaseFolder : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(root); }
  void TearDown() override { fs::remove_all(root); }

  void finish_stage() {
    fs::create_directories(paths.folder(Stage::LevelSet));
    write_text_artefact(paths.level_set(), "coefficients");
    write_record(paths, {Stage::LevelSet, parameters, inputs, {}, {{"shift", {0, 0, 0}}}, run_of_stage(1, 2)},
                 {"level_set.vti"});
  }
  Kind kind() const { return inspect_stage(paths, Stage::LevelSet, parameters, inputs).kind; }

  const fs::path root = fs::temp_directory_path() / ("umtet case " + std::to_string(::getpid()));
  const CasePaths paths{root};
  Json parameters = {{"spacing", 0.1}, {"weights", "area"}};
  std::vector<RecordedFile> inputs = {{"1-cloud/cloud.ply", {12, "00"}}};
};

TEST_F(CaseFolder, AStageIsDoneOnceItsRecordHolds) {
  EXPECT_EQ(kind(), Kind::Missing);
  finish_stage();
  EXPECT_EQ(kind(), Kind::Done);
}

TEST_F(CaseFolder, OtherParametersAndOtherInputAreChanges) {
  finish_stage();
  parameters["spacing"] = 0.2;
  const StageState state = inspect_stage(paths, Stage::LevelSet, parameters, inputs);
  EXPECT_EQ(state.kind, Kind::Changed);
  EXPECT_EQ(state.reason, "reconstruct.spacing was 0.1, is 0.2");
  parameters["spacing"] = 0.1;
  inputs[0].stamp.xxh3 = "01";
  EXPECT_EQ(kind(), Kind::Changed);
  EXPECT_EQ(inspect_stage(paths, Stage::LevelSet, parameters, std::nullopt).kind, Kind::Done);
}

TEST_F(CaseFolder, AnotherVersionIsAChange) {
  finish_stage();
  Json record = Json::parse(read_text(paths.record(Stage::LevelSet)));
  record["version"] = "0.0.1";
  std::ofstream(paths.record(Stage::LevelSet)) << file_text(sealed(record));
  const StageState state = inspect_stage(paths, Stage::LevelSet, parameters, inputs);
  EXPECT_EQ(state.kind, Kind::Changed);
  EXPECT_EQ(state.reason, "made by version 0.0.1");
}

TEST_F(CaseFolder, EveryFlippedByteOfAnOutputIsDamage) {
  finish_stage();
  const std::string good = read_text(paths.level_set());
  for (std::size_t k = 0; k < good.size(); ++k) {
    std::string bad = good;
    bad[k] ^= 1;
    std::ofstream(paths.level_set()) << bad;
    EXPECT_EQ(kind(), Kind::Damaged) << k;
  }
  std::ofstream(paths.level_set()) << good.substr(1);
  EXPECT_EQ(kind(), Kind::Damaged);
  fs::remove(paths.level_set());
  EXPECT_EQ(kind(), Kind::Damaged);
  std::ofstream(paths.level_set()) << good;
  EXPECT_EQ(kind(), Kind::Done);
}

TEST_F(CaseFolder, ARecordCutAnywhereIsNeverDone) {
  finish_stage();
  const std::string good = read_text(paths.record(Stage::LevelSet));
  for (std::size_t n = 0; n + 2 < good.size(); n += 7) {  // without the last brace it is no JSON
    std::ofstream(paths.record(Stage::LevelSet)) << good.substr(0, n);
    EXPECT_EQ(kind(), Kind::Damaged) << n;
  }
  std::string other = good;
  other.replace(other.find("\"schema\": 2"), 11, "\"schema\": 9");
  std::ofstream(paths.record(Stage::LevelSet)) << other;
  EXPECT_EQ(kind(), Kind::Missing);
}

TEST_F(CaseFolder, ARecordVouchesForNothingOutsideItsFolder) {
  finish_stage();
  std::string text = read_text(paths.record(Stage::LevelSet));
  text.replace(text.find("level_set.vti"), 13, "../case.toml");
  std::ofstream(paths.record(Stage::LevelSet)) << file_text(sealed(Json::parse(text)));
  const StageState state = inspect_stage(paths, Stage::LevelSet, parameters, inputs);
  EXPECT_EQ(state.kind, Kind::Damaged);
  EXPECT_NE(state.reason.find("outside its folder"), std::string::npos) << state.reason;
}

TEST_F(CaseFolder, ARecordThatWasEditedIsDamaged) {
  finish_stage();
  const fs::path file = paths.record(Stage::LevelSet);
  const Json good = Json::parse(read_text(file));
  for (const auto& [key, value] : good.items()) {
    if (key == "schema" || key == "stage") continue;  // of another kind altogether
    Json bad = good;
    bad[key] = "edited";
    std::ofstream(file) << file_text(bad);
    EXPECT_EQ(kind(), Kind::Damaged) << key;
  }
  Json bad = good;
  bad["run"]["seconds"] = 2;
  std::ofstream(file) << file_text(bad);
  EXPECT_EQ(kind(), Kind::Damaged);
  std::ofstream(file) << good.dump();  // other white space is no other content
  EXPECT_EQ(kind(), Kind::Done);
}

TEST_F(CaseFolder, OneProcessAtATime) {
  const CaseLock lock(root);
  const pid_t child = ::fork();
  if (child == 0) {
    int code = 1;
    try {
      const CaseLock second(root);
    } catch (const FileTrouble& e) {
      code = std::string(e.what()).find("process " + std::to_string(::getppid())) != std::string::npos ? 0 : 2;
    }
    ::_exit(code);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(CaseFolder, ALockLeavesNoEmptyFolderBehind) {
  { const CaseLock lock(root); }
  EXPECT_FALSE(fs::exists(root));
  {
    const CaseLock lock(root);
    write_text_artefact(paths.parameters(), "x");
  }
  EXPECT_TRUE(fs::exists(paths.parameters()));
  { const CaseLock again(root); }
  EXPECT_TRUE(fs::exists(paths.parameters()));
}

TEST(Stages, AreFoundByName) {
  for (const Stage stage : {Stage::Cloud, Stage::LevelSet, Stage::Mesh})
    EXPECT_EQ(parse_stage(to_string(stage)), stage);
  try {
    parse_stage("levelset");
    FAIL();
  } catch (const UsageError& e) {
    EXPECT_NE(std::string(e.what()).find("did you mean level-set"), std::string::npos);
  }
}

}  // namespace
}  // namespace umtet
