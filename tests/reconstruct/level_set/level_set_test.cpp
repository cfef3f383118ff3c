// The level set: derivatives, smoothness, sign bounds, and its file.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include "reconstruct/io/level_set_io.h"
#include "reconstruct/solve/fit_ssd.h"
#include "tests/support/clouds.h"

using namespace umtet;
using namespace umtet::test;

namespace {

const LevelSet& torus_level_set() {
  static const LevelSet psi = [] {
    SsdParams p;
    p.spacing = 0.2;
    p.solver = SsdSolver::Full;
    return fit_ssd(torus_cloud(2000), p).psi;
  }();
  return psi;
}

std::filesystem::path scratch(const char* name) {
  return std::filesystem::temp_directory_path() / ("umtet_" + std::to_string(getpid()) + "_" + name);
}

}  // namespace

TEST(LevelSet, DerivativesPassFiniteDifferences) {
  const LevelSet& psi = torus_level_set();
  const double e = 1e-5;
  for (const Vec3& x : torus_cloud(40, 11).points) {
    Vec3 g;
    Mat3 H;
    const double f = psi.evaluate(x, &g, &H);
    EXPECT_EQ(f, psi.value(x));
    for (int d = 0; d < 3; ++d) {
      const Vec3 up = x + e * Vec3::Unit(d), down = x - e * Vec3::Unit(d);
      EXPECT_NEAR(g[d], (psi.value(up) - psi.value(down)) / (2 * e), 1e-8);
      EXPECT_LT((H.col(d) - (psi.gradient(up) - psi.gradient(down)) / (2 * e)).norm(), 1e-5);
    }
  }
}

TEST(LevelSet, HessianIsContinuousAcrossCells) {
  const LevelSet& psi = torus_level_set();
  const Lattice& L = psi.coarsest().lattice;
  for (const Vec3& x : torus_cloud(200, 12).points) {
    Vec3 face = x;  // moved onto the nearest plane of nodes
    face[0] = L.origin[0] + L.h * std::round((x[0] - L.origin[0]) / L.h);
    const Vec3 step = 1e-9 * L.h * Vec3::UnitX();
    EXPECT_LT((psi.hessian(face + step) - psi.hessian(face - step)).norm(), 1e-6 * psi.hessian(face).norm() + 1e-6);
  }
}

TEST(LevelSet, IsPositiveOutsideItsDomain) {
  const LevelSet& psi = torus_level_set();
  for (const Vec3& x : {Vec3(5, 0, 0), Vec3(0, -7, 0.1), Vec3(3, 3, 3), Vec3(0, 0, -9)}) {
    EXPECT_GT(psi.value(x), 0.3 * std::sqrt(psi.domain().squaredExteriorDistance(x)));
  }
}

