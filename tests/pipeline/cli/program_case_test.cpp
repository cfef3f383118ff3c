// The built program, from outside: what is left on disk by runs that fail or are stopped, by damage and by edits.

#include <signal.h>

#include <chrono>
#include <thread>

#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

TEST_F(Program, DamageIsNoticedAndMended) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000").code, 0);
  const fs::path file = folder / "egg/2-level-set/level_set.vti";
  const std::string good = content(file);
  std::string bad = good;
  bad[bad.size() / 2] ^= 1;
  std::ofstream(file, std::ios::binary) << bad;
  const Result strict = run("run egg.ply -o egg --tets 3000 --strict");
  EXPECT_EQ(strict.code, 8);
  EXPECT_NE(strict.err.find("level_set.vti"), std::string::npos) << strict.err;
  const Result mended = run("mesh egg");
  EXPECT_EQ(mended.code, 0) << mended.err;
  EXPECT_NE(mended.err.find("level_set.vti does not match its checksum; making it again"), std::string::npos);
  EXPECT_EQ(content(file), good);
}

TEST_F(Program, EditedRecordsAndCertificatesAreDamage) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000").code, 0);
  const std::string certificate = content(folder / "egg/certificate.json");
  const auto edit = [&](const fs::path& file, const std::string& from, const std::string& to) {
    std::string text = content(file);
    text.replace(text.find(from), from.size(), to);
    std::ofstream(file) << text;
  };
  edit(folder / "egg/3-mesh/record.json", "\"n_inverted\": 0", "\"n_inverted\": 1");
  EXPECT_EQ(run("run egg --strict").code, 8);
  const Result mended = run("run egg --json");
  EXPECT_EQ(mended.code, 0);
  EXPECT_EQ(Json::parse(mended.out)["certificate"]["quality"]["n_inverted"], 0);
  EXPECT_NE(mended.err.find("own checksum; making it again"), std::string::npos) << mended.err;
  edit(folder / "egg/certificate.json", "\"pass\"", "\"good\"");
  EXPECT_EQ(run("run egg --strict").code, 8);
  const Result again = run("run egg");
  EXPECT_EQ(again.code, 0);
  EXPECT_NE(again.err.find("certificate.json does not match"), std::string::npos) << again.err;
  EXPECT_EQ(Json::parse(content(folder / "egg/certificate.json"))["verdict"], "pass");
  EXPECT_EQ(run("run egg --strict --min-quality .99").code, 6);  // another gate is no damage
}

TEST_F(Program, CaseTomlSaysWhatTheStagesWereMadeWith) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000 --units mm").code, 0);
  const std::string toml = content(folder / "egg/case.toml");
  EXPECT_EQ(run("run egg --set cloud.file=foo").code, 7);
  EXPECT_EQ(run("run egg --until cloud --set mesh.implicit=x").code, 2);
  EXPECT_EQ(run("run egg.ply -o egg --until level-set --h .2").code, 2);
  EXPECT_EQ(content(folder / "egg/case.toml"), toml);
  std::ofstream(folder / "other.toml") << "[mesh]\nsamples = 7\n[output]\nunits = \"m\"\n";
  EXPECT_EQ(run("run egg --until level-set --config other.toml").code, 0);
  EXPECT_NE(content(folder / "egg/case.toml").find("samples = 20"), std::string::npos);
  EXPECT_NE(content(folder / "egg/case.toml").find("units = 'mm'"), std::string::npos);
  // The same points from another file are another origin, and no other result.
  fs::copy(cloud, folder / "twin.ply");
  EXPECT_NE(run("run egg --set cloud.file=twin.ply").err.find("nothing to do"), std::string::npos);
  EXPECT_NE(content(folder / "egg/case.toml").find("twin.ply"), std::string::npos);
}

