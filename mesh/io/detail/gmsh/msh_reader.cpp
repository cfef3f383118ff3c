#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "mesh/io/detail/mesh_formats.h"

namespace umtet::detail {
namespace {

/// Nodes per element of Gmsh's types 1..31; 0: not in use.
constexpr std::array<int, 32> kNodes = {0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                                        8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};

constexpr std::int64_t kSecondOrder = 11;
bool is_tet(std::int64_t type) { return type == 4 || type == kSecondOrder || type == 29 || type == 30 || type == 31; }

class MshReader {
 public:
  MshReader(const std::filesystem::path& path, std::string_view bytes) : in_(path, bytes) {}
  NumberedMesh read();

 private:
  void read_format();
  void read_names();
  void read_entities();
  void take_marks(std::int64_t physical, std::int64_t entity, std::size_t n);
  void read_nodes22();
  void read_nodes41();
  void read_elements22();
  void read_elements41();
  void read_binary_block22(std::size_t& left);
  void read_block41();
  void expect_end(std::string_view marker);
  int nodes_of(std::int64_t type) const;
  /// One tet from the file, as far as it is kept. @return how many of its nodes have been read
  template <class Next>
  int take_tet(std::int64_t type, const Next& next);

  template <typename Raw, typename Text>
  auto get(const char* what) {
    return binary_ ? static_cast<Text>(in_.raw<Raw>(what)) : in_.number<Text>(what);
  }
  std::int64_t get_int(const char* what) { return get<std::int32_t, std::int64_t>(what); }
  std::uint64_t get_size(const char* what) { return get<std::uint64_t, std::uint64_t>(what); }
  double get_double(const char* what) { return get<double, double>(what); }
  Vec3 get_point() {
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = get_double("node coordinate");
    return x;
  }

  ByteCursor in_;
  NumberedMesh mesh_;
  double version_ = 0;
  bool binary_ = false;
  bool has_nodes_ = false, has_elements_ = false;
  std::map<std::int64_t, std::int64_t> physical_;  ///< the first physical group of each volume, 4.1
  std::map<std::int64_t, std::string> names_;      ///< of physical groups of volumes
  std::vector<std::int64_t> groups_, volumes_;     ///< of each tet; 0: none
  bool is_partitioned_ = false;                    ///< entities are parts of volumes
};

/// The names of physical volumes; those of other groups are skipped.
void MshReader::read_names() {
  const std::size_t n = in_.count("number of physical names", 4);
  in_.line();
  for (std::size_t i = 0; i < n; ++i) {
    const auto dimension = in_.number<std::int64_t>("dimension of a physical group");
    const auto number = in_.number<std::int64_t>("number of a physical group");
    const std::string_view rest = in_.line();
    const std::size_t begin = rest.find('"'), end = rest.rfind('"');
    if (dimension == 3 && begin != std::string_view::npos && end > begin)
      names_.emplace(number, rest.substr(begin + 1, end - begin - 1));
  }
}

/// The physical groups of volumes, 4.1.
void MshReader::read_entities() {
  std::array<std::size_t, 4> n{};
  for (std::size_t& count : n) count = in_.checked_count(get_size("number of entities"), "number of entities", 4);
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (std::size_t i = 0; i < n[static_cast<std::size_t>(dimension)]; ++i) {
      const std::int64_t entity = get_int("entity");
      for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) get_double("box of an entity");
      const std::size_t n_groups = in_.checked_count(get_size("physical groups"), "physical groups", 2);
      for (std::size_t g = 0; g < n_groups; ++g) {
        const std::int64_t group = get_int("physical group");
        if (dimension == 3) physical_.emplace(entity, group);
      }
      if (dimension == 0) continue;
      const std::size_t n_bounds = in_.checked_count(get_size("bounding entities"), "bounding entities", 2);
      for (std::size_t b = 0; b < n_bounds; ++b) get_int("bounding entity");
    }
  }
  in_.skip_behind_line("$EndEntities");
}

void MshReader::take_marks(std::int64_t physical, std::int64_t entity, std::size_t n) {
  groups_.insert(groups_.end(), n, physical);
  volumes_.insert(volumes_.end(), n, entity);
}

