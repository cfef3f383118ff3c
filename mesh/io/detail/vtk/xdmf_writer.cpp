#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "mesh/io/checked_file.h"
#include "mesh/io/detail/vtk/hdf5_handle.h"
#include "mesh/io/detail/vtk/node_sets.h"
#include "mesh/io/hdf5_shape.h"
#include "mesh/io/solver_files.h"

namespace umtet {
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double));

using detail::checked;
using detail::Handle;
using detail::memory_type;
using detail::QuietHdf5;

/// How datasets are made.
struct DatasetProperties {
  Handle make{H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "H5Pcreate"};
  Handle link{H5Pcreate(H5P_LINK_CREATE), H5Pclose, "H5Pcreate"};

  DatasetProperties() {
    checked(H5Pset_obj_track_times(make, false), "H5Pset_obj_track_times");  // equal bytes for equal meshes
    checked(H5Pset_create_intermediate_group(link, 1), "H5Pset_create_intermediate_group");
  }
};

/// A file in memory, written by CheckedFile in the end: HDF5 writes late, so that a full disk would show at its close
/// or at the end of the program.
class Hdf5Image {
 public:
  Hdf5Image() : access_(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "H5Pcreate"), file_(create(), H5Fclose, "H5Fcreate") {}

  /// @param columns  0: a list
  template <class T>
  void put(const std::string& name, const T* values, std::size_t rows, std::size_t columns = 0) {
    const hsize_t size[2] = {rows, columns};
    const Handle space(H5Screate_simple(columns == 0 ? 1 : 2, size, nullptr), H5Sclose, "H5Screate_simple");
    const Handle set(
        H5Dcreate2(file_, name.c_str(), memory_type<T>(), space, properties_.link, properties_.make, H5P_DEFAULT),
        H5Dclose, "H5Dcreate");
    if (rows > 0) checked(H5Dwrite(set, memory_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "H5Dwrite");
  }
  void put(const std::string& name, const FieldValues& any) {
    std::visit(
        [&](const auto& values) {
          using Value = typename std::decay_t<decltype(values)>::value_type;
          if constexpr (std::is_same_v<Value, Vec3>) {
            put(name, reinterpret_cast<const double*>(values.data()), values.size(), 3);
          } else {
            put(name, values.data(), values.size());
          }
        },
        any);
  }

  std::string bytes() {
    checked(H5Fflush(file_, H5F_SCOPE_GLOBAL), "H5Fflush");
    std::string image(static_cast<std::size_t>(checked(H5Fget_file_image(file_, nullptr, 0), "H5Fget_file_image")),
                      '\0');
    checked(H5Fget_file_image(file_, image.data(), image.size()), "H5Fget_file_image");
    return image;
  }

 private:
  hid_t create() {
    constexpr std::size_t kGrowth = std::size_t{1} << 20;
    constexpr bool kOnDisk = false;
    checked(H5Pset_fapl_core(access_, kGrowth, kOnDisk), "H5Pset_fapl_core");
    return H5Fcreate("in memory", H5F_ACC_TRUNC, H5P_DEFAULT, access_);
  }

  DatasetProperties properties_;
  Handle access_, file_;
};

void put_faces(Hdf5Image& image, const SolverMesh& mesh) {
  const std::vector<int> faces = mesh.faces();
  image.put("faces", faces.data(), mesh.n_faces(), static_cast<std::size_t>(mesh.nodes_per_face()));
  image.put("patch", FieldValues(detail::patch_numbers(mesh)));
}

/// One grid: its cells are the dataset `cells` of the HDF5 file.
class XdmfWriter {
 public:
  XdmfWriter(const std::filesystem::path& path, std::size_t n_nodes, std::string hdf5)
      : n_nodes_(n_nodes), hdf5_(std::move(hdf5)), file_(path) {}

