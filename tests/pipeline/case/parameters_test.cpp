#include "pipeline/case/parameters.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <string>

#include "pipeline/case/artefact.h"
#include "pipeline/case/exit_code.h"

namespace umtet {
namespace {
namespace fs = std::filesystem;

std::string refusal(const std::function<void()>& f) {
  try {
    f();
  } catch (const UsageError& e) {
    return e.what();
  }
  return "accepted";
}

struct TomlFile {
  explicit TomlFile(const std::string& text) { write_text_artefact(path, text); }
  ~TomlFile() { fs::remove(path); }
  const fs::path path = fs::temp_directory_path() / ("umtet_parameters_" + std::to_string(::getpid()) + ".toml");
};

/// Stands for any field of an aggregate.
struct Any {
  template <class T>
  operator T() const;  // NOLINT(google-explicit-constructor)
};

/// How many fields an aggregate has; a base class counts as one.
template <class T, class... Fields>
constexpr std::size_t n_fields() {
  if constexpr (requires { T{Fields{}..., Any{}}; }) {
    return n_fields<T, Fields..., Any>();
  } else if constexpr (requires { T{Fields{}..., std::optional<SsdSolver>{}}; }) {
    return n_fields<T, Fields..., std::optional<SsdSolver>>();
  } else {
    return sizeof...(Fields);
  }
}

template <class Class, class T>
Class class_of(T Class::*);

/// How many parameters are fields of the class itself.
template <class Class>
constexpr std::size_t n_reached() {
  std::size_t n = 0;
#define UMTET_CLOUD(name, ...) n += std::is_same_v<Class, decltype(class_of(&CloudParameters::name))> ? 1 : 0;
#define UMTET_RECONSTRUCT(name, ...) \
  n += std::is_same_v<Class, decltype(class_of(&ReconstructParameters::name))> ? 1 : 0;
#define UMTET_MESH(name, ...) n += std::is_same_v<Class, decltype(class_of(&MeshParameters::name))> ? 1 : 0;
#define UMTET_OUTPUT(name, ...) n += std::is_same_v<Class, decltype(class_of(&OutputParameters::name))> ? 1 : 0;
#include "pipeline/case/parameters.def"
  return n;
}

// parameters.def reaches every option of the library, and every field of the sections besides.
static_assert(n_reached<ScanOptions>() == n_fields<ScanOptions>());
static_assert(n_reached<FitOptions>() == n_fields<FitOptions>());
static_assert(n_reached<MeshOptions>() == n_fields<MeshOptions>());
static_assert(n_reached<VerdictOptions>() == n_fields<VerdictOptions>());
static_assert(n_reached<CloudParameters>() == n_fields<CloudParameters>() - 1);
static_assert(n_reached<ReconstructParameters>() == n_fields<ReconstructParameters>() - 1);
static_assert(n_reached<MeshParameters>() == n_fields<MeshParameters>() - 1);
static_assert(n_reached<OutputParameters>() == n_fields<OutputParameters>() - 1);

TEST(Parameters, DefaultsAreInsideTheirOwnRanges) {
  for (const ParamField& f : params_fields()) {
    Parameters p;
    const TomlFile file(p.toml());
    EXPECT_NO_THROW(p.load(file.path, ParamSource::File)) << f.key;
    EXPECT_FALSE(f.help.empty()) << f.key;
  }
}

TEST(Parameters, WordsOfAVocabularyAreValuesOfAnEnum) {
  Parameters p;
  EXPECT_EQ(p.mesh().mode, UmMode::Fast);
  EXPECT_EQ(p.reconstruct().solver, std::nullopt);
  p.set("mesh.mode=paper");
  p.set("reconstruct.solver=assembled");
  p.set("cloud.normals=estimate");
  p.set("mesh.closest_point=damped");
  EXPECT_EQ(p.mesh().mode, UmMode::Paper);
  EXPECT_EQ(p.reconstruct().solver, SsdSolver::Assembled);
  EXPECT_EQ(p.cloud().normals, NormalsOf::Estimate);
  EXPECT_EQ(p.mesh().closest_point, ClosestPointMethod::Damped);
  for (const ParamField& f : params_fields()) {
    for (const std::string& word : f.choices) {
      p.set(f.key + "=" + word);
      EXPECT_EQ(p.section(f.key.substr(0, f.key.find('.'))).at(f.key.substr(f.key.find('.') + 1)), word) << f.key;
    }
  }
}

TEST(Parameters, FlagBeatsSetBeatsFileBeatsDefaultInAnyOrder) {
  const TomlFile file("[mesh]\nsamples = 3\nseed = 3\n[reconstruct]\nsmoothing = 1\n");
  Parameters p;
  p.set("mesh.samples", "1", ParamSource::Flag, "--samples");
  p.set("mesh.samples=2");
  p.set("mesh.seed=2");
  p.load(file.path, ParamSource::File);
  EXPECT_EQ(p.mesh().samples, 1);
  EXPECT_EQ(p.mesh().seed, 2);
  EXPECT_EQ(p.reconstruct().smoothing, 1);  // a TOML integer is a number too
  EXPECT_EQ(p.source(keys::reconstruct::smoothing), ParamSource::File);
  EXPECT_EQ(p.source(keys::reconstruct::gamma), ParamSource::Default);
}

TEST(Parameters, CaseTomlReadsBackToTheSameValues) {
  Parameters p;
  p.set("cloud.file=a \"quoted\"\\ path\nwith a line break.ply");
  p.set("mesh.h=0.1");
  p.set("reconstruct.tolerance=1e-08");
  p.set("reconstruct.smoothing=0.30000000000000004");
  p.set("mesh.implicit=x^2+y^2-1");
  p.set("mesh.keep_iterates=true");
  const TomlFile file(p.toml());
  Parameters q;
  q.load(file.path, ParamSource::File);
  for (const char* section : {"cloud", "reconstruct", "mesh", "output"})
    EXPECT_EQ(p.section(section), q.section(section));
  EXPECT_NE(p.toml().find("h = 0.1  # --set"), std::string::npos) << p.toml();
}

TEST(Parameters, UnknownKeysNameTheNearest) {
  Parameters p;
  EXPECT_EQ(refusal([&] { p.set("mesh.sampels=3"); }), "unknown parameter mesh.sampels; did you mean mesh.samples?");
  EXPECT_EQ(refusal([&] { p.set("nonsense=3"); }), "unknown parameter nonsense");
  const TomlFile file("[mesh]\nsamples = 3\n\n[reconstruct]\nsmothing = 1\n");
  const std::string message = refusal([&] { p.load(file.path, ParamSource::File); });
  EXPECT_NE(message.find(":5: unknown parameter reconstruct.smothing; did you mean reconstruct.smoothing?"),
            std::string::npos)
      << message;
}

TEST(Parameters, FilesOfFormerVersionsAreRead) {
  Parameters p;
  const TomlFile file("[mesh]\nallow_thin = true\nsamples = 3\n");
  p.load(file.path, ParamSource::File);
  EXPECT_EQ(p.mesh().samples, 3);
}

TEST(Parameters, ValuesOutOfTypeOrRangeAreRefused) {
  for (const char* assignment :
       {"mesh.samples=0", "mesh.samples=2.5", "mesh.samples=", "mesh.samples=3x", "mesh.h=-1", "mesh.h=nan",
        "mesh.h=inf", "mesh.h=0,1", "reconstruct.smoothing=-1", "reconstruct.tolerance=1", "mesh.mode=quick",
        "mesh.background=bcc", "mesh.box=0,0,0,1,1", "mesh.box=0,0,0,1,1,0", "mesh.box=0,0,0,1,1,1,",
        "mesh.keep_iterates=maybe", "mesh.h"}) {
    Parameters p;
    EXPECT_NE(refusal([&] { p.set(assignment); }), "accepted") << assignment;
  }
}

TEST(Parameters, FilesThatAreNotTomlAreRefusedWithTheirPlace) {
  Parameters p;
  const TomlFile broken("[mesh]\nh = = 3\n");
  EXPECT_NE(refusal([&] { p.load(broken.path, ParamSource::File); }).find(".toml:2:"), std::string::npos);
  const TomlFile typed("[mesh]\nh = \"small\"\n");
  EXPECT_NE(refusal([&] { p.load(typed.path, ParamSource::File); }).find(":2: mesh.h: must be a number"),
            std::string::npos);
  EXPECT_THROW(p.load("/nowhere/case.toml", ParamSource::File), std::system_error);
}

TEST(Parameters, EdgeLengthAndCountExcludeEachOther) {
  Parameters p;
  p.set("mesh.h", "0.1", ParamSource::Case, "case.toml");
  p.set("mesh.tets", "1000", ParamSource::Flag, "--tets");
  EXPECT_EQ(p.mesh().h, 0);
  EXPECT_EQ(p.mesh().tets, 1000);
  EXPECT_NE(refusal([&] { p.set("mesh.h", "0.1", ParamSource::Flag, "--h"); }), "accepted");
  p.set("mesh.h=0.2");  // weaker than the flag
  EXPECT_EQ(p.mesh().h, 0);
}

TEST(Parameters, TheStrongerOfTwoThatContradictStandsAlone) {
  const TomlFile file("[output]\npatch_planar = 5\n[reconstruct]\nkeep_open = true\n");
  Parameters p;
  p.set("output.patch_angle", "30", ParamSource::Flag, "--patch-angle");
  p.set("reconstruct.close", "auto", ParamSource::Flag, "--close");
  p.load(file.path, ParamSource::File);
  EXPECT_EQ(p.output().patch_planar, 0);
  EXPECT_EQ(p.output().patch_angle, 30);
  EXPECT_FALSE(p.reconstruct().keep_open);
  Parameters late;
  late.load(file.path, ParamSource::File);
  late.set("output.patch_angle", "30", ParamSource::Flag, "--patch-angle");
  late.set("reconstruct.close", "smooth", ParamSource::Flag, "--close");
  EXPECT_EQ(late.output().patch_planar, 0);
  EXPECT_FALSE(late.reconstruct().keep_open);
  Parameters both;  // given together they stand together
  both.set("output.patch_planar=5");
  both.set("output.patch_angle=30");
  EXPECT_EQ(both.output().patch_planar, 5);
  EXPECT_EQ(both.output().patch_angle, 30);
}

TEST(Parameters, WhatACaseKeepsIsInTheWordsOfACall) {
  Parameters p;
  p.set("mesh.h", "0.1", ParamSource::Flag, "--h");
  p.set("mesh.samples=7");
  p.set("cloud.keep_all=true");
  p.set("cloud.merge=false");
  p.set("output.label_names=1=left foot");
  p.set("cloud.file=a.ply");
  p.set("cloud.sample_spacing", "0.04", ParamSource::Derived, "for --h");
  const TomlFile file(p.toml());
  Parameters q;
  q.load(file.path, ParamSource::Case);
  std::vector<std::string> words;
  for (const KeptParameter& kept : q.kept()) words.push_back(kept.words);
  EXPECT_EQ(words, (std::vector<std::string>{"--keep-all", "--set cloud.merge=false", "--h 0.1", "--set mesh.samples=7",
                                             "--label-names '1=left foot'"}));
  EXPECT_EQ(q.source(keys::cloud::sample_spacing), ParamSource::Derived);
  EXPECT_EQ(q.toml(), p.toml());  // origins stay
  EXPECT_TRUE(p.kept().empty());  // of the call itself
}

TEST(Parameters, WholeNumbersMayHaveAnExponentButNoFraction) {
  Parameters p;
  p.set("mesh.tets=1e6");
  EXPECT_EQ(p.mesh().tets, 1000000);
  EXPECT_NE(refusal([&] { p.set("mesh.tets=1.5e0"); }), "accepted");
  EXPECT_NE(refusal([&] { p.set("output.units=\xff"); }), "accepted");
}

TEST(Nearest, PrefersTheWordThatGoesOn) {
  EXPECT_EQ(nearest("--tet", {"--set", "--tets"}), "--tets");
  EXPECT_EQ(nearest("--sett", {"--set", "--tets"}), "--set");
}

TEST(ParseBox, TakesSixNumbers) {
  const auto box = parse_box(" -1, -2.5,0 , 1e0,2,3");
  ASSERT_TRUE(box);
  EXPECT_EQ(box->min(), Eigen::Vector3d(-1, -2.5, 0));
  EXPECT_EQ(box->max(), Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(parse_box(""));
}

}  // namespace
}  // namespace umtet
