#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace umtet::detail {

static_assert(std::endian::native == std::endian::little, "files are written as the numbers lie in memory");

template <class T>
inline constexpr const char* kVtkType = nullptr;
template <>
inline constexpr const char* kVtkType<double> = "Float64";
template <>
inline constexpr const char* kVtkType<float> = "Float32";
template <>
inline constexpr const char* kVtkType<std::int64_t> = "Int64";
template <>
inline constexpr const char* kVtkType<std::int32_t> = "Int32";
template <>
inline constexpr const char* kVtkType<std::uint8_t> = "UInt8";

inline constexpr const char* kThreeComponents = " NumberOfComponents=\"3\"";

/// A name in the form that an attribute needs, with XML entities.
std::string escaped(const std::string& name);

/// The tag `<Piece>`. @param counted  the attribute with the number of cells
std::string piece_begin(std::size_t n_points, const std::string& counted, std::size_t n_cells);

/// Layout of a VTK XML file with raw appended data: tags as text, then the arrays, each after its number of bytes as 64
/// bits. This class computes all positions; AppendedWriter also holds the numbers.
///
/// The arrays follow in the reverse order of their tags. meshio 5.3 turns such a file into one in base64: from the
/// first array on, it looks up the tag with the offset of the array and gives it another offset. Two tags may have the
/// same offset then, and meshio takes the earlier tag. In this order the earlier tag is always the right one.
class AppendedLayout {
 public:
  struct Array {
    std::string name;
    std::uint64_t begin;    ///< position of its numbers in the file, after their count; see close()
    std::uint64_t n_bytes;  ///< size of its numbers
  };

  /// Begins the file. @param type  type of the grid
  void begin(const std::string& type, const std::string& attributes = "");
  void text(std::string_view text) { tags_ += text; }
  /// Adds an array. @param attributes  further attributes, with a leading blank
  void array(const std::string& type, const std::string& name, std::uint64_t n_bytes,
             const std::string& attributes = "");
  /// Closes the grid and begins the appended data. All positions are known after this call.
  void close();

  /// In the order of their tags.
  const std::vector<Array>& arrays() const { return arrays_; }
  /// All text before the numbers.
  const std::string& tags() const { return tags_; }
  /// The count before an array, as bytes.
  static std::string count(const Array& array);
  /// The text after the last array.
  static constexpr std::string_view kEnd = "\n</AppendedData>\n</VTKFile>\n";

 private:
  std::string type_, tags_;
  std::vector<Array> arrays_;
  std::vector<std::size_t> offset_at_;  ///< position in tags_ of the offset of each array
};

/// Writer of a file of tags and arrays. It writes the arrays last, piece by piece, without a copy.
class AppendedWriter {
 public:
  using Put = std::function<void(std::string_view)>;

  AppendedWriter& begin(const std::string& type, const std::string& attributes = "") {
    layout_.begin(type, attributes);
    return *this;
  }
  AppendedWriter& text(std::string_view text) {
    layout_.text(text);
    return *this;
  }
  /// Adds an array. @param values  must stay valid until write()
  template <class T>
  AppendedWriter& array(const std::string& name, std::span<const T> values, const std::string& attributes = "") {
    announce<T>(name, values.size(), attributes);
    arrays_.emplace_back([values](const Put& put) {
      put({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
    });
    return *this;
  }
  template <class T>
  AppendedWriter& array(const std::string& name, std::vector<T>&& values, const std::string& attributes = "") {
    announce<T>(name, values.size(), attributes);
    arrays_.emplace_back([held = std::make_shared<std::vector<T>>(std::move(values))](const Put& put) {
      put({reinterpret_cast<const char*>(held->data()), held->size() * sizeof(T)});
    });
    return *this;
  }
  /// Adds an array of n values. @param fill  fill(first, n, to) writes n values to `to`, from index `first` on
  template <class T, class Fill>
  AppendedWriter& array(const std::string& name, std::size_t n, Fill fill, const std::string& attributes = "") {
    announce<T>(name, n, attributes);
    arrays_.emplace_back([n, fill = std::move(fill)](const Put& put) {
      std::vector<T> some(std::min(n, kAtOnce / sizeof(T)));
      for (std::size_t first = 0; first < n; first += some.size()) {
        const std::size_t size = std::min(some.size(), n - first);
        fill(first, size, some.data());
        put({reinterpret_cast<const char*>(some.data()), size * sizeof(T)});
      }
    });
    return *this;
  }
  /// Closes the grid and passes all bytes of the file to `put`, in their order.
  void write(const Put& put);

 private:
  static constexpr std::size_t kAtOnce = 1 << 20;  ///< bytes

  template <class T>
  void announce(const std::string& name, std::size_t n, const std::string& attributes) {
    layout_.array(kVtkType<T>, name, n * sizeof(T), attributes);
  }

  AppendedLayout layout_;
  std::vector<std::function<void(const Put&)>> arrays_;
};

}  // namespace umtet::detail