  template <class Index = int>
  void grid(const char* name, const char* topology, const char* cells, std::size_t n_cells, int n_nodes) {
    file_.text("<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\"><Domain><Grid Name=\"").text(name);
    file_.text("\" GridType=\"Uniform\">\n<Geometry GeometryType=\"XYZ\">\n");
    item<double>("nodes", n_nodes_, 3);
    file_.text("</Geometry>\n<Topology TopologyType=\"").text(topology);
    file_.text("\" NumberOfElements=\"").number(n_cells).text("\">\n");
    item<Index>(cells, n_cells, n_nodes);
    file_.text("</Topology>\n");
  }
  template <class T>
  void attribute(const std::string& name, const char* center, const std::string& dataset, std::size_t n) {
    constexpr bool kIsVector = std::is_same_v<T, Vec3>;
    file_.text("<Attribute Name=\"").text(name).text("\" AttributeType=\"").text(kIsVector ? "Vector" : "Scalar");
    file_.text("\" Center=\"").text(center).text("\">\n");
    item<std::conditional_t<kIsVector, double, T>>(dataset, n, kIsVector ? 3 : 0);
    file_.text("</Attribute>\n");
  }
  void attributes(const std::map<std::string, FieldValues>& data, const char* center, const std::string& group) {
    for (const auto& [name, any] : data) {
      std::visit(
          [&, &name = name](const auto& values) {
            using Value = typename std::decay_t<decltype(values)>::value_type;
            attribute<Value>(name, center, group + name, values.size());
          },
          any);
    }
  }
  /// As meshio does: XDMF has no word for it.
  void names(const char* kind, int dimension, const std::vector<MeshPart>& parts) {
    file_.text("<Information Name=\"").text(kind).text("\"><![CDATA[<main>");
    for (const MeshPart& part : parts) {
      file_.text("<map key=\"").text(part.name).text("\" dim=\"").number(dimension).text("\">");
      file_.number(part.number).text("</map>");
    }
    file_.text("</main>]]></Information>\n");
  }
  void end() {
    file_.text("</Grid></Domain></Xdmf>\n");
    file_.close();
  }

 private:
  template <class T>
  void item(const std::string& dataset, std::size_t rows, int columns) {
    file_.text("<DataItem DataType=\"");
    file_.text(std::is_same_v<T, double> ? "Float" : std::is_same_v<T, std::uint8_t> ? "UChar" : "Int");
    file_.text("\" Precision=\"").number(sizeof(T)).text("\" Dimensions=\"").number(rows);
    if (columns > 0) file_.text(" ").number(columns);
    file_.text("\" Format=\"HDF\">").text(hdf5_).text(":/").text(dataset).text("</DataItem>\n");
  }

  std::size_t n_nodes_;
  std::string hdf5_;
  CheckedFile file_;
};

}  // namespace

void write_hdf5(const std::filesystem::path& path, const SolverMesh& mesh) {
  require_consistent(mesh);
  std::string bytes;
  {
    const QuietHdf5 quiet;
    Hdf5Image image;
    image.put("nodes", reinterpret_cast<const double*>(mesh.nodes.data()), mesh.nodes.size(), 3);
    image.put("tets", mesh.tets.data(), mesh.n_tets(), static_cast<std::size_t>(mesh.nodes_per_tet));
    put_faces(image, mesh);
    for (const auto& [name, values] : detail::with_node_sets(mesh)) image.put("point_data/" + name, values);
    for (const auto& [name, values] : mesh.cell_data) image.put("cell_data/" + name, values);
    bytes = image.bytes();
  }
  CheckedFile file(path);
  file.text(bytes);
  file.close();
}

void write_boundary_hdf5(const std::filesystem::path& path, const SolverMesh& mesh) {
  require_consistent(mesh);
  std::string bytes;
  {
    const QuietHdf5 quiet;
    Hdf5Image image;
    put_faces(image, mesh);
    bytes = image.bytes();
  }
  CheckedFile file(path);
  file.text(bytes);
  file.close();
}

