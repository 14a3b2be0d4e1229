// SPDX-License-Identifier: Apache-2.0
// The elements of an SDF file, the values of their texts, and error messages about them.
#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonard::render {

/// The include that brought a model, or a part of one, into its place.
struct Inclusion {
  std::string place;      ///< "file:line" of the <include>
  std::string to_rename;  ///< advice if the name is taken: "give it a <name>"
};

struct SdfElement {
  std::string name;
  std::string text;  ///< without surrounding blanks
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<std::unique_ptr<SdfElement>> children;
  const SdfElement* parent = nullptr;                 ///< null: the root
  std::shared_ptr<const std::filesystem::path> file;  ///< that contains it
  int line = 0;
  /// Set for the root of an included file, its <pose>, and merged elements; null for all others.
  std::shared_ptr<const Inclusion> inclusion;
  /// A frame in place of an include with a missing file. It has no name if the include is a merge.
  bool is_missing = false;

  /// nullptr if not given.
  const std::string* attribute(std::string_view key) const;
  void set_attribute(std::string_view key, std::string value);
  /// The first child with this name, or nullptr.
  const SdfElement* child(std::string_view child_name) const;
  SdfElement* child(std::string_view child_name);
  /// Appends a child with the file and line of `from`.
  SdfElement& add_child(std::string child_name, const SdfElement& from);
  /// Appends a child with the text and the attributes of `from`, without its children.
  SdfElement& add_copy(const SdfElement& from);
  /// Attribute "name", or "".
  std::string given_name() const;
  std::filesystem::path folder() const { return file->parent_path(); }
  /// "file:line".
  std::string place() const;
  /// "file:line" for problems that depend on the surroundings of the element: the place of the include that
  /// brought it, if any.
  std::string place_in_scope() const { return inclusion ? inclusion->place : place(); }
};

/// The XML namespace of our own elements, whose prefix is always "sonard:" in the tree.
inline constexpr const char* own_namespace = "https://sonard.dev/sdf";
/// Whether an XML namespace is ours. Worlds shipped before version 0.2 have "urn:sonard".
bool is_own_namespace(std::string_view uri);

/// Whether an attribute is "true", in any case, or "1", as in libsdformat. nullptr gives false.
bool is_true(const std::string* attribute);

/// Text of an element without surrounding blanks.
std::string_view trimmed(std::string_view text);

/// @param text the value of `what`, which is for the message
/// @throws WorldError if it is not a finite number
double number(std::string_view text, std::string_view what);

/// The numbers in an element's text; `otherwise` if `element` is null.
/// @throws WorldError "radius 'one': expected a number", without a place
std::vector<double> numbers_of(const SdfElement* element, const std::vector<double>& otherwise);

/// Problems of a world, each once and with its place, for one report. Keeps the first thousand.
class WorldProblems {
 public:
  void add(std::string line);
  bool empty() const { return lines_.empty(); }
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::vector<std::string> lines_;
  std::set<std::string> known_;
};

}  // namespace sonard::render
