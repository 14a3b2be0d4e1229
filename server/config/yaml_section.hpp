// SPDX-License-Identifier: Apache-2.0
// Strict reading of YAML mappings: every key is known, given once, of the right type and in range, or it is
// reported with its place. All problems of a file are collected; nothing here throws.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>
#include <glm/vec3.hpp>

#include "server/config/config_error.hpp"

namespace sonard::server {

/// Where problems and the places of keys gather while one file is read.
struct YamlFindings {
  std::vector<ConfigProblem> problems;
  KeyPositions positions;  ///< of the value of every key that was read
};

SourcePosition position_of(const YAML::Mark& mark);

/// Which numbers a key takes, in the unit its name ends in.
struct Range {
  double min;
  double max;
  bool above_min = false;  ///< min itself is not allowed

  static constexpr Range from(double min, double max) { return {min, max, false}; }
  static constexpr Range above(double min, double max) { return {min, max, true}; }
  bool holds(double value) const { return (above_min ? value > min : value >= min) && value <= max; }
  std::string text() const;
};

/// One mapping. At most one problem is reported for each key. Each reader writes its result only when the key
/// is there and its value is good, so what stood there before is the default. Readers name the unit of a
/// number in the key ("delay_ms").
class YamlSection {
 public:
  /// @param path of the mapping, "" for the document. A node that is not a mapping is reported and read as
  /// empty.
  YamlSection(YamlFindings& findings, const YAML::Node& node, std::string path);
  /// Reports the keys that no reader asked for.
  ~YamlSection();
  YamlSection(const YamlSection&) = delete;
  YamlSection& operator=(const YamlSection&) = delete;

  bool has(std::string_view key) const;
  bool is_list(std::string_view key) const;
  /// Reports the key when it is missing.
  void require(std::string_view key, std::string_view expected);
  /// Reports a problem with the value of a key that a reader accepted, or with the key's absence.
  void report(std::string_view key, const std::string& message);
  std::string path_of(std::string_view key) const;
  /// Lets a key that is not given stand where the key that its default comes from does.
  void place_default(std::string_view key, std::string_view source);

  void number(std::string_view key, double& out, const Range& range);
  /// A number, or one of the words, which stands for a number.
  void number_or_word(std::string_view key, double& out, const Range& range,
                      std::initializer_list<std::pair<std::string_view, double>> words);
  /// The key ends in _ms or _us.
  void duration(std::string_view key, std::chrono::nanoseconds& out, const Range& range);
  /// The key ends in _deg; the result is in radians.
  void angle(std::string_view key, double& out_rad, const Range& range_deg);
  void vector3(std::string_view key, glm::dvec3& out, const Range& range);
  void boolean(std::string_view key, bool& out);
  void text(std::string_view key, std::string& out);

  template <typename Integer>
  void integer(std::string_view key, Integer& out, std::uint64_t min, std::uint64_t max) {
    if (const std::optional<std::uint64_t> value = whole_number(key, min, max)) {
      out = static_cast<Integer>(*value);
    }
  }

  template <typename Enum>
  void choice(std::string_view key, Enum& out,
              std::initializer_list<std::pair<std::string_view, std::type_identity_t<Enum>>> choices) {
    std::vector<std::string_view> words;
    for (const auto& [word, value] : choices) {
      words.push_back(word);
    }
    if (const std::optional<std::size_t> index = word_index(key, words)) {
      out = (choices.begin() + *index)->second;
    }
  }

  /// The same for choices that are known only when the program runs.
  template <typename Value>
  void choice_of(std::string_view key, Value& out,
                 const std::vector<std::pair<std::string_view, Value>>& choices) {
    std::vector<std::string_view> words;
    for (const auto& [word, value] : choices) {
      words.push_back(word);
    }
    if (const std::optional<std::size_t> index = word_index(key, words)) {
      out = choices[*index].second;
    }
  }

  /// A text that `parse` understands ("an address such as 127.0.0.2").
  template <typename Value>
  void parsed(std::string_view key, Value& out, std::optional<Value> (*parse)(std::string_view),
              std::string_view expected) {
    if (const std::optional<std::string> word = plain_text(key, expected)) {
      if (const std::optional<Value> value = parse(*word)) {
        out = *value;
      } else {
        report_bad_value(key, *word, expected);
      }
    }
  }

  /// A list of such texts; `out` is replaced.
  template <typename Value>
  void parsed_list(std::string_view key, std::vector<Value>& out,
                   std::optional<Value> (*parse)(std::string_view), std::string_view expected) {
    std::vector<Value> values;
    const bool complete = each_text(key, expected, [&](const std::string& word) {
      const std::optional<Value> value = parse(word);
      if (value) {
        values.push_back(*value);
      }
      return value.has_value();
    });
    if (complete) {
      out = std::move(values);
    }
  }

  /// Reads a mapping inside this one, when it is there.
  void section(std::string_view key, const std::function<void(YamlSection&)>& read);
  /// Reads each mapping of a list.
  void sections(std::string_view key, const std::function<void(YamlSection&)>& read);

 private:
  struct Entry {
    std::string name;
    SourcePosition key_at;
    YAML::Node value;
    bool read = false;
  };

  const Entry* find(std::string_view key);
  const Entry* peek(std::string_view key) const;
  void problem(const SourcePosition& at, std::string path, std::string message);
  void report_bad_value(std::string_view key, std::string_view value, std::string_view expected);
  void report_unknown(const Entry& entry);
  std::optional<double> number_of(const YAML::Node& node, const std::string& path, const Range& range);
  std::optional<std::uint64_t> whole_number(std::string_view key, std::uint64_t min, std::uint64_t max);
  std::optional<std::size_t> word_index(std::string_view key, const std::vector<std::string_view>& words);
  std::optional<std::string> plain_text(std::string_view key, std::string_view expected);
  bool each_text(std::string_view key, std::string_view expected,
                 const std::function<bool(const std::string&)>& take);

  YamlFindings& findings_;
  std::string path_;
  SourcePosition at_;
  bool is_map_ = true;
  std::vector<Entry> entries_;
  std::vector<std::string> known_;  ///< keys that readers asked for
};

}  // namespace sonard::server