void write_xdmf(const std::filesystem::path& path, const SolverMesh& mesh, const std::string& hdf5) {
  require_consistent(mesh);
  const bool linear = mesh.nodes_per_tet == 4;
  XdmfWriter out(path, mesh.nodes.size(), hdf5);
  out.grid("mesh", linear ? "Tetrahedron" : "Tetrahedron_10", "tets", mesh.n_tets(), mesh.nodes_per_tet);
  std::map<std::string, FieldValues> first, others = mesh.cell_data;
  if (!mesh.regions.empty()) {
    // dolfinx reads the first attribute as the tags of cells.
    if (auto region = others.extract("region")) first.insert(std::move(region));
    out.names("regions", 3, mesh.regions);
  }
  out.attributes(first, "Cell", "cell_data/");
  out.attributes(detail::with_node_sets(mesh), "Node", "point_data/");
  out.attributes(others, "Cell", "cell_data/");
  out.end();
}

void write_boundary_xdmf(const std::filesystem::path& path, const SolverMesh& mesh, const std::string& hdf5) {
  require_consistent(mesh);
  const bool linear = mesh.nodes_per_tet == 4;
  XdmfWriter out(path, mesh.nodes.size(), hdf5);
  out.grid("boundary", linear ? "Triangle" : "Triangle_6", "faces", mesh.n_faces(), mesh.nodes_per_face());
  out.names("patches", 2, mesh.patches);
  out.attribute<std::int64_t>("patch", "Cell", "patch", mesh.n_faces());
  out.attributes(mesh.boundary_data, "Node", "point_data/");
  out.end();
}

std::vector<std::uint64_t> make_hdf5(const std::filesystem::path& path, const std::vector<Hdf5Array>& arrays) {
  const QuietHdf5 quiet;
  std::vector<std::uint64_t> begins;
  DatasetProperties properties;
  checked(H5Pset_alloc_time(properties.make, H5D_ALLOC_TIME_EARLY), "H5Pset_alloc_time");
  checked(H5Pset_fill_time(properties.make, H5D_FILL_TIME_NEVER), "H5Pset_fill_time");
  const Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose, "H5Fcreate");
  for (const Hdf5Array& array : arrays) {
    const hid_t type = std::visit([](auto value) { return memory_type<decltype(value)>(); }, array.type);
    const hsize_t size[2] = {array.rows, array.columns};
    const Handle space(H5Screate_simple(array.columns == 0 ? 1 : 2, size, nullptr), H5Sclose, "H5Screate_simple");
    const Handle set(H5Dcreate2(file, array.name.c_str(), type, space, properties.link, properties.make, H5P_DEFAULT),
                     H5Dclose, "H5Dcreate");
    const haddr_t begin = H5Dget_offset(set);
    if (begin == HADDR_UNDEF && array.rows > 0) throw std::runtime_error("H5Dget_offset");
    begins.push_back(begin);
  }
  checked(H5Fflush(file, H5F_SCOPE_GLOBAL), "H5Fflush");
  return begins;
}

void write_xdmf(const std::filesystem::path& path, const XdmfShape& shape, const std::string& hdf5) {
  XdmfWriter out(path, shape.n_nodes, hdf5);
  if (shape.has_wide_ids()) {
    out.grid<std::int64_t>("mesh", "Tetrahedron", "tets", shape.n_tets, 4);
  } else {
    out.grid("mesh", "Tetrahedron", "tets", shape.n_tets, 4);
  }
  out.attribute<std::int64_t>("background_vertex", "Node", "point_data/background_vertex", shape.n_nodes);
  for (const std::string& set : shape.node_sets())
    out.attribute<std::uint8_t>(set, "Node", "point_data/" + set, shape.n_nodes);
  out.attribute<std::int64_t>("background_tet", "Cell", "cell_data/background_tet", shape.n_tets);
  out.attribute<double>("mean_ratio", "Cell", "cell_data/mean_ratio", shape.n_tets);
  out.end();
}

void write_boundary_xdmf(const std::filesystem::path& path, const XdmfShape& shape, const std::string& hdf5) {
  XdmfWriter out(path, shape.n_nodes, hdf5);
  if (shape.has_wide_ids()) {
    out.grid<std::int64_t>("boundary", "Triangle", "faces", shape.n_faces, 3);
  } else {
    out.grid("boundary", "Triangle", "faces", shape.n_faces, 3);
  }
  out.names("patches", 2, shape.patches);
  out.attribute<std::int64_t>("patch", "Cell", "patch", shape.n_faces);
  out.end();
}

}  // namespace umtet
