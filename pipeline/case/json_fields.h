#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/case/json_values.h"

namespace umtet {

/// Writes the fields of a struct into a JSON object, or reads them from one. One list of the fields serves both:
///
///     void list_fields(JsonFields& json, MissedPlace& p) { json("farthest", p.farthest)("distance", p.distance); }
///     Json json = json_by_fields(place);
///     MissedPlace place = read_fields<MissedPlace>(json);
///
/// The object contains the names in the order of the list. A field is a bool, a number, a text, a Vec3, a struct with a
/// list, or an optional, a vector or an array of these. An empty optional is null, and so is a double that is not
/// finite. Reading throws Json::exception if a name is missing or if a value has another type.
class JsonFields {
 public:
  explicit JsonFields(Json& written) : written_(&written) {}
  explicit JsonFields(const Json& read) : read_(&read) {}

  bool is_reading() const { return read_ != nullptr; }
  /// Whether the document that is read contains this name. False while writing.
  bool contains(const char* name) const { return read_ && read_->contains(name); }

  /// A field.
  /// @param args  further arguments of the list of its struct, such as the length to which ratios refer
  template <class T, class... Args>
  JsonFields& operator()(const char* name, T& value, const Args&... args) {
    if (read_)
      get(read_->at(name), value, args...);
    else
      (*written_)[name] = put(value, args...);
    return *this;
  }

  /// A field that is left out if it is an empty optional, text or vector, or zero.
  template <class T, class... Args>
  JsonFields& if_any(const char* name, T& value, const Args&... args) {
    const bool is_there = read_ ? read_->contains(name) : has_value(value);
    return is_there ? (*this)(name, value, args...) : *this;
  }

  /// A value that follows from fields: it is written and never read.
  JsonFields& derived(const std::string& name, Json value) {
    if (written_) (*written_)[name] = std::move(value);
    return *this;
  }

  /// Fields in an object of their own.
  /// @param list  list(JsonFields&) lists them
  template <class F>
  JsonFields& object(const char* name, F&& list) {
    Json made = Json::object();
    JsonFields inner = read_ ? JsonFields(read_->at(name)) : JsonFields(made);
    list(inner);
    return derived(name, std::move(made));
  }

  /// An enumerator by its word, or a bool by two.
  /// @param words  in the order of the enumerators
  /// \throw ArtefactDamaged  the document that is read contains another word
  template <class E, std::size_t n>
  JsonFields& word(const char* name, E& value, const std::array<const char*, n>& words) {
    value = static_cast<E>(word_at(name, static_cast<std::size_t>(value), words.data(), n));
    return *this;
  }

 private:
  Json* written_ = nullptr;
  const Json* read_ = nullptr;

  template <class T>
  static bool has_value(const std::optional<T>& value) {
    return value.has_value();
  }
  template <class T>
  static bool has_value(const T& value) {
    return value != T();
  }

  std::size_t word_at(const char* name, std::size_t at, const char* const* words, std::size_t n);

  template <class T, class... Args>
  static constexpr bool kIsListed = requires(JsonFields& json, T& value, const Args&... args) {
    list_fields(json, value, args...);
  };

  template <class T, class... Args>
  static Json put(T& value, const Args&... args) {
    if constexpr (kIsListed<T, Args...>) {
      Json made = Json::object();
      JsonFields inner(made);
      list_fields(inner, value, args...);
      return made;
    } else {
      return value;
    }
  }
  static Json put(Eigen::Vector3d& x) { return json_of(x); }
  template <class T, class... Args>
  static Json put(std::optional<T>& value, const Args&... args) {
    return value ? put(*value, args...) : Json(nullptr);
  }
  template <class T, class... Args>
  static Json put(std::vector<T>& values, const Args&... args) {
    Json list = Json::array();
    for (T& value : values) list.push_back(put(value, args...));
    return list;
  }

  template <class T, class... Args>
  static void get(const Json& json, T& value, const Args&... args) {
    if constexpr (kIsListed<T, Args...>) {
      JsonFields inner(json);
      list_fields(inner, value, args...);
    } else {
      value = json.get<T>();
    }
  }
  static void get(const Json& json, double& value) { value = number_from(json); }
  static void get(const Json& json, Eigen::Vector3d& x) { x = vector_from(json); }
  template <class T, class... Args>
  static void get(const Json& json, std::optional<T>& value, const Args&... args) {
    value.reset();
    if (!json.is_null()) get(json, value.emplace(), args...);
  }
  template <class T, class... Args>
  static void get(const Json& json, std::vector<T>& values, const Args&... args) {
    values.clear();
    for (const Json& element : json.get_ref<const Json::array_t&>()) get(element, values.emplace_back(), args...);
  }
};

/// Returns the object of a struct with list_fields().
/// @param args  further arguments of its list
template <class T, class... Args>
Json json_by_fields(T value, const Args&... args) {
  Json made = Json::object();
  JsonFields fields(made);
  list_fields(fields, value, args...);
  return made;
}

/// Reads a struct from such an object. \throw Json::exception, ArtefactDamaged
template <class T, class... Args>
T read_fields(const Json& json, const Args&... args) {
  T value{};
  JsonFields fields(json);
  list_fields(fields, value, args...);
  return value;
}

}  // namespace umtet
