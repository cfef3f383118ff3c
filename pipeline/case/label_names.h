#pragma once

#include <map>
#include <string>
#include <vector>

namespace umtet {

/// Converts A to Z to a to z. Names that differ only in case count as equal.
std::string lower_case(std::string name);

/// Parses output.label_names, such as "1=feet,2=head". \throw UsageError  the text does not have this form, a label
/// or a name (ignoring case) occurs twice, or a name is not allowed in an export format
std::map<int, std::string> parse_label_names(const std::string& text);

/// Adds the names that a surface file gives to labels 1, 2 ... for labels without a name. Characters that a format
/// does not allow become '_', long names are shortened, and a name that is in use (ignoring case) gets a number.
void add_names_of_file(const std::vector<std::string>& of_file, std::map<int, std::string>& names);

/// Parses mesh.size_at, such as "1=.5,head=.25": factors by label. @param names  names of labels
/// \throw UsageError  the text does not have this form, no label has the name, a label occurs twice, or a factor is
///   not in (0, 1]
std::map<int, double> parse_label_sizes(const std::string& text, const std::map<int, std::string>& names);

}  // namespace umtet