TEST_F(Program, RefusedCloudsTouchNothing) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000").code, 0);
  const std::string certificate = content(folder / "egg/certificate.json"), toml = content(folder / "egg/case.toml");
  std::ofstream(folder / "cut.ply") << content(cloud).substr(0, 2000);
  const Result r = run("run cut.ply -o egg --tets 3000 --json");
  EXPECT_EQ(r.code, 3);
  const Json document = Json::parse(r.out);
  EXPECT_EQ(document["exit_code"], 3);
  EXPECT_NE(document["error"].get<std::string>().find("cut.ply"), std::string::npos);
  EXPECT_EQ(content(folder / "egg/certificate.json"), certificate);
  EXPECT_EQ(content(folder / "egg/case.toml"), toml);
  EXPECT_EQ(run("run cut.ply -o new").code, 3);
  EXPECT_FALSE(fs::exists(folder / "new"));
  const Result missing = run("run none.ply -o new");
  EXPECT_EQ(missing.code, 7);
  EXPECT_NE(missing.err.find("none.ply"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "new"));
}

TEST_F(Program, CloudsThatCannotBoundABodyTouchNothing) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000").code, 0);
  std::map<fs::path, std::string> before;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder / "egg")) {
    if (entry.is_regular_file() && entry.path().filename() != ".lock") before[entry.path()] = content(entry.path());
  }
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 12\nproperty double x\nproperty double y\nproperty double z\n";
  const std::string normals = "property double nx\nproperty double ny\nproperty double nz\n", end = "end_header\n";
  std::ofstream same(folder / "same.ply"), bare(folder / "bare.ply");
  same << head << normals << end;
  bare << head << end;
  for (int i = 0; i < 12; ++i) {
    same << "1 2 3 0 0 1\n";
    bare << i % 3 << ' ' << i / 3 << ' ' << i << '\n';
  }
  same.close();
  bare.close();
  for (const char* name : {"same.ply", "bare.ply"}) {
    const Result r = run("run " + std::string(name) + " -o egg --tets 3000 --force");
    EXPECT_EQ(r.code, 3) << r.err;
    EXPECT_NE(r.err.find(name), std::string::npos) << r.err;
    for (const auto& [file, bytes] : before) EXPECT_EQ(content(file), bytes) << name << " changed " << file;
    EXPECT_EQ(run("run " + std::string(name) + " -o new").code, 3);
    EXPECT_FALSE(fs::exists(folder / "new"));
  }
  EXPECT_NE(run("run egg.ply -o egg --tets 3000").err.find("nothing to do"), std::string::npos);
}

TEST_F(Program, ARunThatFailsOnTheWayLosesNothing) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000").code, 0);
  ASSERT_EQ(run("export egg --format stl,mesh").code, 0);
  const auto before = files_of("egg");
  write_cloud("inward.ply", [](const double(&x)[6]) {
    std::ostringstream s;
    for (int k = 0; k < 6; ++k) s << (k < 3 ? x[k] : -x[k]) << ' ';
    return s.str();
  });
  EXPECT_EQ(run("run inward.ply -o egg --tets 3000 --normals given").code, 4);
  EXPECT_EQ(files_of("egg"), before);
  // A fit that succeeds is kept for the next try when no mesh can be made of it.
  EXPECT_EQ(run("run egg.ply -o egg --set reconstruct.smoothing=.02 --tets 1e11", "timeout 300").code, 9);
  EXPECT_EQ(files_of("egg"), before);
  EXPECT_NE(run("run egg.ply -o egg --tets 3000").err.find("nothing to do"), std::string::npos);
  const Result next = run("run egg.ply -o egg --set reconstruct.smoothing=.02 --tets 2000 --json");
  ASSERT_EQ(next.code, 0) << next.err;
  EXPECT_EQ(Json::parse(next.out)["stages_run"], Json::array({"mesh"}));
  EXPECT_NE(content(folder / "egg/case.toml").find("smoothing = 0.02"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "egg/.next"));
  // What had been exported was another mesh.
  EXPECT_NE(next.err.find("removed mesh.mesh, mesh.stl"), std::string::npos) << next.err;
  EXPECT_TRUE(fs::is_empty(folder / "egg/4-export"));
  EXPECT_EQ(run("run egg.ply -o egg --set reconstruct.smoothing=.02 --tets 2000 --strict").code, 0);
}