void MshReader::read_format() {
  version_ = in_.number<double>("version");
  const auto file_type = in_.number<std::int64_t>("file type");
  const auto data_size = in_.number<std::int64_t>("data size");
  if (!(version_ >= 2 && version_ < 3) && version_ != 4.1) in_.refuse("this MSH version is not read, only 2.2 and 4.1");
  if (file_type != 0 && file_type != 1) in_.refuse("file type must be 0 or 1");
  if (data_size != 8) in_.refuse("data size must be 8");
  binary_ = file_type == 1;
  in_.line();
  if (binary_ && in_.raw<std::int32_t>("byte order mark") != 1) in_.refuse("the byte order is not this machine's");
  expect_end("$EndMeshFormat");
}

void MshReader::expect_end(std::string_view marker) {
  if (in_.word() != marker) in_.refuse(std::string(marker) + " expected here");
  in_.line();
}

int MshReader::nodes_of(std::int64_t type) const {
  const int n = type >= 0 && type < static_cast<std::int64_t>(kNodes.size()) ? kNodes[type] : 0;
  if (n == 0) in_.refuse("unknown element type " + std::to_string(type));
  return n;
}

template <class Next>
int MshReader::take_tet(std::int64_t type, const Next& next) {
  for (auto& v : mesh_.tets.emplace_back()) v = next();
  if (type != kSecondOrder) return 4;
  auto& mid_sides = mesh_.mid_sides.emplace_back();
  for (auto& v : mid_sides) v = next();
  std::swap(mid_sides[4], mid_sides[5]);  // Gmsh: 01 12 20 03 23 13
  return 10;
}

void MshReader::read_nodes22() {
  const std::size_t n = in_.count("number of nodes", binary_ ? 28 : 8);
  in_.line();
  mesh_.number.reserve(n);
  mesh_.point.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    mesh_.number.push_back(get_int("node number"));
    mesh_.point.push_back(get_point());
  }
  expect_end("$EndNodes");
}

void MshReader::read_nodes41() {
  const std::uint64_t n_blocks = in_.checked_count(get_size("number of node blocks"), "number of node blocks", 8);
  const std::size_t n = in_.checked_count(get_size("number of nodes"), "number of nodes", 8);
  get_size("least node number");
  get_size("greatest node number");
  mesh_.number.reserve(n);
  mesh_.point.reserve(n);
  for (std::uint64_t block = 0; block < n_blocks; ++block) {
    const std::int64_t dimension = get_int("dimension");
    if (dimension < 0 || dimension > 3) in_.refuse("dimension " + std::to_string(dimension));
    get_int("entity");
    const std::int64_t n_parameters = get_int("parametric") != 0 ? dimension : 0;
    const std::size_t count = in_.checked_count(get_size("nodes in this block"), "nodes in this block", 8);
    for (std::size_t i = 0; i < count; ++i) {
      mesh_.number.push_back(static_cast<std::int64_t>(get_size("node number")));
    }
    for (std::size_t i = 0; i < count; ++i) {
      mesh_.point.push_back(get_point());
      for (std::int64_t k = 0; k < n_parameters; ++k) get_double("node parameter");
    }
  }
  expect_end("$EndNodes");
}

void MshReader::read_binary_block22(std::size_t& left) {
  const auto type = in_.raw<std::int32_t>("element type");
  const auto count = in_.raw<std::int32_t>("elements in this block");
  const auto n_tags = in_.raw<std::int32_t>("number of tags");
  const int n_nodes = nodes_of(type);
  if (count < 1 || static_cast<std::size_t>(count) > left)
    in_.refuse("elements in this block: " + std::to_string(count));
  if (n_tags < 0 || n_tags > 1024) in_.refuse("number of tags: " + std::to_string(n_tags));
  const auto n_skipped = static_cast<std::size_t>(std::max(n_tags - 2, 0));
  const std::size_t head = 4 * (1 + static_cast<std::size_t>(n_tags)), body = 4 * static_cast<std::size_t>(n_nodes);
  in_.checked_count(static_cast<std::uint64_t>(count), "elements in this block", head + body);
  left -= static_cast<std::size_t>(count);
  if (!is_tet(type)) {
    in_.skip(static_cast<std::size_t>(count) * (head + body), "elements");
    return;
  }
  for (std::int32_t e = 0; e < count; ++e) {
    in_.raw<std::int32_t>("element number");
    const std::int64_t group = n_tags > 0 ? in_.raw<std::int32_t>("physical group") : 0;
    const std::int64_t entity = n_tags > 1 ? in_.raw<std::int32_t>("entity") : 0;
    in_.skip(4 * n_skipped, "tags");
    take_marks(group, entity, 1);
    const int n = take_tet(type, [&] { return in_.raw<std::int32_t>("node of a tet"); });
    in_.skip(body - 4 * static_cast<std::size_t>(n), "element");
  }
}

