// Every encoding of VTK's XML files holds the same numbers: a mesh and an image, encoded here from their numbers.

#include <gtest/gtest.h>
#include <lz4.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <numeric>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "mesh/io/tet_mesh_io.h"
#include "reconstruct/io/grid_io.h"
#include "tests/support/mesh_files.h"

namespace umtet {
namespace {

using namespace test;

enum class Where { Ascii, Inline, AppendedRaw, AppendedBase64 };
enum class Packed { No, Zlib, Lz4 };

/// RFC 4648, Section 4: six bits at a time.
std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t first = 0; first < 8 * bytes.size(); first += 6) {
    unsigned value = 0;
    for (std::size_t bit = first; bit < first + 6; ++bit) {
      const bool is_in = bit < 8 * bytes.size();
      value = 2 * value + (is_in ? static_cast<unsigned char>(bytes[bit / 8]) >> (7 - bit % 8) & 1U : 0U);
    }
    text += kDigits[value];
  }
  text.resize((bytes.size() + 2) / 3 * 4, '=');
  return text;
}

/// Writes a VTK XML file in one encoding. The last part of a packed array is shorter, and numbers lie across parts.
class Encoder {
 public:
  Encoder(Where where, Packed packed, int header_bytes, bool is_big)
      : where_(where), packed_(packed), header_bytes_(header_bytes), is_big_(is_big) {}

  std::string root(const std::string& type) const {
    const char* const packer = packed_ == Packed::Zlib  ? " compressor=\"vtkZLibDataCompressor\""
                               : packed_ == Packed::Lz4 ? " compressor=\"vtkLZ4DataCompressor\""
                                                        : "";
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type + "\" version=\"1.0\" byte_order=\"" +
           (is_big_ ? "BigEndian" : "LittleEndian") + "\" header_type=\"UInt" + std::to_string(8 * header_bytes_) +
           "\"" + packer + ">\n";
  }
  template <class T>
  std::string array(const std::string& type, const std::string& attributes, const std::vector<T>& values) {
    const std::string head = "<DataArray type=\"" + type + "\" " + attributes + " format=\"";
    if (where_ == Where::Ascii) {
      std::ostringstream text;
      text.precision(17);
      for (const T v : values) text << +v << '\n';
      return head + "ascii\">\n" + text.str() + "</DataArray>\n";
    }
    std::string bytes;
    for (const T v : values) bytes += number(v);
    const bool as_text = where_ != Where::AppendedRaw;
    std::string block;
    if (packed_ == Packed::No) {
      block = count(bytes.size()) + bytes;
      if (as_text) block = base64(block);
    } else {
      constexpr std::size_t kPart = 101;
      std::string parts, sizes;
      const std::size_t n = (bytes.size() + kPart - 1) / kPart;
      for (std::size_t at = 0; at < bytes.size(); at += kPart) {
        const std::string part = pack(bytes.substr(at, kPart));
        sizes += count(part.size());
        parts += part;
      }
      const std::string header = count(n) + count(kPart) + count(bytes.size() % kPart) + sizes;
      block = as_text ? base64(header) + base64(parts) : header + parts;
    }
    if (where_ == Where::Inline) return head + "binary\">\n" + block + "\n</DataArray>\n";
    const std::string at = std::to_string(appended_.size());
    appended_ += block;
    return head + "appended\" offset=\"" + at + "\"/>\n";
  }
  std::string end() const {
    if (appended_.empty()) return "</VTKFile>\n";
    return std::string("<AppendedData encoding=\"") + (where_ == Where::AppendedRaw ? "raw" : "base64") + "\">\n_" +
           appended_ + "\n</AppendedData>\n</VTKFile>\n";
  }

 private:
  template <class T>
  std::string number(T v) const {
    std::string bytes(sizeof v, '\0');
    std::memcpy(bytes.data(), &v, sizeof v);
    if (is_big_) std::reverse(bytes.begin(), bytes.end());
    return bytes;
  }
  std::string count(std::size_t n) const {
    return header_bytes_ == 8 ? number(static_cast<std::uint64_t>(n)) : number(static_cast<std::uint32_t>(n));
  }
  std::string pack(const std::string& bytes) const {
    std::string made(2000, '\0');
    if (packed_ == Packed::Lz4) {
      made.resize(static_cast<std::size_t>(
          LZ4_compress_default(bytes.data(), made.data(), static_cast<int>(bytes.size()), 2000)));
      return made;
    }
    uLongf n = made.size();
    EXPECT_EQ(::compress(reinterpret_cast<Bytef*>(made.data()), &n, reinterpret_cast<const Bytef*>(bytes.data()),
                         bytes.size()),
              Z_OK);
    made.resize(n);
    return made;
  }

