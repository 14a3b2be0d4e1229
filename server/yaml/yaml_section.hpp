// SPDX-License-Identifier: Apache-2.0
// Strict reading of YAML mappings. Each key must be known, given once, of the right type and in range;
// otherwise it is reported with its place. All problems of a file are collected; nothing here throws.
// The line that reads a key is its only definition: name, form, range, default and meaning. The schema and
// the tables of docs/configuration.md are written from these lines (describe_config() in loader.hpp).
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>
#include <glm/vec3.hpp>

#include "server/yaml/config_error.hpp"
#include "server/yaml/key_reference.hpp"
#include "server/yaml/misplaced_keys.hpp"

namespace sonard::server {

/// Collects problems and the places of keys while one file is read.
struct YamlFindings {
  std::vector<ConfigProblem> problems;
  std::set<std::string, std::less<>> keys_with_problems;
  std::size_t problems_left_out = 0;     ///< beyond the maximum
  std::vector<UnknownKey> unknown_keys;  ///< without a similar key in their section
  std::vector<WordForMapping> words_for_mappings;
  std::vector<ConfigWarning> warnings;  ///< each once
  KeyPositions positions;               ///< of the value of every key that was read
  bool describing = false;  ///< no file is read: every section is entered to collect its keys (KeyReference)
};

SourcePosition position_of(const YAML::Mark& mark);

/// The valid numbers of a key, in the unit at the end of its name.
struct Range {
  double min;
  double max;
  bool above_min = false;  ///< min itself is not allowed

  static constexpr Range from(double min, double max) { return {min, max, false}; }
  static constexpr Range above(double min, double max) { return {min, max, true}; }
  bool holds(double value) const { return (above_min ? value > min : value >= min) && value <= max; }
};

/// The valid form of a text.
struct TextForm {
  std::string_view expected;  ///< for error messages: "an IPv4 address such as 127.0.0.2"
  std::string_view type;      ///< for people: "address"; for a list "addresses"
  std::string_view schema;    ///< as KeyReference::schema
  bool is_address = false;    ///< whether the text begins with an address
};

/// For YamlSection::parsed() and parsed_list(): accepts any text but an empty one.
inline std::optional<std::string> any_text(std::string_view text) {
  return text.empty() ? std::nullopt : std::optional(std::string(text));
}

/// One mapping. Reports at most one problem for each key. A reader writes its result only if the key exists
/// and its value is valid, so the previous content is the default. Readers take the unit of a number from the
/// name of the key ("delay_ms"). `meaning` is KeyReference::meaning.
class YamlSection {
 public:
  /// @param path of the mapping, "" for the document. A node that is not a mapping is reported and read as
  /// empty.
  /// @param key_at the place of the node's key or list; it stands for an empty node
  YamlSection(YamlFindings& findings, const YAML::Node& node, std::string path, SourcePosition key_at = {});
  /// Reports the keys that no reader asked for.
  ~YamlSection();
  YamlSection(const YamlSection&) = delete;
  YamlSection& operator=(const YamlSection&) = delete;