// More levels than are looked up at once, at the wall, where functions are moved inside, and away from it.
TEST(LevelSet, IsTheSumOverAllNodesOfAllLevels) {
  const LmePrior prior;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  LevelSetLevel coarsest{{Vec3(1, -2, 3), 0.5, {7, 8, 9}}, {}};
  for (std::ptrdiff_t a = 0; a < coarsest.lattice.size(); ++a) coarsest.coefficients.push_back(u(random));
  LevelSet psi(prior, coarsest);
  constexpr int kBands = 6;
  for (int level = 1; level <= kBands; ++level) {
    Lattice L = psi.lattice(level - 1);
    L.h /= 2;
    L.n = 2 * (L.n.array() - 1) + 1;
    std::vector<Eigen::Vector3i> near_the_corner;
    for (int q = 0; q < 27; ++q) near_the_corner.emplace_back(q % 3, q / 3 % 3, q / 9);
    LevelSetBand band{LatticeBlocks(L, half_width(prior), near_the_corner), {}};
    for (int a = 0; a < band.blocks.size() * LatticeBlocks::kNodes; ++a) {
      band.coefficients.push_back(static_cast<float>(u(random)));
    }
    psi = psi.with_band(std::move(band));
  }
  for (int i = 0; i < 200; ++i) {
    const double reach = std::exp2(-i % 7);  // into bands of all levels
    const Vec3 x = coarsest.lattice.origin + reach * Vec3(u(random), u(random), u(random)).cwiseAbs();
    double sum = 0, size = 0;
    for (int level = 0; level <= kBands; ++level) {
      const Lattice& L = psi.lattice(level);
      LmeBasis3d B;
      evaluate_lme_3d<false>(psi.tables(), L.n, (x - L.origin) / L.h, B);
      for (int q = 0; q < 6 * 6 * 6; ++q) {
        const Eigen::Vector3i lane(q % 6, q / 6 % 6, q / 36),
            node = lane + Eigen::Vector3i(B.x.first, B.y.first, B.z.first);
        double c = level == 0 ? coarsest.coefficients[L.index(node[0], node[1], node[2])] : 0;
        float of_band = 0;
        if (level > 0 &&
            psi.band(level).blocks.copy_window(psi.band(level).coefficients.data(), node, {1, 1, 1}, 1, &of_band)) {
          c = of_band;
        }
        const double term = c * B.x.N[lane[0]] * B.y.N[lane[1]] * B.z.N[lane[2]];
        sum += term;
        size += std::abs(term);
      }
    }
    Vec3 g;
    Mat3 H;
    EXPECT_NEAR(psi.value(x), sum, 1e-14 * size);
    EXPECT_EQ(psi.evaluate(x, &g, &H), psi.value(x));
    EXPECT_EQ(psi.gradient(x), g);
  }
}

TEST(LevelSet, WhatIsForgottenIsMadeAgain) {
  SsdParams p;
  p.spacing = 0.08;
  p.coarsest_nodes = 8000;
  const LevelSet psi = fit_ssd(torus_cloud(8000), p).psi;
  ASSERT_GE(psi.n_levels(), 2);
  const std::vector<Vec3> points = torus_cloud(500, 8).points;
  std::vector<double> before;
  for (const Vec3& x : points) before.push_back(psi.value(x));
  // Where the coefficients are that evaluations have made of the finest level, asked for in steps through the points.
  const int level = psi.n_levels() - 1;
  const Lattice& finest = psi.lattice(level);
  const auto places = [&](std::size_t step) {
    std::vector<const float*> at(points.size());
    for (std::size_t i = 0; i < at.size(); ++i) {
      const std::size_t k = step * i % at.size();
      const Vec3 cell = ((points[k] - finest.origin) / finest.h).array().floor();
      at[k] = psi.band_window(level, cell.cast<int>()).first;
    }
    return at;
  };
  // Other steps each time: in one order memory could be given out again as it was.
  for (const auto& [spacing, step] : {std::pair(psi.spacing(), 1), {1.01 * psi.spacing(), 7}, {10., 11}}) {
    const std::vector<const float*> made = places(step);
    psi.forget_below(spacing);
    EXPECT_EQ(places(step + 2) == made, spacing <= finest.h) << spacing;
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(psi.value(points[i]), before[i]);
  }
}

TEST(LevelSet, PlacesThatAreApartHaveTheSameBits) {
  SsdParams p;
  p.spacing = 0.08;
  p.coarsest_nodes = 8000;
  for (const int support : {2, 3, 4}) {
    p.prior.support = support;
    const LevelSet psi = fit_ssd(torus_cloud(8000), p).psi;
    ASSERT_GE(psi.n_levels(), 2);
    const LevelSetApart apart(psi);
    std::vector<Vec3> places = torus_cloud(500, 8).points;
    for (const double t : {-2., -.1, .3, .999, 1., 1.2})
      places.push_back(psi.domain().min() + t * psi.domain().sizes());
    for (const Vec3& x : places) {
      Vec3 g, h;
      Mat3 G, H;
      EXPECT_EQ(apart.value(x), psi.value(x));
      EXPECT_EQ(apart.evaluate(x, &g, nullptr), psi.evaluate(x, &h, nullptr));
      EXPECT_EQ(g, h);
      EXPECT_EQ(apart.evaluate(x, &g, &G), psi.evaluate(x, &h, &H));
      EXPECT_EQ(G, H);
    }
  }
}

