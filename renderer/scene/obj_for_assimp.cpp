// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/obj_for_assimp.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <assimp/material.h>

#include <fmt/format.h>

namespace sonard::render {
namespace {

constexpr std::string_view blanks = " \t\v\f";

/// Removes the first word from `text`, and the blanks before it. Empty if no word is left.
std::string_view take_word(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(blanks));
  text.remove_prefix(word.size());
  return word;
}

std::string_view without_blanks_around(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

/// A '#' after a '.' is no comment: Microsoft's library writes "1.#QNAN".
std::string_view without_comment(std::string_view text) {
  std::size_t at = text.find('#');
  while (at != std::string_view::npos && at > 0 && text[at - 1] == '.') {
    at = text.find('#', at + 1);
  }
  return text.substr(0, at);
}

/// One line with its continuations, split after its first word.
struct Line {
  std::size_t number = 0;  ///< in the file
  std::string_view keyword;
  std::string_view rest;
};

/// Goes through the lines of a document. Lines end with LF, CR LF or CR.
class Lines {
 public:
  explicit Lines(std::string_view document) : document_(document) {
    constexpr std::string_view utf8_mark = "\xEF\xBB\xBF";
    document_.remove_prefix(document_.starts_with(utf8_mark) ? utf8_mark.size() : 0);
  }

  /// @return a line that is valid until the next call; nullopt at the end
  std::optional<Line> next() {
    if (document_.empty()) {
      return std::nullopt;
    }
    const std::size_t number = lines_ + 1;
    std::string_view text = take_line();
    if (text.ends_with('\\') && !without_blanks_around(text).starts_with('#')) {
      joined_ = text;
      while (joined_.ends_with('\\')) {
        joined_.back() = ' ';
        joined_ += take_line();
      }
      text = joined_;
    }
    const std::string_view keyword = take_word(text);
    return Line{number, keyword, text};
  }

 private:
  std::string_view take_line() {
    const std::string_view line = document_.substr(0, document_.find_first_of("\r\n"));
    document_.remove_prefix(line.size());
    document_.remove_prefix(document_.starts_with("\r\n") ? 2 : std::min<std::size_t>(document_.size(), 1));
    ++lines_;
    return line;
  }

  std::string_view document_;
  std::string joined_;
  std::size_t lines_ = 0;
};

/// nullopt unless the whole word is a number. A decimal comma counts as a point.
std::optional<double> number_of(std::string_view word) {
  word.remove_prefix(word.starts_with('+') ? 1 : 0);
  std::string with_point(word);
  std::ranges::replace(with_point, ',', '.');
  const char* const end = with_point.data() + with_point.size();
  double value = 0.0;
  const auto [rest, error] = std::from_chars(with_point.data(), end, value);
  return error == std::errc() && rest == end ? std::optional(value) : std::nullopt;
}

struct Counts {
  std::size_t vertices = 0, texcoords = 0, normals = 0;

  void add(std::string_view keyword) {
    vertices += keyword == "v" ? 1 : 0;
    texcoords += keyword == "vt" ? 1 : 0;
    normals += keyword == "vn" ? 1 : 0;
  }
};

Counts counts_in(std::string_view document) {
  Counts counts;
  Lines lines(document);
  while (const auto line = lines.next()) {
    counts.add(line->keyword);
  }
  return counts;
}

/// The index in a corner of a face, from 1. Negative ones count back from the last one so far.
/// @return 0 if there is no such index
std::size_t index_of(std::string_view field, std::size_t so_far, std::size_t in_file) {
  std::int64_t index = 0;
  const auto [rest, error] = std::from_chars(field.data(), field.data() + field.size(), index);
  if (error != std::errc() || rest != field.data() + field.size()) {
    return 0;
  }
  index += index < 0 ? static_cast<std::int64_t>(so_far) + 1 : 0;
  return index < 1 || static_cast<std::size_t>(index) > in_file ? 0 : static_cast<std::size_t>(index);
}

/// Indices from 1; 0: none.
struct Corner {
  std::size_t vertex, texcoord, normal;
};

class Rewriter {
 public:
  explicit Rewriter(std::string_view document) : document_(document), in_file_(counts_in(document)) {}

  ObjForAssimp rewritten() {
    Lines lines(document_);
    while (const auto line = lines.next()) {
      so_far_.add(line->keyword);
      add(*line);
    }
    if (bad_lines_ > 0) {
      append("vt 0 0\nvn 0 0 0\n");  // of corners that lack theirs
      made_.warnings.push_back(
          fmt::format("line {}: bad texture coordinates or normals are left out (lines: {}); export the mesh "
                      "again if it needs them",
                      first_bad_line_, bad_lines_));
    }
    return std::move(made_);
  }

 private:
  void add(const Line& line) {
    if (line.keyword == "v") {
      add_vertex(line);
    } else if (line.keyword == "vt") {
      add_attribute(line, 1, 2);
    } else if (line.keyword == "vn") {
      add_attribute(line, 3, 3);
    } else if (line.keyword == "f" || line.keyword == "fo") {
      add_face(line);
    } else if (line.keyword == "o" || line.keyword == "g" || line.keyword == "usemtl") {
      const std::string_view name = without_blanks_around(line.rest);
      append("{} {}\n", line.keyword, name);
      has_material_ = has_material_ || (line.keyword == "usemtl" && !name.empty());
    }
  }

  template <class... Values>
  void append(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(made_.text), format, std::forward<Values>(values)...);
  }

  void add_vertex(const Line& line) {
    std::array<double, 3> position{};
    std::string_view rest = without_comment(line.rest);
    for (double& coordinate : position) {
      const std::string_view word = take_word(rest);
      const std::optional<double> number = number_of(word);
      if (!number) {
        throw std::runtime_error(fmt::format("line {}: a vertex with '{}' (expected three numbers)",
                                             line.number, word.substr(0, 60)));
      }
      coordinate = *number;
    }
    append("v {} {} {}\n", position[0], position[1], position[2]);
  }

  /// A texture coordinate or a normal.
  void add_attribute(const Line& line, std::size_t fewest, std::size_t most) {
    std::array<double, 3> values{};
    std::string_view rest = without_comment(line.rest);
    for (std::size_t i = 0; i < most; ++i) {
      const std::string_view word = take_word(rest);
      if (word.empty() && i >= fewest) {
        break;
      }
      const std::optional<double> number = number_of(word);
      if (!number || !std::isfinite(*number)) {
        values = {};
        count_bad(line);
        break;
      }
      values[i] = *number;
    }
    append("{}", line.keyword);
    std::for_each_n(values.begin(), most, [&](double value) { append(" {}", value); });
    append("\n");
  }

  void add_face(const Line& line) {
    corners_.clear();
    std::string_view rest = without_comment(line.rest);
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
      corners_.push_back(corner_of(word, line));
    }
    if (corners_.size() < 3) {
      return;
    }
    made_.has_faces = true;
    if (!has_material_) {  // Assimp would give the face the next one of its object
      append("usemtl {}\n", AI_DEFAULT_MATERIAL_NAME);
      has_material_ = true;
    }
    give_all(&Corner::texcoord, in_file_.texcoords + 1, line);
    give_all(&Corner::normal, in_file_.normals + 1, line);
    append("f");
    for (const Corner& corner : corners_) {
      append(" {}", corner.vertex);
      if (corner.texcoord != 0) {
        append("/{}", corner.texcoord);
      }
      if (corner.normal != 0) {
        append("{}/{}", corner.texcoord == 0 ? "/" : "", corner.normal);
      }
    }
    append("\n");
  }