  bool has(std::string_view key) const;
  bool is_list(std::string_view key) const;
  /// The plain value of a key that may have a mapping instead. Empty if it has one, or is missing.
  std::string_view word(std::string_view key) const;
  /// Reports the key if it is missing.
  void require(std::string_view key, std::string_view expected);
  /// Does not report the keys that no reader asked for, because their meaning is unknown.
  void ignore_rest();
  /// Reports a problem with the value of a key that a reader accepted, or with the key's absence.
  void report(std::string_view key, const std::string& message);
  /// As report(), for something that this machine's network lacks and may have later.
  void report_network(std::string_view key, const std::string& message);
  /// Warns of a key; the configuration remains valid.
  void warn(std::string_view key, std::string message) { warn_of(path_of(key), std::move(message)); }
  /// As warn(), for a key of any other section.
  void warn_of(std::string path, std::string message);
  /// Warns of a key that is given but has no effect here.
  void warn_if_given(std::string_view key, std::string_view why);
  /// A key of earlier versions, and what to do instead. Both texts must outlive the section.
  void retired(std::string_view key, std::string_view what_to_do) { retired_.emplace_back(key, what_to_do); }
  /// A key that other programs have here, and what to write instead. Both texts must outlive the section.
  void foreign(std::string_view key, std::string_view what_to_do) { foreign_.emplace_back(key, what_to_do); }
  /// Reads the key `former`, if a file still has it, as `key`, and warns. Call it before `key` is read.
  void renamed(std::string_view former, std::string_view key);
  /// Reads the value `former` of a key, or of an item of its list, if a file still has it, as `value`, and
  /// warns. Call it before `key` is read.
  void renamed_value(std::string_view key, std::string_view former, std::string_view value);
  std::string path_of(std::string_view key) const;
  /// If a key is not given, its place is the place of the key that gives its default.
  void place_default(std::string_view key, std::string_view source);

  /// Adds sentences on the whole mapping for the schema and docs/configuration.md.
  void introduce(std::string_view sentences) { introduction_ = sentences; }
  /// Sets a default for the schema and docs/configuration.md, if the value before is not the default.
  void default_is(std::string_view key, std::string_view text, std::string_view json = "");
  /// Whether there is no file. Then each key is read for its description, whatever the other keys are.
  bool describing() const { return findings_.describing; }
  const std::vector<KeyReference>& known() const { return known_; }  ///< keys that readers asked for

  /// @param units_per_one units of the key in one unit of `out`: 1000 for "_mm" and metres
  void number(std::string_view key, double& out, const Range& range, std::string_view meaning,
              double units_per_one = 1.0);
  /// A number, or a word that means a number.
  void number_or_word(std::string_view key, double& out, const Range& range,
                      const std::vector<std::pair<std::string_view, double>>& words,
                      std::string_view meaning);
  /// The key ends in _us, _ms, _s or _min.
  void duration(std::string_view key, std::chrono::nanoseconds& out, const Range& range,
                std::string_view meaning);
  /// The key ends in _deg; the result is in radians.
  void angle(std::string_view key, double& out_rad, const Range& range_deg, std::string_view meaning);
  void vector3(std::string_view key, glm::dvec3& out, const Range& range, std::string_view meaning);
  void boolean(std::string_view key, bool& out, std::string_view meaning);
  void text(std::string_view key, std::string& out, std::string_view meaning);
  /// A relative path starts at `folder`.
  void path(std::string_view key, std::filesystem::path& out, const std::filesystem::path& folder,
            std::string_view meaning);

  template <typename Integer>
  void integer(std::string_view key, Integer& out, std::uint64_t min, std::uint64_t max,
               std::string_view meaning) {
    auto value = static_cast<std::uint64_t>(out);
    whole_number(key, value, min, max, meaning);
    out = static_cast<Integer>(value);
  }

  /// @return false if the value is not one of the words; true if there is no value
  template <typename Value>
  bool choice(std::string_view key, Value& out,
              const std::vector<std::pair<std::string_view, std::type_identity_t<Value>>>& choices,
              std::string_view meaning) {
    std::vector<std::string_view> words;
    std::string_view default_word;
    for (const auto& [word, value] : choices) {
      words.push_back(word);
      default_word = value == out ? word : default_word;
    }
    const std::optional<std::size_t> index = word_index(key, words, default_word, meaning);
    if (index) {
      out = choices[*index].second;
    }
    return index.has_value() || !has(key);
  }