void MshReader::read_elements22() {
  std::size_t left = in_.count("number of elements", 8);
  in_.line();
  if (binary_) {
    while (left > 0) read_binary_block22(left);
  } else {
    for (; left > 0; --left) {
      in_.number<std::int64_t>("element number");
      const auto type = in_.number<std::int64_t>("element type");
      if (is_tet(type)) {
        const auto n_tags = in_.number<std::int64_t>("number of tags");
        std::array<std::int64_t, 2> marks{};
        for (std::int64_t k = 0; k < n_tags; ++k) {
          const auto tag = in_.number<std::int64_t>("tag");
          if (k < 2) marks[static_cast<std::size_t>(k)] = tag;
        }
        take_marks(marks[0], marks[1], 1);
        take_tet(type, [&] { return in_.number<std::int64_t>("node of a tet"); });
      }
      in_.line();
    }
  }
  expect_end("$EndElements");
}

void MshReader::read_block41() {
  get_int("dimension");
  const std::int64_t entity = get_int("entity");
  const std::int64_t type = get_int("element type");
  const auto body = static_cast<std::size_t>(nodes_of(type));
  const std::size_t least_bytes = binary_ ? 8 * (1 + body) : 2 * (1 + body);
  const std::size_t count =
      in_.checked_count(get_size("elements in this block"), "elements in this block", least_bytes);
  if (!is_tet(type)) {
    if (binary_) {
      in_.skip(count * least_bytes, "elements");
    } else {
      for (std::size_t i = 0; i < count * (1 + body); ++i) in_.number<std::uint64_t>("element");
    }
    return;
  }
  const auto group = physical_.find(entity);
  take_marks(group == physical_.end() ? 0 : group->second, entity, count);
  for (std::size_t e = 0; e < count; ++e) {
    get_size("element number");
    const int n = take_tet(type, [&] { return static_cast<std::int64_t>(get_size("node of a tet")); });
    for (auto k = static_cast<std::size_t>(n); k < body; ++k) get_size("node of a tet");
  }
}

void MshReader::read_elements41() {
  const std::uint64_t n_blocks = in_.checked_count(get_size("number of element blocks"), "number of element blocks", 8);
  const std::size_t n = in_.checked_count(get_size("number of elements"), "number of elements", 4);
  get_size("least element number");
  get_size("greatest element number");
  mesh_.tets.reserve(n);
  for (std::uint64_t block = 0; block < n_blocks; ++block) read_block41();
  expect_end("$EndElements");
}

NumberedMesh MshReader::read() {
  if (in_.word() != "$MeshFormat") in_.refuse("not a Gmsh file: no $MeshFormat at its beginning");
  read_format();
  for (std::string_view section = in_.word(); !section.empty(); section = in_.word()) {
    if (section.front() != '$' || section.size() < 2 || section.size() > 64) in_.refuse("a section $... expected here");
    in_.line();
    const bool nodes = section == "$Nodes", elements = section == "$Elements";
    if ((nodes && has_nodes_) || (elements && has_elements_)) in_.refuse("a second section " + std::string(section));
    if (section == "$PhysicalNames") {
      read_names();
      expect_end("$EndPhysicalNames");
    } else if (section == "$Entities" && version_ > 3) {
      read_entities();
    } else if (nodes) {
      version_ < 3 ? read_nodes22() : read_nodes41();
      has_nodes_ = true;
    } else if (elements) {
      version_ < 3 ? read_elements22() : read_elements41();
      has_elements_ = true;
    } else {
      is_partitioned_ = is_partitioned_ || section == "$PartitionedEntities";
      in_.skip_behind_line("$End" + std::string(section.substr(1)));
    }
  }
  if (!has_nodes_ || !has_elements_) in_.refuse("no $Nodes or no $Elements in this file");
  if (mesh_.tets.empty()) in_.refuse("no tets in this file");
  const bool has_groups = std::any_of(groups_.begin(), groups_.end(), [](std::int64_t g) { return g != 0; });
  if (!is_partitioned_) mesh_.region = std::move(has_groups ? groups_ : volumes_);
  if (has_groups) mesh_.region_names = std::move(names_);
  return std::move(mesh_);
}

}  // namespace

MeshFile read_msh(const std::filesystem::path& path) {
  const std::string bytes = file_bytes(path, "$MeshFormat");
  return assemble(path, MshReader(path, bytes).read());
}

}  // namespace umtet::detail
