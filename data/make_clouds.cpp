// make_clouds OUTDIR: writes the clouds of data/clouds, byte by byte the same on every machine.
//
// Shapes are in shapes.h, what each cloud is for in README.md.

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "data/surface_sampling.h"
#include "reconstruct/io/point_cloud_io.h"

namespace umtet {
namespace {

void write(const std::filesystem::path& file, const OrientedPointCloud& cloud) {
  std::ofstream out(file, std::ios::binary);
  write_ply(out, cloud);
  out.close();
  if (!out) throw std::runtime_error("cannot write " + file.string());
  std::printf("%s: %zu points\n", file.string().c_str(), cloud.points.size());
}

/// e^4 : 1 from the thin end of the blob (x = 1) to the thick one (x = -1); a polynomial, for the same bytes
/// everywhere.
double denser_along_x(const Vec3& x) {
  constexpr double kE = 2.718281828459045;
  const double t = x[0] < -1 ? 0 : x[0] > 1 ? 1 : 0.5 * (x[0] + 1);
  const double root4 = (1 + (kE - 1) * t) / kE;
  return root4 * root4 * root4 * root4;
}

/// Sum of twelve uniforms: mean 0, deviation 1, close to normal, and no logarithm in it.
double bell(Uniform& uniform) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += uniform();
  return sum;
}

/// Takes the samples within `radius` of `centre` away; displaces the others along their normals (deviation `noise`)
/// and tilts the normals (rms angle with tangent `tilt`).
OrientedPointCloud scanned(const OrientedPointCloud& clean, const Vec3& centre, double radius, double noise,
                           double tilt, std::uint64_t seed) {
  Uniform uniform(seed);
  OrientedPointCloud scan;
  for (std::size_t i = 0; i < clean.points.size(); ++i) {
    const Vec3 &x = clean.points[i], &n = clean.normals[i];
    const double shift = noise * bell(uniform);
    Vec3 error;  // its part along n changes the length only; two of three directions tilt, each by tilt / sqrt(2)
    for (int a = 0; a < 3; ++a) error[a] = tilt * std::sqrt(0.5) * bell(uniform);
    const Vec3 to = x - centre;
    if (to[0] * to[0] + to[1] * to[1] + to[2] * to[2] < radius * radius) continue;
    const double along = error[0] * n[0] + error[1] * n[1] + error[2] * n[2];
    const Vec3 m = n + error - along * n;
    scan.points.push_back(x + shift * n);
    scan.normals.push_back(m / std::sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]));
  }
  return scan;
}

void make_clouds(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const auto sphere_box = [](double a) { return Vec3(a, a, a); };
  write(folder / "duck.ply", sample_surface(duck, Vec3(-1.1, -0.4, -0.9), Vec3(1.3, 0.9, 0.9), 5344, 1));
  write(folder / "bird.ply", sample_surface(bird, Vec3(-2.2, -0.6, -1.5), Vec3(2.2, 0.7, 1.6), 10000, 2));
  write(folder / "knot.ply", sample_surface(knot, -sphere_box(1.4), sphere_box(1.4), 14000, 3));
  const OrientedPointCloud clean = sample_surface(torus, Vec3(-1.5, -1.5, -0.5), Vec3(1.5, 1.5, 0.5), 12000, 4);
  const double diagonal = std::sqrt(2.8 * 2.8 + 2.8 * 2.8 + 0.8 * 0.8);
  const double tan_3_degrees = 0.05240777928304120;
  write(folder / "torus_hole_noise.ply", scanned(clean, Vec3(0.6, 0.8, 0.4), 0.3, 0.002 * diagonal, tan_3_degrees, 5));
  write(folder / "blob_nonuniform.ply",
        sample_surface(blob, Vec3(-1.2, -0.8, -0.8), Vec3(1.2, 0.8, 0.8), 8000, 6, denser_along_x));
}

}  // namespace
}  // namespace umtet

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_clouds OUTDIR\n");
    return 2;
  }
  try {
    umtet::make_clouds(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_clouds: %s\n", error.what());
    return 1;
  }
  return 0;
}
