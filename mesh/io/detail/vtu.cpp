#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>

#include "mesh/io/detail/mesh_formats.h"
#include "mesh/io/detail/vtu_precheck.h"

namespace umtet {
namespace {

/// VTK reports errors on a process-wide window and a process-wide log, and both print. While one of these lives they go
/// into a string instead.
class CapturedVtkMessages {
 public:
  CapturedVtkMessages()
      : lock_(mutex()), before_(vtkOutputWindow::GetInstance()), verbosity_(vtkLogger::GetCurrentVerbosityCutoff()) {
    vtkOutputWindow::SetInstance(window_);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  }
  ~CapturedVtkMessages() {
    vtkOutputWindow::SetInstance(before_);
    vtkLogger::SetStderrVerbosity(verbosity_);
  }
  CapturedVtkMessages(const CapturedVtkMessages&) = delete;
  CapturedVtkMessages& operator=(const CapturedVtkMessages&) = delete;
  /// The first message, on one line.
  std::string first() const {
    std::string s = window_->text.substr(0, 300);
    for (char& c : s) {
      if (c < ' ' || c > '~') c = ' ';
    }
    return s;
  }

 private:
  struct Window : vtkOutputWindow {
    static Window* New() {
      auto* window = new Window;
      window->InitializeObjectBase();
      return window;
    }
    void DisplayText(const char* message) override {
      if (text.empty() && message) text = message;
    }
    std::string text;
  };
  static std::mutex& mutex() {
    static std::mutex m;
    return m;
  }
  std::lock_guard<std::mutex> lock_;
  vtkSmartPointer<vtkOutputWindow> before_;
  vtkLogger::Verbosity verbosity_;
  vtkNew<Window> window_;
};

/// VTK allocates the connectivity for what the last offset says, before it reads it. And when an array of cell data
/// cannot be read, it names one of the point data in its message, through a null pointer where there are none.
class BoundedReader : public vtkXMLUnstructuredGridReader {
 public:
  static BoundedReader* New() {
    auto* reader = new BoundedReader;
    reader->InitializeObjectBase();
    return reader;
  }
  std::uint64_t most_values = 0;  ///< of an array, by the size of the file

