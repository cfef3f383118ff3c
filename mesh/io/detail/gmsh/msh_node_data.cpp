#include "mesh/io/detail/gmsh/msh_node_data.h"

#include <array>
#include <cstddef>
#include <type_traits>
#include <variant>
#include <vector>

namespace umtet {
namespace {

template <class Value>
constexpr std::size_t kComponents = std::is_same_v<Value, Vec3> ? 3 : 1;

template <class Value>
std::array<double, kComponents<Value>> components(const Value& value) {
  if constexpr (kComponents<Value> == 3) {
    return {value.x(), value.y(), value.z()};
  } else {
    return {static_cast<double>(value)};
  }
}

/// One string, the name; one real number, the time; whole ones: the step, components, nodes and, if there is one, the
/// part. Gmsh joins what has one name and several parts.
void write_head(CheckedFile& file, const MshNodeData& data, std::size_t n_components, std::size_t n_nodes) {
  file.text("$NodeData\n1\n\"").text(data.name).text("\"\n1\n0\n").text(data.part > 0 ? "4" : "3").text("\n0\n");
  file.number(n_components).text("\n").number(n_nodes).text("\n");
  if (data.part > 0) file.number(data.part).text("\n");
}

template <class Value>
void write_values(CheckedFile& file, const MshNodeData& data, const std::vector<Value>& values, bool is_binary) {
  write_head(file, data, kComponents<Value>, values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::int64_t number = data.node.empty() ? static_cast<std::int64_t>(i) : data.node[i];
    require_msh_tags(static_cast<std::size_t>(number) + 1);
    const auto tag = static_cast<std::int32_t>(number + 1);
    is_binary ? file.raw(tag) : file.number(tag);
    for (const double x : components(values[i])) is_binary ? file.raw(x) : file.text(" ").number(x);
    if (!is_binary) file.text("\n");
  }
  file.text(is_binary ? "\n$EndNodeData\n" : "$EndNodeData\n");
}

}  // namespace

void write_node_data(CheckedFile& file, const MshNodeData& data, bool is_binary) {
  std::visit([&](const auto& values) { write_values(file, data, values, is_binary); }, data.values);
}

}  // namespace umtet
