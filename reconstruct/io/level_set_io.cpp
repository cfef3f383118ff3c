#include "reconstruct/io/level_set_io.h"

#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkObject.h>
#include <vtkPointData.h>
#include <vtkXMLImageDataReader.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <system_error>

#include "reconstruct/io/detail/grids/vti_precheck.h"
#include "reconstruct/io/detail/grids/vti_writer.h"

namespace umtet {

namespace {

// VTK prints what goes wrong; a library prints nothing. What matters is found from error codes and from the data
// instead.
class QuietVtk {
 public:
  QuietVtk() : before_(vtkObject::GetGlobalWarningDisplay()) { vtkObject::GlobalWarningDisplayOff(); }
  ~QuietVtk() { vtkObject::SetGlobalWarningDisplay(before_); }
  QuietVtk(const QuietVtk&) = delete;
  QuietVtk& operator=(const QuietVtk&) = delete;

 private:
  int before_;
};

// Two halves of the hash of all coefficients: VTK's reader leaves arrays as they were, without an error, where base64
// is damaged.
std::vector<double> hash(const LevelSet& psi) {
  XXH64_hash_t h = XXH64(psi.coarsest().coefficients.data(),
                         static_cast<std::size_t>(psi.coarsest().lattice.size()) * sizeof(double), 0);
  for (int level = 1; level < psi.n_levels(); ++level) {
    const LevelSetBand& band = psi.band(level);
    h = XXH64(band.blocks.blocks().data(), band.blocks.blocks().size() * sizeof(Eigen::Vector3i), h);
    h = XXH64(band.coefficients.data(), band.coefficients.size() * sizeof(float), h);
  }
  return {static_cast<double>(h >> 32), static_cast<double>(h & 0xffffffffu)};
}

std::string band_name(int level, const char* what) { return fmt::format("level_{}_{}", level, what); }

// @param size  0: any
template <class Array = vtkDoubleArray, class Value = double>
std::vector<Value> read_field(vtkImageData* image, const std::string& name, std::size_t size, const std::string& file) {
  auto* a = Array::SafeDownCast(image->GetFieldData()->GetArray(name.c_str()));
  if (!a || (size > 0 && static_cast<std::size_t>(a->GetNumberOfValues()) != size)) {
    throw LevelSetRefused(fmt::format("{}: field data '{}' with {} numbers is missing: not a level set of this program",
                                      file, name, size));
  }
  return {a->GetPointer(0), a->GetPointer(0) + a->GetNumberOfValues()};
}

// The bands of a file of n_bytes, on lattices that follow from the coarsest one.
std::vector<LevelSetBand> read_bands(vtkImageData* image, const Lattice& coarsest, int half_width, double n_bytes,
                                     const std::string& file) {
  std::vector<LevelSetBand> bands;
  Lattice lattice = coarsest;
  for (int level = 1; image->GetFieldData()->HasArray(band_name(level, "blocks").c_str()); ++level) {
    // A band around a surface has more bytes than its lattice has blocks.
    const Eigen::Array3d n_blocks = 2 * lattice.n.array().cast<double>() / LatticeBlocks::kEdge;
    if (n_blocks.prod() > n_bytes || n_blocks.maxCoeff() > n_bytes) {
      throw LevelSetRefused(fmt::format("{}: level {} is finer than a file of {} bytes can be", file, level, n_bytes));
    }
    lattice.h /= 2;
    lattice.n = (2 * (lattice.n.array() - 1) + 1).matrix();
    const std::vector<double> corners = read_field(image, band_name(level, "blocks"), 0, file);
    std::vector<Eigen::Vector3i> blocks;
    for (std::size_t i = 0; i + 3 <= corners.size(); i += 3) {
      const Eigen::Vector3d at(corners[i], corners[i + 1], corners[i + 2]);
      // What is no index becomes none that a lattice has.
      const bool is_index = (at.array() >= 0).all() && (at.array() < n_bytes).all();
      blocks.push_back(is_index ? at.cast<int>() : Eigen::Vector3i(-1, -1, -1));
    }
    LevelSetBand band{LatticeBlocks(lattice, half_width, blocks), {}};
    if (corners.size() % 3 != 0 || band.blocks.blocks() != blocks) {
      throw LevelSetRefused(fmt::format("{}: the blocks of level {} are not in order", file, level));
    }
    band.coefficients =
        read_field<vtkFloatArray, float>(image, band_name(level, "psi_a"), blocks.size() * LatticeBlocks::kNodes, file);
    bands.push_back(std::move(band));
  }
  return bands;
}

}  // namespace

void write_level_set(const std::filesystem::path& file, const LevelSet& psi, const Vec3& shown_at) {
  const LevelSetLevel& level = psi.coarsest();
  const Lattice& L = level.lattice;
  const Vec3 origin = L.origin + shown_at;
  const std::string extent = fmt::format("0 {} 0 {} 0 {}", L.n[0] - 1, L.n[1] - 1, L.n[2] - 1);
  detail::VtiWriter out(file);
  out.text("<?xml version=\"1.0\"?>\n")
      .text("<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n")
      .text(fmt::format("<ImageData WholeExtent=\"{}\" Origin=\"{} {} {}\" Spacing=\"{} {} {}\" "
                        "Direction=\"1 0 0 0 1 0 0 0 1\">\n<FieldData>\n",
                        extent, origin[0], origin[1], origin[2], L.h, L.h, L.h));
  out.field("lattice", std::vector<double>{L.origin[0], L.origin[1], L.origin[2], L.h, double(L.n[0]), double(L.n[1]),
                                           double(L.n[2])});
  const LmePrior& prior = psi.prior();
  out.field("prior", std::vector<double>{double(prior.kind), prior.gamma, double(prior.support), prior.epsilon});
  for (int l = 1; l < psi.n_levels(); ++l) {
    const LevelSetBand& band = psi.band(l);
    std::vector<double> corners;
    for (const Eigen::Vector3i& b : band.blocks.blocks()) corners.insert(corners.end(), b.begin(), b.end());
    out.field(band_name(l, "blocks"), corners).field(band_name(l, "psi_a"), band.coefficients);
  }
  out.field("xxh64", hash(psi)).text(fmt::format("</FieldData>\n<Piece Extent=\"{}\">\n", extent));
  out.text("<PointData Scalars=\"psi_a\">\n").points("psi_a", level.coefficients);
  out.text("</PointData>\n<CellData>\n</CellData>\n</Piece>\n</ImageData>\n</VTKFile>\n").close();
}

LevelSet read_level_set(const std::filesystem::path& path) {
  const std::string file = path.string();
  if (std::ifstream probe(path, std::ios::binary); !probe) {
    throw std::system_error(errno ? errno : EIO, std::generic_category(), fmt::format("{}: cannot be opened", file));
  }
  detail::precheck_vti(path);
  const QuietVtk quiet;
  vtkNew<vtkXMLImageDataReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  if (reader->GetErrorCode() != vtkErrorCode::NoError || !image) {
    throw LevelSetRefused(
        fmt::format("{}: damaged: {}", file, vtkErrorCode::GetStringFromErrorCode(reader->GetErrorCode())));
  }
  const std::vector<double> l = read_field(image, "lattice", 7, file), p = read_field(image, "prior", 4, file);
  const auto is_finite = [](double v) { return std::isfinite(v); };
  if (!std::all_of(l.begin(), l.end(), is_finite) || !std::all_of(p.begin(), p.end(), is_finite)) {
    throw LevelSetRefused(file + ": 'lattice' or 'prior' is absurd");
  }
  for (const double number : {p[0], p[2]}) {
    if (!(number >= 0 && number <= 4)) throw LevelSetRefused(file + ": unknown prior");
  }
  const LmePrior prior{static_cast<LmePrior::Kind>(static_cast<int>(p[0])), p[1], static_cast<int>(p[2]), p[3]};
  const std::vector<std::string> wrong = problems(prior);
  if (p[0] != 0 && p[0] != 1) throw LevelSetRefused(file + ": unknown prior");
  if (!wrong.empty()) throw LevelSetRefused(file + ": " + wrong.front());
  const int* dims = image->GetDimensions();
  Lattice lattice{{l[0], l[1], l[2]}, l[3], {dims[0], dims[1], dims[2]}};
  if (l[4] != dims[0] || l[5] != dims[1] || l[6] != dims[2] || !(l[3] > 0)) {
    throw LevelSetRefused(file + ": the field data 'lattice' does not fit the image");
  }
  auto* a = vtkDoubleArray::SafeDownCast(image->GetPointData()->GetArray("psi_a"));
  if (!a || a->GetNumberOfComponents() != 1 || a->GetNumberOfTuples() != lattice.size()) {
    throw LevelSetRefused(fmt::format("{}: point data 'psi_a' with {} doubles is missing", file, lattice.size()));
  }
  std::vector<double> c(a->GetPointer(0), a->GetPointer(0) + lattice.size());
  for (const double v : c) {
    if (!std::isfinite(v)) throw LevelSetRefused(file + ": a coefficient is not finite");
  }
  try {
    const auto n_bytes = static_cast<double>(std::filesystem::file_size(path));
    LevelSet psi(prior, {lattice, std::move(c)}, read_bands(image, lattice, half_width(prior), n_bytes, file));
    if (read_field(image, "xxh64", 2, file) != hash(psi)) {
      throw LevelSetRefused(file + ": damaged: the coefficients do not have the hash that was written with them");
    }
    return psi;
  } catch (const std::invalid_argument& e) {
    throw LevelSetRefused(fmt::format("{}: {}", file, e.what()));
  }
}

}  // namespace umtet
