// SPDX-License-Identifier: Apache-2.0
// The elements of an SDF file, what their texts say, and the complaints about them.
#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonard::render {

/// The include that put a model, or a part of one, where it stands.
struct Inclusion {
  std::string place;      ///< "file:line" of the <include>
  std::string to_rename;  ///< what to do if the name is taken: "give it a <name>"
};

struct SdfElement {
  std::string name;
  std::string text;  ///< without the blanks around it
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<std::unique_ptr<SdfElement>> children;
  const SdfElement* parent = nullptr;                 ///< null: the root
  std::shared_ptr<const std::filesystem::path> file;  ///< that it stands in
  int line = 0;
  /// Of the root of an included file, its <pose>, and what a merge brought; null: of all others.
  std::shared_ptr<const Inclusion> inclusion;
  /// A frame that stands for an include whose file is not there. Without a name, it stands for a merged one.
  bool is_missing = false;

  /// Null where it is not given.
  const std::string* attribute(std::string_view key) const;
  void set_attribute(std::string_view key, std::string value);
  /// The first of this name; null where there is none.
  const SdfElement* child(std::string_view child_name) const;
  SdfElement* child(std::string_view child_name);
  /// A new last child that has the place of `from`.
  SdfElement& add_child(std::string child_name, const SdfElement& from);
  /// A new last child with the text and the attributes of `from`, without its children.
  SdfElement& add_copy(const SdfElement& from);
  /// Attribute "name", "" where it has none.
  std::string given_name() const;
  std::filesystem::path folder() const { return file->parent_path(); }
  /// "file:line".
  std::string place() const;
  /// "file:line" for complaints that depend on what stands around the element: of the include that brought
  /// it.
  std::string place_in_scope() const { return inclusion ? inclusion->place : place(); }
};

/// The XML namespace of our own elements, whose prefix is "sonard:" in the tree, whatever it is in the file.
inline constexpr const char* own_namespace = "https://sonard.dev/sdf";
/// Whether an XML namespace is ours. "urn:sonard" is that of worlds shipped before version 0.2.
bool is_own_namespace(std::string_view uri);

/// Whether an attribute is "true", in any case, or "1", as libsdformat has it. Null is false.
bool is_true(const std::string* attribute);

/// Text of an element without the blanks around it.
std::string_view trimmed(std::string_view text);

/// @param text what `what` says, for the message
/// @throws WorldError where it is no finite number
double number(std::string_view text, std::string_view what);

/// The numbers of an element's text; `otherwise` where it is not given.
/// @throws WorldError "radius 'one': expected a number", without a place
std::vector<double> numbers_of(const SdfElement* element, const std::vector<double>& otherwise);

/// Complaints about a world, each once and with its place, to be told of together; of more than a thousand
/// the first.
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
