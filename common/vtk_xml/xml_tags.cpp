#include "common/vtk_xml/xml_tags.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace umtet::detail {
namespace {

constexpr std::uint64_t kMostBetweenTags = 1 << 16;
constexpr std::size_t kLongestComment = 1 << 20;
constexpr std::string_view kBlanks = " \t\r\n";

void remove_blanks(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
}

}  // namespace

bool XmlTag::has(std::string_view key) const {
  return std::any_of(attributes.begin(), attributes.end(), [key](const auto& a) { return a.first == key; });
}

std::string_view XmlTag::operator[](std::string_view key) const {
  for (const auto& [known, value] : attributes)
    if (known == key) return value;
  return {};
}

std::uint64_t XmlTag::count(std::string_view key, const ByteStream& source) const {
  const std::string_view text = (*this)[key];
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) source.refuse(std::string(key) + " is not a count");
  return value;
}

bool XmlTags::next(XmlTag& tag) {
  while (!has_ended_) {
    source_.until('<', kMostBetweenTags);
    std::string text = source_.until('>', kMostBetweenTags);
    if (text.starts_with('?')) {
      end_comment(std::move(text), "?");
      continue;
    }
    if (text.starts_with("!--")) {
      end_comment(std::move(text), "--");
      continue;
    }
    if (text.starts_with('!')) source_.refuse("document type declarations are not read");
    parse(text, tag);
    if (tag.is_closing) {
      if (open_.empty() || open_.back() != tag.name) source_.refuse("tags do not nest");
      open_.pop_back();
    }
    parent_ = open_.empty() ? std::string() : open_.back();
    if (!tag.is_closing && !tag.is_empty) open_.push_back(tag.name);
    has_ended_ = open_.empty();
    return true;
  }
  return false;
}

/// @param text  up to the first '>', which may be within the comment
void XmlTags::end_comment(std::string text, std::string_view closing) {
  while (!text.ends_with(closing)) {
    text += '>' + source_.until('>', kMostBetweenTags);
    if (text.size() > kLongestComment) source_.refuse("a comment of more than a megabyte");
  }
  if (text.find("<AppendedData") != std::string::npos) source_.refuse("tags in a comment");
}

void XmlTags::parse(std::string_view text, XmlTag& tag) const {
  tag.is_closing = text.starts_with('/');
  if (tag.is_closing) text.remove_prefix(1);
  tag.is_empty = !tag.is_closing && text.ends_with('/');
  if (tag.is_empty) text.remove_suffix(1);
  tag.name = text.substr(0, text.find_first_of(kBlanks));
  tag.attributes.clear();
  if (tag.name.empty()) source_.refuse("a tag without a name");
  take_attributes(text.substr(tag.name.size()), tag);
}

void XmlTags::take_attributes(std::string_view text, XmlTag& tag) const {
  for (remove_blanks(text); !text.empty(); remove_blanks(text)) {
    const std::string_view key = text.substr(0, text.find_first_of(" \t\r\n=\"'/"));
    text.remove_prefix(key.size());
    remove_blanks(text);
    const bool has_value = !key.empty() && text.starts_with('=');
    if (has_value) text.remove_prefix(1);
    remove_blanks(text);
    const bool is_quoted = has_value && (text.starts_with('"') || text.starts_with('\''));
    const std::size_t end = is_quoted ? text.find(text.front(), 1) : std::string_view::npos;
    if (end == std::string_view::npos) {
      source_.refuse("a tag that cannot be read: attributes that are not name=\"value\"");
    }
    if (tag.has(key)) source_.refuse("an attribute that is there twice");
    tag.attributes.emplace_back(key, without_entities(text.substr(1, end - 1)));
    text.remove_prefix(end + 1);
  }
}

std::string XmlTags::without_entities(std::string_view value) const {
  static constexpr std::array<std::pair<std::string_view, char>, 5> kEntities = {
      {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}}};
  std::string text;
  while (!value.empty()) {
    const std::size_t n = std::min(value.find('&'), value.size());
    text += value.substr(0, n);
    value.remove_prefix(n);
    if (value.empty()) break;
    const auto known =
        std::find_if(kEntities.begin(), kEntities.end(), [&](const auto& e) { return value.starts_with(e.first); });
    if (known == kEntities.end()) source_.refuse("references to characters are not read");
    text += known->second;
    value.remove_prefix(known->first.size());
  }
  return text;
}

}  // namespace umtet::detail