  Where where_;
  Packed packed_;
  int header_bytes_;
  bool is_big_;
  std::string appended_;
};

template <class Check>
void for_every_encoding(const Check& check) {
  for (const Where where : {Where::Ascii, Where::Inline, Where::AppendedRaw, Where::AppendedBase64}) {
    for (const Packed packed : {Packed::No, Packed::Zlib, Packed::Lz4}) {
      for (const int header_bytes : {4, 8}) {
        for (const bool is_big : {false, true}) {
          SCOPED_TRACE(::testing::Message()
                       << "encoding " << int(where) << " " << int(packed) << " " << header_bytes << " " << is_big);
          check(Encoder(where, packed, header_bytes, is_big));
        }
      }
    }
  }
}

std::string numbers_of(const char* name, std::size_t n) {
  return "Name=\"" + std::string(name) + "\"" +
         (n > 1 ? " NumberOfComponents=\"" + std::to_string(n) + "\"" : std::string());
}

TEST(VtkEncodings, AllHoldTheMeshThatWeWrite) {
  const Shape shape = sample(2);
  const std::size_t n_points = shape.mesh.V.size(), n_tets = shape.mesh.C.size();
  MeshFile mesh{shape.mesh, {}, {}, 0};
  std::mt19937_64 random(3);
  std::vector<std::int64_t> id(n_points);
  std::vector<std::uint8_t> byte(n_tets);
  for (std::int64_t& v : id) v = static_cast<std::int64_t>(random());
  for (std::uint8_t& v : byte) v = static_cast<std::uint8_t>(random());
  mesh.point_data = {{"id", id}, {"place", shape.mesh.V}};
  mesh.cell_data = {{"byte", byte}, {"half", std::vector<double>(n_tets, .5)}};
  const fs::path ours = scratch("ours.vtu");
  write_vtu(ours, mesh);
  const MeshFile expected = read_tet_mesh(ours);
  EXPECT_EQ(expected.point_data, mesh.point_data);
  EXPECT_EQ(expected.cell_data, mesh.cell_data);

  std::vector<double> places;
  for (const Vec3& x : shape.mesh.V) places.insert(places.end(), x.begin(), x.end());
  std::vector<std::int32_t> corners;
  std::vector<std::int64_t> ends;
  for (const Tet& t : shape.mesh.C) {
    corners.insert(corners.end(), t.begin(), t.end());
    ends.push_back(static_cast<std::int64_t>(corners.size()));
  }
  for_every_encoding([&](Encoder encoder) {
    std::string text = encoder.root("UnstructuredGrid") + "<UnstructuredGrid>\n<Piece NumberOfPoints=\"" +
                       std::to_string(n_points) + "\" NumberOfCells=\"" + std::to_string(n_tets) + "\">\n<PointData>\n";
    text += encoder.array("Int64", numbers_of("id", 1), id) + encoder.array("Float64", numbers_of("place", 3), places);
    text += "</PointData>\n<CellData>\n" + encoder.array("UInt8", numbers_of("byte", 1), byte) +
            encoder.array("Float32", numbers_of("half", 1), std::vector<float>(n_tets, .5F)) +
            "</CellData>\n<Points>\n";
    text += encoder.array("Float64", "NumberOfComponents=\"3\"", places) + "</Points>\n<Cells>\n";
    text += encoder.array("Int32", numbers_of("connectivity", 1), corners) +
            encoder.array("Int64", numbers_of("offsets", 1), ends) +
            encoder.array("UInt8", numbers_of("types", 1), std::vector<std::uint8_t>(n_tets, 10));
    text += "</Cells>\n</Piece>\n</UnstructuredGrid>\n" + encoder.end();
    const MeshFile read = read_tet_mesh(with_bytes("encoded.vtu", text));
    EXPECT_EQ(read.mesh.V, expected.mesh.V);
    EXPECT_EQ(read.mesh.C, expected.mesh.C);
    EXPECT_EQ(read.point_data, expected.point_data);
    EXPECT_EQ(read.cell_data, expected.cell_data);
  });
  fs::remove(ours);
  fs::remove(scratch("encoded.vtu"));
}

