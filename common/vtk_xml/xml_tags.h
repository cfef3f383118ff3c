#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/vtk_xml/byte_stream.h"

namespace umtet::detail {

/// A tag: `<name key="value">`, `</name>` or `<name key="value"/>`.
struct XmlTag {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes;
  bool is_closing = false, is_empty = false;

  bool has(std::string_view key) const;
  /// Value of an attribute; empty if it is missing.
  std::string_view operator[](std::string_view key) const;
  /// Value of an attribute as an integer >= 0. Rejects the file if it is not such an integer.
  std::uint64_t count(std::string_view key, const ByteStream& source) const;
};

/// Reads the tags of an XML file strictly: tags must nest, and an attribute may occur only once in a tag. Comments
/// contain no appended data. Document types and references to characters (&#65;) are rejected.
class XmlTags {
 public:
  explicit XmlTags(ByteStream& source) : source_(source) {}
  /// Skips text and reads the next tag. @return false after the end of the first element
  bool next(XmlTag& tag);
  /// Name of the element around the tag that was read last; empty around the first one.
  std::string_view parent() const { return parent_; }

 private:
  void parse(std::string_view text, XmlTag& tag) const;
  void take_attributes(std::string_view text, XmlTag& tag) const;
  std::string without_entities(std::string_view value) const;
  void end_comment(std::string text, std::string_view closing);

  ByteStream& source_;
  std::vector<std::string> open_;
  std::string parent_;
  bool has_ended_ = false;
};

}  // namespace umtet::detail