TEST_F(Program, FoldersThatAreNoCasesAreNotOverwritten) {
  fs::create_directories(folder / "mine/1-cloud");
  std::ofstream(folder / "mine/1-cloud/cloud.ply") << "precious";
  const Result r = run("run egg.ply -o mine");
  EXPECT_EQ(r.code, 2);
  EXPECT_NE(r.err.find("choose another folder"), std::string::npos) << r.err;
  EXPECT_EQ(content(folder / "mine/1-cloud/cloud.ply"), "precious");
  std::ofstream(folder / "file") << "x";
  const Result file = run("run egg.ply -o file/case");
  EXPECT_EQ(file.code, 7);
  EXPECT_EQ(file.err.find("filesystem error"), std::string::npos) << file.err;
  EXPECT_NE(file.err.find("a part of this path is a file"), std::string::npos) << file.err;
}

TEST_F(Program, TheCaseOfAFileIsItsStemUnlessThatIsSomethingElse) {
  const std::string quick = " --until cloud";
  const Result r = run("run egg.ply --json" + quick);
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(Json::parse(r.out)["case"], "egg");
  EXPECT_TRUE(fs::exists(folder / "egg/1-cloud/cloud.ply"));
  EXPECT_NE(run("run egg.ply" + quick).err.find("nothing to do: egg is up to date"), std::string::npos);
  EXPECT_EQ(run("run ./egg.ply --flip" + quick).code, 0) << "the same file in other words";
  // Another file of that name, a folder of something else, and a file.
  fs::create_directories(folder / "there");
  fs::copy_file(cloud, folder / "there/egg.ply");
  fs::copy_file(cloud, folder / "notes.ply");
  fs::create_directories(folder / "notes");
  std::ofstream(folder / "notes/a.txt") << "precious";
  fs::copy_file(cloud, folder / "scan");
  std::ofstream(folder / "scan.xyz") << "0 0 0\n";
  for (const auto& [call, why] : {std::pair{"run there/egg.ply", "egg is the case of"},
                                  {"run notes.ply", "notes is a folder but not a case"},
                                  {"reconstruct scan.xyz", "scan is a file"},
                                  {"run scan", "scan is a file"}}) {
    const Result refused = run(call);
    EXPECT_EQ(refused.code, 2) << call;
    EXPECT_NE(refused.err.find("-o CASE is missing"), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find(why), std::string::npos) << refused.err;
  }
  EXPECT_EQ(fs::directory_iterator(folder / "notes")->path().filename(), "a.txt");
  EXPECT_EQ(run("run none.ply").code, 7);
  EXPECT_FALSE(fs::exists(folder / "none"));
  fs::create_directories(folder / "empty");
  fs::copy_file(cloud, folder / "empty.ply");
  EXPECT_EQ(run("run empty.ply" + quick).code, 0) << "an empty folder is in nobody's way";
}

