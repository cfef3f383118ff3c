#pragma once

#include <map>
#include <string>
#include <vector>

namespace umtet {

/// With A to Z as a to z: names that differ in nothing else are one.
std::string lower_case(std::string name);

/// "1=feet,2=head" of output.label_names. \throw UsageError  not of that form, a label or a name twice (case aside), or
/// a name that a format cannot keep
std::map<int, std::string> parse_label_names(const std::string& text);

/// Names that the file of a surface has for label 1, 2 ..., for the labels that have none: with '_' for what a format
/// cannot keep, shortened, and with a number where another has the name (case aside).
void add_names_of_file(const std::vector<std::string>& of_file, std::map<int, std::string>& names);

/// "1=.5,head=.25" of mesh.size_at: factors by label. @param names  of labels
/// \throw UsageError  not of that form, a name that no label has, a label twice, or a factor that is not in (0, 1]
std::map<int, double> parse_label_sizes(const std::string& text, const std::map<int, std::string>& names);

}  // namespace umtet