// Copies of coefficients for evaluation are made by the thread that first evaluates in a block of cells: here by all
// threads at once.
TEST(LevelSet, WhoAsksFirstMakesNoDifference) {
  SsdParams p;
  p.spacing = 0.08;
  p.coarsest_nodes = 8000;
  const LevelSet psi = fit_ssd(torus_cloud(8000), p).psi;
  ASSERT_GE(psi.n_levels(), 2);
  const std::vector<Vec3> points = torus_cloud(2000, 8).points;
  std::vector<double> alone;
  for (const Vec3& x : points) alone.push_back(psi.value(x));
  std::vector<LevelSetBand> bands;
  for (int level = 1; level < psi.n_levels(); ++level) bands.push_back(psi.band(level));
  const LevelSet fresh(psi.prior(), psi.coarsest(), std::move(bands));
  std::vector<std::vector<double>> together(4);
  std::vector<std::thread> threads;
  for (std::vector<double>& values : together) {
    threads.emplace_back([&] {
      for (const Vec3& x : points) values.push_back(fresh.value(x));
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<double>& values : together) EXPECT_EQ(values, alone);
}

TEST(LevelSetIo, ComesBackBitEqual) {
  const LevelSet& psi = torus_level_set();
  const std::filesystem::path file = scratch("level_set.vti");
  write_level_set(file, psi, Vec3(1e7, 0, -3));
  const LevelSet back = read_level_set(file);
  const auto &a = psi.coarsest(), &b = back.coarsest();
  EXPECT_EQ(a.lattice, b.lattice);
  EXPECT_EQ(psi.prior(), back.prior());
  ASSERT_EQ(a.coefficients.size(), b.coefficients.size());
  EXPECT_EQ(std::memcmp(a.coefficients.data(), b.coefficients.data(), a.coefficients.size() * sizeof(double)), 0);
  for (const Vec3& x : torus_cloud(20, 8).points) EXPECT_EQ(psi.value(x), back.value(x));
  std::filesystem::remove(file);
}

TEST(LevelSetIo, BandsComeBackBitEqual) {
  SsdParams p;
  p.spacing = 0.08;
  p.coarsest_nodes = 8000;
  const LevelSet psi = fit_ssd(torus_cloud(8000), p).psi;
  ASSERT_GE(psi.n_levels(), 2);
  const std::filesystem::path file = scratch("bands.vti");
  write_level_set(file, psi);
  const LevelSet back = read_level_set(file);
  ASSERT_EQ(back.n_levels(), psi.n_levels());
  for (int level = 1; level < psi.n_levels(); ++level) {
    EXPECT_EQ(back.band(level).blocks, psi.band(level).blocks);
    EXPECT_EQ(back.band(level).coefficients, psi.band(level).coefficients);
  }
  for (const Vec3& x : torus_cloud(20, 8).points) EXPECT_EQ(psi.value(x), back.value(x));
  // Without one of its bands the file is another level set: refused, not read as a coarser one.
  std::ifstream in(file, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::string name = "level_1_blocks";
  text.replace(text.find(name), name.size(), "level_9_blocks");
  std::ofstream(file, std::ios::binary) << text;
  EXPECT_THROW(read_level_set(file), LevelSetRefused);
  std::filesystem::remove(file);
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// As this version writes it, and as 0.9 did, in base64.
TEST(LevelSetIo, RefusesWhatContradictsItself) {
  const std::filesystem::path file = scratch("hostile.vti");
  write_level_set(file, torus_level_set());
  const std::string raw = bytes_of(file);
  const std::string base64 = bytes_of(std::filesystem::path(UMTET_SOURCE_DIR) / "tests/corpus/files/level_set/one.vti");
  using Change = std::pair<const char*, const char*>;
  const std::vector<Change> of_both = {
      {"Float64", "Float42"},
      {"Float64", "Float32"},
      {"NumberOfTuples=\"7\"", "NumberOfTuples=\"4000000000\""},
      {"WholeExtent=\"0 ", "WholeExtent=\"0 4000000000"},
      {"Piece Extent=\"0 ", "Piece Extent=\"0  "},
      {"</PointData>", "</CellData>"},
      {"type=\"ImageData\"", "type=\"ImageData\" compressor=\"vtkZLibDataCompressor\""},
      {"LittleEndian", "BigEndian"},
      {"<?xml", "<!DOCTYPE x><?xml"}};
  const auto expect_refused = [&](std::string text, const Change& change) {
    const auto& [from, to] = change;
    ASSERT_NE(text.find(from), std::string::npos) << from;
    text.replace(text.find(from), std::string(from).size(), to);
    std::ofstream(file, std::ios::binary) << text;
    try {
      read_level_set(file);
      ADD_FAILURE() << to;
    } catch (const LevelSetRefused& refused) {
      EXPECT_NE(std::string(refused.what()).find("byte "), std::string::npos) << refused.what();
    }
  };
  for (const Change& change : of_both) {
    expect_refused(raw, change);
    expect_refused(base64, change);
  }
  expect_refused(base64, {"AAAA", "AAA"});
  expect_refused(base64, {"format=\"binary\"", "format=\"appended\" offset=\"9\""});
  expect_refused(raw, {"offset=\"0\"", "offset=\"9\""});
  expect_refused(raw, {"encoding=\"raw\"", "encoding=\"base64\""});
  expect_refused(raw, {"</VTKFile>", "</VTK"});
  std::filesystem::remove(file);
}

TEST(LevelSetIo, RefusesWhatIsNotALevelSet) {
  const std::filesystem::path file = scratch("damaged.vti");
  EXPECT_THROW(read_level_set(scratch("absent.vti")), std::runtime_error);
  std::ofstream(file) << "<?xml version=\"1.0\"?><VTKFile type=\"ImageData\" version=\"1.0\"></VTKFile>";
  EXPECT_THROW(read_level_set(file), LevelSetRefused);
  std::ofstream(file) << "no xml at all";
  EXPECT_THROW(read_level_set(file), LevelSetRefused);
  write_level_set(file, torus_level_set());
  const std::uintmax_t size = std::filesystem::file_size(file);
  std::fstream damaged(file, std::ios::in | std::ios::out | std::ios::binary);
  damaged.seekp(static_cast<std::streamoff>(size / 2));
  damaged.put('!');
  damaged.close();
  EXPECT_THROW(read_level_set(file), LevelSetRefused);
  write_level_set(file, torus_level_set());
  std::filesystem::resize_file(file, size / 2);
  EXPECT_THROW(read_level_set(file), LevelSetRefused);
  std::ofstream(file)
      << "<?xml version=\"1.0\"?><VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\">"
         "<ImageData WholeExtent=\"0 99999 0 99999 0 99999\" Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece "
         "Extent=\"0 99999 0 99999 0 99999\"></Piece></ImageData></VTKFile>";
  EXPECT_THROW(read_level_set(file), LevelSetRefused);
  std::filesystem::remove(file);
}

TEST(LevelSetIo, SaysWhenTheFileCannotBeWritten) {
  EXPECT_THROW(write_level_set("/nonexistent/folder/x.vti", torus_level_set()), std::runtime_error);
  EXPECT_THROW(write_level_set("/dev/full", torus_level_set()), std::runtime_error);
}