TEST_F(Program, ColumnsOfATextAreGuessedSaidAndOverruled) {
  std::ofstream text(folder / "egg.csv");
  text << "X;Y;Z;Intensity;Nx;Ny;Nz\n";
  std::istringstream in(content(cloud));
  std::string line;
  while (std::getline(in, line) && line != "end_header") {
  }
  std::vector<std::string> rows;
  for (std::string v; std::getline(in, line);) {
    std::istringstream words(line);
    std::vector<std::string> w;
    while (words >> v) w.push_back(v);
    w.insert(w.begin() + 3, std::to_string(.25 * static_cast<double>(w.size() + rows.size())));
    rows.push_back("");
    for (std::size_t k = 0; k < w.size(); ++k) rows.back() += (k > 0 ? ";" : "") + w[k];
    std::replace(rows.back().begin(), rows.back().end(), '.', ',');
    text << rows.back() << '\n';
  }
  text.close();
  const std::string header = "columns x y z Intensity nx ny nz, as the header says";
  const Result r = run("run egg.csv --until cloud");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.err.find("cloud: " + header), std::string::npos) << r.err;
  const auto record = [&](const std::string& name) {
    return Json::parse(content(folder / name / "1-cloud/record.json"))["numbers"];
  };
  EXPECT_EQ(record("egg")["columns"], header);
  EXPECT_EQ(record("egg")["fields"], Json::array({"Intensity"}));
  EXPECT_EQ(record("egg")["n_points"], 600);
  ASSERT_EQ(run("run egg.csv --until cloud --columns x,y,z,-,nx,ny,nz -o told").code, 0);
  EXPECT_FALSE(record("told").contains("fields"));
  EXPECT_EQ(content(folder / "told/1-cloud/cloud.ply").size() + 600 * sizeof(double) +
                std::string("property double Intensity\n").size(),
            content(folder / "egg/1-cloud/cloud.ply").size());
  EXPECT_NE(run("inspect egg.csv").out.find("columns   x y z Intensity nx ny nz, as the header says"),
            std::string::npos);
  EXPECT_EQ(Json::parse(run("inspect egg.csv --json --columns x,y,z").out)["inspection"]["normals"]["present"], false);
  const Result refused = run("run egg.csv --columns x,y,z,a,b,c,d,e -o refused");
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("7 columns, but --columns names 8"), std::string::npos) << refused.err;
  EXPECT_EQ(run("run egg.ply --columns x,y,z -o refused").code, 3);
}

TEST_F(Program, AFullDiskIsFileTroubleAndLeavesNoHalfFile) {
  // 40 blocks of 512 or 1024 bytes: the record would fit, the meshes do not.
  const Result r = run(ball, "ulimit -f 40;");
  EXPECT_EQ(r.code, 7) << r.err;
  EXPECT_NE(r.err.find(".vtu"), std::string::npos) << r.err;
  EXPECT_FALSE(fs::exists(folder / "ball/certificate.json"));
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder / "ball")) {
    EXPECT_FALSE(entry.path().extension() == ".vtu") << entry.path();
  }
  EXPECT_EQ(run(ball).code, 0);
  // The rest of the call, which sends stdout to a file, is a comment.
  EXPECT_EQ(run(ball + " >/dev/full 2>&1; exit $?; #").code, 7);
}

TEST_F(Program, InterruptedRunsLeaveAResumableCase) {
  for (const auto& [signal, code] : {std::pair{SIGINT, 130}, std::pair{SIGTERM, 143}}) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::chdir(folder.c_str());
      ::execl(UMTET_PROGRAM, "umtet", "mesh", "--implicit", "x^2+y^2+z^2-1", "--box", "-1.3,-1.3,-1.3,1.3,1.3,1.3",
              "--tets", "300000", "--mode", "paper", "-o", "large", "-q", nullptr);
      ::_exit(127);
    }
    // However slow the machine: it has begun, and paper mode takes seconds from here.
    for (int k = 0; k < 6000 && !fs::exists(folder / "large/.lock"); ++k) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    ::kill(child, signal);
    const auto asked = std::chrono::steady_clock::now();
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), code);
    // A sweep over 300k tets takes well below a second; the rest is for a loaded machine under sanitizers.
    EXPECT_LT(std::chrono::steady_clock::now() - asked, std::chrono::seconds(20));
    EXPECT_FALSE(fs::exists(folder / "large/3-mesh/record.json"));
    fs::remove(folder / "large/.lock");
  }
  EXPECT_EQ(run("mesh --implicit 'x^2+y^2+z^2-1' --box -1.3,-1.3,-1.3,1.3,1.3,1.3 --tets 3000 -o large").code, 0);
}

}  // namespace
}  // namespace umtet
