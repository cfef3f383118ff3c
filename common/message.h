#pragma once

#include <functional>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

// Messages of the libraries for users. A message names options and not flags: C++, Python and the command line each
// have their own names for an option, and text_of() inserts them.
namespace umtet {

/// An option of a library, identified by its place in the structs of options, such as "mesh.max_tets".
struct Option {
  const char* name;
};

constexpr bool operator==(const Option& a, const Option& b) { return std::string_view(a.name) == b.name; }

/// An option, alone or with a value.
struct Setting {
  // NOLINTNEXTLINE(google-explicit-constructor): an option alone is a setting
  Setting(Option option, std::string value = {}) : option(option), value(std::move(value)) {}
  Option option;
  std::string value;  ///< empty if the option has no value
};

/// The instruction of a remedy: how the user should change an option.
enum class Change {
  Use,    ///< set the option; the note of the remedy states the effect
  Give,   ///< set the option to a value
  Raise,  ///< set the option to a larger value
  Lower   ///< set the option to a smaller value
};

/// A change of an option that avoids an error, or avoids the behaviour that a notice reports.
struct Remedy {
  Change change;
  Setting setting;
  std::string note = {};  ///< for Use the effect, such as "keeps them"; otherwise words that complete the instruction
};

/// A fact, and the options that change it.
struct Message {
  using Piece = std::variant<std::string, Setting>;

  // NOLINTBEGIN(google-explicit-constructor): words alone are a message
  Message(std::string words) : fact{std::move(words)} {}
  Message(const char* words) : fact{std::string(words)} {}
  // NOLINTEND(google-explicit-constructor)
  Message(std::initializer_list<Piece> fact, std::vector<Remedy> remedies = {})
      : fact(fact), remedies(std::move(remedies)) {}
  Message(std::string words, std::vector<Remedy> remedies) : fact{std::move(words)}, remedies(std::move(remedies)) {}

  std::vector<Piece> fact;  ///< words and options, in the order of the sentence
  std::vector<Remedy> remedies;
};

/// Returns the message with words in front of its fact.
inline Message operator+(std::string words, Message message) {
  message.fact.insert(message.fact.begin(), std::move(words));
  return message;
}

/// Returns the message with words after its fact.
inline Message operator+(Message message, std::string words) {
  message.fact.emplace_back(std::move(words));
  return message;
}

/// Names an option in the language of a user.
using OptionWords = std::function<std::string(const Setting&)>;

/// The words of a user of C++: "mesh.max_tets", "mesh.h = 0.3".
inline std::string in_structs(const Setting& setting) {
  return setting.option.name + (setting.value.empty() ? std::string() : " = " + setting.value);
}

/// "raise mesh.max_tets", "give mesh.h = 0.3 or more", "scan.keep_all keeps them".
inline std::string text_of(const Remedy& remedy, const OptionWords& words = in_structs) {
  std::string text;
  if (remedy.change == Change::Give) text = "give ";
  if (remedy.change == Change::Raise) text = "raise ";
  if (remedy.change == Change::Lower) text = "lower ";
  text += words(remedy.setting);
  return remedy.note.empty() ? text : text + " " + remedy.note;
}

/// Returns the fact, followed by the remedies: "3 outliers are dropped; scan.keep_all keeps them".
inline std::string text_of(const Message& message, const OptionWords& words = in_structs) {
  std::string text;
  for (const Message::Piece& piece : message.fact) {
    const auto* setting = std::get_if<Setting>(&piece);
    text += setting ? words(*setting) : std::get<std::string>(piece);
  }
  const char* separator = "; ";
  for (const Remedy& remedy : message.remedies) {
    text += separator + text_of(remedy, words);
    separator = remedy.change == Change::Use ? ", " : ", or ";
  }
  return text;
}

/// Returns the texts of several messages.
inline std::vector<std::string> texts_of(const std::vector<Message>& messages, const OptionWords& words = in_structs) {
  std::vector<std::string> texts;
  texts.reserve(messages.size());
  for (const Message& message : messages) texts.push_back(text_of(message, words));
  return texts;
}

/// An error with a message that names options. what() is its text for users of C++.
struct ExplainedError : std::runtime_error {
  explicit ExplainedError(Message message) : std::runtime_error(text_of(message)), message(std::move(message)) {}
  ExplainedError(Message fact, std::vector<Remedy> remedies) : ExplainedError(with(std::move(fact), remedies)) {}
  Message message;

 private:
  static Message with(Message message, const std::vector<Remedy>& remedies) {
    message.remedies.insert(message.remedies.end(), remedies.begin(), remedies.end());
    return message;
  }
};

}  // namespace umtet