  /// A text that `parse` accepts. @return false if the value is invalid; true if it was read or is missing
  template <typename Value>
  bool parsed(std::string_view key, Value& out, std::optional<Value> (*parse)(std::string_view),
              const TextForm& form, std::string_view meaning) {
    document(key, form.type, form.schema, "", meaning);
    if (const std::optional<std::string> word = plain_text(key, form.expected)) {
      if (const std::optional<Value> value = parse(*word)) {
        out = *value;
      } else {
        report_bad_value(key, *word, form.expected, form.is_address);
        return false;
      }
      return true;
    }
    return !has(key);
  }

  /// A list of such texts; replaces `out`.
  /// @param if_empty the error message for an empty list; if it is not given, the list may be empty
  template <typename Value>
  void parsed_list(std::string_view key, std::vector<Value>& out,
                   std::optional<Value> (*parse)(std::string_view), const TextForm& form,
                   std::string_view meaning, std::string_view if_empty = "") {
    document_list(key, form, meaning, if_empty.empty());
    std::vector<Value> values;
    const bool complete = each_text(key, form.expected, [&](const std::string& word) {
      const std::optional<Value> value = parse(word);
      if (value) {
        values.push_back(*value);
      }
      return value.has_value();
    });
    if (complete && values.empty() && !if_empty.empty()) {
      report(key, std::string(if_empty));
    } else if (complete) {
      out = std::move(values);
    }
  }

  /// Reads a mapping inside this one, if it exists.
  void section(std::string_view key, std::string_view meaning, const std::function<void(YamlSection&)>& read);
  /// Reads each mapping of a list.
  void sections(std::string_view key, std::string_view meaning,
                const std::function<void(YamlSection&)>& read);

 private:
  struct Entry {
    std::string name;
    SourcePosition key_at;
    SourcePosition value_at;  ///< if the value is empty: the place of the key
    YAML::Node value;
    bool read = false;
  };

  KeyReference& known_key(std::string_view key);
  /// Fills in a KeyReference. A key that is documented twice may have either form.
  void document(std::string_view key, std::string_view type, std::string_view schema,
                std::string_view default_json, std::string_view meaning);
  void document_list(std::string_view key, const TextForm& form, std::string_view meaning, bool may_be_empty);
  /// Reads the mapping of a key, or an item of its list.
  void read_inner(std::string_view key, const YAML::Node& node, std::string path, SourcePosition key_at,
                  const std::function<void(YamlSection&)>& read);
  const Entry* find(std::string_view key);
  const Entry* peek(std::string_view key) const;
  /// The place of a key's value; without a value, of the section.
  SourcePosition place_of_key(std::string_view key) const;
  /// The index of the added problem; nothing if `path` has a problem already or the file has too many.
  std::optional<std::size_t> problem(const SourcePosition& at, std::string path, std::string message,
                                     bool of_network = false);
  /// @param is_address TextForm::is_address
  void report_bad_value(std::string_view key, std::string_view value, std::string_view expected,
                        bool is_address);
  void report_unknown(const Entry& entry);
  std::optional<double> number_of(const YAML::Node& node, const SourcePosition& at, const std::string& path,
                                  const Range& range);
  void whole_number(std::string_view key, std::uint64_t& out, std::uint64_t min, std::uint64_t max,
                    std::string_view meaning);
  std::optional<std::size_t> word_index(std::string_view key, const std::vector<std::string_view>& words,
                                        std::string_view default_word, std::string_view meaning);
  std::optional<std::string> plain_text(std::string_view key, std::string_view expected);
  bool each_text(std::string_view key, std::string_view expected,
                 const std::function<bool(const std::string&)>& take);

  YamlFindings& findings_;
  std::string path_;
  SourcePosition at_;
  bool is_map_ = true;
  std::vector<Entry> entries_;
  std::map<std::string, std::size_t, std::less<>> entry_of_;  ///< by name, places in entries_
  std::vector<KeyReference> known_;
  std::vector<std::pair<std::string_view, std::string_view>> retired_;
  std::vector<std::pair<std::string_view, std::string_view>> foreign_;
  std::string introduction_;
};

}  // namespace sonard::server