 private:
  int ReadArrayValues(vtkXMLDataElement* element, vtkIdType at, vtkAbstractArray* array, vtkIdType start, vtkIdType n,
                      FieldType type) override {
    vtkXMLDataElement* parent = element->GetParent();
    if (!vtkXMLUnstructuredGridReader::ReadArrayValues(element, at, array, start, n, type)) {
      vtkErrorMacro("an array cannot be read");  // with a message, the file is refused
      return parent && std::string_view(parent->GetName()) == "CellData" ? 1 : 0;
    }
    auto* numbers = vtkDataArray::SafeDownCast(array);
    if (!numbers || !parent || std::string_view(parent->GetName()) != "Cells") return 1;
    if (const char* name = element->GetAttribute("Name"); !name || std::string_view(name) != "offsets") return 1;
    for (vtkIdType i = at; i < std::min(at + n, numbers->GetNumberOfValues()); ++i) {
      const double offset = numbers->GetComponent(i, 0);
      if (offset >= 0 && offset <= static_cast<double>(most_values)) continue;
      vtkErrorMacro("offset " << offset << ": more than the file can hold");
      return 0;
    }
    return 1;
  }
};

/// The values of an array with one component, or three of floats, for the kept cells (`keep` null: for all).
FieldValues from_vtk(vtkDataArray* array, const std::vector<vtkIdType>* keep) {
  const auto n = keep ? keep->size() : static_cast<std::size_t>(array->GetNumberOfTuples());
  const auto source = [&](std::size_t i) { return keep ? (*keep)[i] : static_cast<vtkIdType>(i); };
  if (array->GetNumberOfComponents() == 3) {
    std::vector<Vec3> values(n);
    for (std::size_t i = 0; i < n; ++i) array->GetTuple(source(i), values[i].data());
    return values;
  }
  const int type = array->GetDataType();
  if (type == VTK_FLOAT || type == VTK_DOUBLE) {
    std::vector<double> values(n);
    for (std::size_t i = 0; i < n; ++i) values[i] = array->GetComponent(source(i), 0);
    return values;
  }
  if (auto* bytes = vtkUnsignedCharArray::SafeDownCast(array)) {
    std::vector<std::uint8_t> values(n);
    for (std::size_t i = 0; i < n; ++i) values[i] = bytes->GetValue(source(i));
    return values;
  }
  std::vector<std::int64_t> values(n);
  for (std::size_t i = 0; i < n; ++i) {
    values[i] = array->GetVariantValue(source(i)).ToTypeInt64();  // a double would round above 2^53
  }
  return values;
}

void take_data(vtkFieldData* from, vtkIdType n, const std::vector<vtkIdType>* keep,
               std::map<std::string, FieldValues>& to) {
  for (int a = 0; a < from->GetNumberOfArrays(); ++a) {
    vtkDataArray* array = from->GetArray(a);  // null for arrays of strings
    if (!array || !array->GetName() || array->GetNumberOfTuples() != n) continue;
    const bool is_float = array->GetDataType() == VTK_FLOAT || array->GetDataType() == VTK_DOUBLE;
    if (array->GetNumberOfComponents() != 1 && !(is_float && array->GetNumberOfComponents() == 3)) continue;
    to.emplace(array->GetName(), from_vtk(array, keep));
  }
}

/// Corners of the tets, every offset and index checked: VTK believes the file. `kept` receives the cell ids,
/// `mid_sides` the other nodes of those that have ten.
void take_tets(const std::filesystem::path& path, vtkUnstructuredGrid* grid, TetMesh& mesh,
               std::vector<vtkIdType>& kept, std::vector<detail::MidSideNodes>& mid_sides) {
  const vtkIdType n_points = grid->GetNumberOfPoints(), n_cells = grid->GetNumberOfCells();
  vtkUnsignedCharArray* types = grid->GetCellTypesArray();
  vtkCellArray* cells = grid->GetCells();
  const auto refuse = [&](vtkIdType cell, const char* reason) {
    throw MeshFileRefused(path, "cell " + std::to_string(cell), reason);
  };
  if (!types || !cells || types->GetNumberOfTuples() < n_cells) refuse(0, "no cell types");
  vtkDataArray* offsets = cells->GetOffsetsArray();
  vtkDataArray* connectivity = cells->GetConnectivityArray();
  if (offsets->GetNumberOfTuples() < n_cells + 1) refuse(0, "offsets missing");
  const auto n_indices = static_cast<double>(connectivity->GetNumberOfTuples());
  for (vtkIdType c = 0; c < n_cells; ++c) {
    const int type = types->GetValue(c);
    if (type != VTK_TETRA && type != VTK_QUADRATIC_TETRA) continue;
    const double begin = offsets->GetComponent(c, 0), end = offsets->GetComponent(c + 1, 0);
    if (!(begin >= 0 && end >= begin && end <= n_indices)) refuse(c, "offsets do not ascend within the connectivity");
    if (end - begin != (type == VTK_TETRA ? 4 : 10)) refuse(c, "a tet with a wrong number of points");
    QuadraticTet tet{};
    for (int k = 0; k < static_cast<int>(end - begin); ++k) {
      const double v = connectivity->GetComponent(static_cast<vtkIdType>(begin) + k, 0);
      if (!(v >= 0 && v < static_cast<double>(n_points))) refuse(c, "a point index out of range");
      tet[k] = static_cast<int>(v);
    }
    mesh.C.push_back({tet[0], tet[1], tet[2], tet[3]});
    if (type == VTK_QUADRATIC_TETRA) mid_sides.push_back({tet[4], tet[5], tet[6], tet[7], tet[8], tet[9]});
    kept.push_back(c);
  }
}

}  // namespace

MeshFile detail::read_vtu(const std::filesystem::path& path) {
  const std::uint64_t most_values = detail::precheck_vtu(path);
  const CapturedVtkMessages messages;
  vtkNew<BoundedReader> reader;
  reader->most_values = most_values;
  reader->SetFileName(path.c_str());
  try {
    reader->Update();
  } catch (const std::bad_alloc&) {
    throw MeshFileRefused(path, "", "its arrays do not fit into memory");
  }
  if (const std::string error = messages.first(); reader->GetErrorCode() != 0 || !error.empty()) {
    throw MeshFileRefused(path, "", "VTK cannot read it: " + error);
  }
  vtkUnstructuredGrid* grid = reader->GetOutput();
  if (!grid || !grid->GetPoints()) throw MeshFileRefused(path, "", "no points in this file");
  if (grid->GetNumberOfPoints() > std::numeric_limits<int>::max() ||
      grid->GetNumberOfCells() > std::numeric_limits<int>::max()) {
    throw MeshFileRefused(path, "", "more than 2^31 points or cells");
  }
  MeshFile file;
  std::vector<vtkIdType> kept;
  std::vector<MidSideNodes> mid_sides;
  take_tets(path, grid, file.mesh, kept, mid_sides);
  if (file.mesh.C.empty()) throw MeshFileRefused(path, "", "no tets in this file");
  file.mesh.V.resize(static_cast<std::size_t>(grid->GetNumberOfPoints()));
  for (std::size_t i = 0; i < file.mesh.V.size(); ++i) {
    grid->GetPoints()->GetPoint(static_cast<vtkIdType>(i), file.mesh.V[i].data());
  }
  take_data(grid->GetPointData(), grid->GetNumberOfPoints(), nullptr, file.point_data);
  take_data(grid->GetCellData(), grid->GetNumberOfCells(), &kept, file.cell_data);
  const auto point_number = [](std::size_t v) { return static_cast<std::int64_t>(v); };
  refuse_broken_tets(path, file.mesh, point_number, [&](std::size_t t) { return static_cast<std::int64_t>(kept[t]); });
  take_mid_sides(path, file, mid_sides, point_number);
  drop_unused_vertices(file);
  return file;
}

}  // namespace umtet