  /// Assimp gives the attributes of a face to its first corners, so all need one if any has one.
  void give_all(std::size_t Corner::*attribute, std::size_t zero, const Line& line) {
    const auto lacks = [&](const Corner& corner) { return corner.*attribute == 0; };
    if (std::ranges::all_of(corners_, lacks)) {
      return;
    }
    for (Corner& corner : corners_) {
      if (lacks(corner)) {
        corner.*attribute = zero;
        count_bad(line);
      }
    }
  }

  /// @param word "V", "V/VT", "V//VN" or "V/VT/VN"
  Corner corner_of(std::string_view word, const Line& line) {
    std::array<std::string_view, 3> fields;
    std::string_view rest = word;
    for (std::string_view& field : fields) {
      field = rest.substr(0, rest.find('/'));
      rest.remove_prefix(std::min(field.size() + 1, rest.size()));
    }
    const Corner corner{index_of(fields[0], so_far_.vertices, in_file_.vertices),
                        index_of(fields[1], so_far_.texcoords, in_file_.texcoords),
                        index_of(fields[2], so_far_.normals, in_file_.normals)};
    if (corner.vertex == 0) {
      throw std::runtime_error(
          fmt::format("line {}: a face with the corner '{}' (expected one of the {} vertices)", line.number,
                      word.substr(0, 60), in_file_.vertices));
    }
    if ((corner.texcoord == 0 && !fields[1].empty()) || (corner.normal == 0 && !fields[2].empty())) {
      count_bad(line);
    }
    return corner;
  }

  void count_bad(const Line& line) {
    first_bad_line_ = bad_lines_ == 0 ? line.number : first_bad_line_;
    bad_lines_ += line.number == last_bad_line_ ? 0 : 1;
    last_bad_line_ = line.number;
  }

  std::string_view document_;
  const Counts in_file_;
  Counts so_far_;
  ObjForAssimp made_;
  std::vector<Corner> corners_;  ///< of the current face
  bool has_material_ = false;
  std::size_t bad_lines_ = 0, first_bad_line_ = 0, last_bad_line_ = 0;
};

}  // namespace

ObjForAssimp obj_for_assimp(std::string_view document) {
  return Rewriter(document).rewritten();
}

}  // namespace sonard::render
