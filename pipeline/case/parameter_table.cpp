#include <algorithm>
#include <array>
#include <optional>
#include <type_traits>

#include "pipeline/case/detail/param_field.h"
#include "pipeline/case/parameters.h"

namespace umtet {
namespace {

using detail::kAboveZero;

constexpr double kHuge = 1e100;

/// Maps the words of a vocabulary, in the order of parameters.def, to the values of the enumeration in its order;
/// the templates below handle the exceptions.
template <class T>
struct Words {
  static constexpr bool are_there = std::is_enum_v<T>;
  static std::size_t word_of(T value) { return static_cast<std::size_t>(value); }
  static T value_of(std::size_t word) { return static_cast<T>(word); }
};

/// Maps the words to a list of values.
template <class T, T... values>
struct ListedWords {
  static constexpr bool are_there = true;
  static constexpr std::array list = {values...};
  static std::size_t word_of(T value) {
    return static_cast<std::size_t>(std::find(list.begin(), list.end(), value) - list.begin());
  }
  static T value_of(std::size_t word) { return list.at(word); }
};
template <>
struct Words<DirectionRule> : ListedWords<DirectionRule, DirectionRule::Random, DirectionRule::AxesInTurn> {};
template <>
struct Words<ClosestPointMethod> : ListedWords<ClosestPointMethod, ClosestPointMethod::Newton,
                                               ClosestPointMethod::Damped, ClosestPointMethod::Paper> {};

/// The first word leaves the choice to the library; the others are values in order.
template <class T>
struct Words<std::optional<T>> {
  static constexpr bool are_there = true;
  static std::size_t word_of(std::optional<T> value) { return value ? 1 + Words<T>::word_of(*value) : 0; }
  static std::optional<T> value_of(std::size_t word) {
    return word == 0 ? std::nullopt : std::optional(Words<T>::value_of(word - 1));
  }
};

/// Completes the row of one field of a section.
/// @param row  contains the fields that parameters.def sets
template <auto section, auto field>
ParamField row_of(const char* key, ParamField row) {
  row.key = key;
  row.get = [](const ParamField& self, const ParameterValues& values) -> ParamValue {
    const auto& value = values.*section.*field;
    using T = std::remove_cvref_t<decltype(value)>;
    if constexpr (Words<T>::are_there) {
      return self.choices.at(Words<T>::word_of(value));
    } else {
      return value;
    }
  };
  row.put = [](const ParamField& self, const ParamValue& from, ParameterValues& values) {
    auto& value = values.*section.*field;
    using T = std::remove_cvref_t<decltype(value)>;
    if constexpr (Words<T>::are_there) {
      std::size_t k = 0;
      while (self.choices.at(k) != std::get<std::string>(from)) ++k;
      value = Words<T>::value_of(k);
    } else {
      value = std::get<T>(from);
    }
  };
  row.preset = row.get(row, ParameterValues());
  return row;
}

std::vector<ParamField> make_fields() {
  using V = ParameterValues;
  std::vector<ParamField> rows;
#define UMTET_CLOUD(name, ...) \
  rows.push_back(row_of<&V::cloud, &CloudParameters::name>(keys::cloud::name, ParamField{__VA_ARGS__}));
#define UMTET_RECONSTRUCT(name, ...) \
  rows.push_back(                    \
      row_of<&V::reconstruct, &ReconstructParameters::name>(keys::reconstruct::name, ParamField{__VA_ARGS__}));
#define UMTET_MESH(name, ...) \
  rows.push_back(row_of<&V::mesh, &MeshParameters::name>(keys::mesh::name, ParamField{__VA_ARGS__}));
#define UMTET_OUTPUT(name, ...) \
  rows.push_back(row_of<&V::output, &OutputParameters::name>(keys::output::name, ParamField{__VA_ARGS__}));
#include "pipeline/case/parameters.def"
  return rows;
}

}  // namespace

const std::vector<ParamField>& params_fields() {
  static const std::vector<ParamField> fields = make_fields();
  return fields;
}

}  // namespace umtet