TEST(VtkEncodings, PiecesAreJoined) {
  const char* const kPiece =
      "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData><DataArray type=\"Int8\" Name=\"n\" format=\"ascii\">"
      "-1 2 3 4</DataArray></PointData><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">"
      "0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\" "
      "format=\"ascii\">0 1 2 3</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray>"
      "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray></Cells></Piece>";
  const MeshFile file =
      read_tet_mesh(with_bytes("pieces.vtu", std::string("<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>") +
                                                 kPiece + kPiece + "</UnstructuredGrid></VTKFile>"));
  EXPECT_EQ(file.mesh.C, (std::vector<Tet>{{0, 1, 2, 3}, {4, 5, 6, 7}}));
  EXPECT_EQ(std::get<std::vector<std::int64_t>>(file.point_data.at("n")),
            (std::vector<std::int64_t>{-1, 2, 3, 4, -1, 2, 3, 4}));
  fs::remove(scratch("pieces.vtu"));
}

TEST(VtkEncodings, AllHoldTheSameImage) {
  std::vector<float> values(7 * 6 * 8);
  std::iota(values.begin(), values.end(), -3.25F);
  const std::string extent = "0 6 0 5 0 7";
  for_every_encoding([&](Encoder encoder) {
    std::string text = encoder.root("ImageData") + "<ImageData WholeExtent=\"" + extent +
                       "\" Origin=\"1 2 3\" Spacing=\".5 .5 .5\">\n<Piece Extent=\"" + extent +
                       "\">\n<PointData Scalars=\"v\">\n";
    text += encoder.array("Float32", numbers_of("v", 1), values) + "</PointData>\n</Piece>\n</ImageData>\n";
    const Grid grid = read_grid(with_bytes("encoded.vti", text + encoder.end()));
    EXPECT_EQ(grid.origin, Vec3(1, 2, 3));
    EXPECT_TRUE(std::equal(values.begin(), values.end(), grid.values.begin(), grid.values.end()));
  });
  fs::remove(scratch("encoded.vti"));
}

TEST(VtkEncodings, LengthsThatContradictTheTagsAreRefused) {
  const auto piece = [](const std::string& points) {
    return "<VTKFile type=\"UnstructuredGrid\" header_type=\"UInt32\"><UnstructuredGrid><Piece NumberOfPoints=\"1\" "
           "NumberOfCells=\"0\"><Points>" +
           points + "</Points></Piece></UnstructuredGrid></VTKFile>";
  };
  const auto array = [&](const std::string& block) {
    return piece("<DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"binary\">" + block + "</DataArray>");
  };
  const std::string count{12, 0, 0, 0};
  const std::string good = base64(count + std::string(12, 'x'));
  for (const auto& [text, words] : std::vector<std::pair<std::string, std::string>>{
           {array(good), "no tets in this file"},
           {array(good.substr(0, 9) + " \n" + good.substr(9)), "no tets in this file"},
           {array(good + good), "longer than its header says"},
           {array(good.substr(0, 16)), "not base64"},
           {array(base64(std::string{16, 0, 0, 0} + std::string(16, 'x'))), "16 bytes, and 12 are needed"},
           {piece("<DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">1 2</DataArray>"),
            "1 numbers are missing"},
           {piece("<DataArray type=\"Float42\" NumberOfComponents=\"3\" format=\"ascii\">1 2 3</DataArray>"),
            "'Float42' is no type"},
           {piece("<DataArray type=\"Float32\" type=\"Float32\" format=\"ascii\">1 2 3</DataArray>"), "twice"}}) {
    const std::string said = refusal(with_bytes("lengths.vtu", text));
    EXPECT_NE(said.find(words), std::string::npos) << words << ": " << said;
  }
  fs::remove(scratch("lengths.vtu"));
}

}  // namespace
}  // namespace umtet
