// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/stl_reader.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "renderer/scene/local_file.hpp"

namespace sonard::render {
namespace {

constexpr std::size_t header_bytes = 84;
constexpr std::size_t triangle_bytes = 50;
/// A larger count shows that the bytes are not a header.
constexpr std::uint32_t plausible_triangles = 50'000'000;

bool is_blank(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}

/// The rest of the line is a comment, as in Gazebo.
bool begins_comment(char c) {
  return c == '#' || c == '!' || c == '$';
}

char lower(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

/// @param word in lower case
bool is_word(std::string_view text, std::string_view word) {
  return std::ranges::equal(text, word, [](char a, char b) { return lower(a) == b; });
}

/// Splits a text into words, and counts lines up to the last word.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  std::size_t line() const { return line_; }

  /// The next word; empty at the end.
  std::string_view next() {
    while (!text_.empty() && (is_blank(text_.front()) || begins_comment(text_.front()))) {
      line_ += text_.front() == '\n' ? 1 : 0;
      text_.remove_prefix(begins_comment(text_.front()) ? std::min(text_.find_first_of("\r\n"), text_.size())
                                                        : 1);
    }
    return take(static_cast<std::size_t>(std::ranges::find_if(text_, is_blank) - text_.begin()));
  }

  /// The rest of the line, without surrounding blanks and without a facet that begins there.
  std::string_view name() {
    std::string_view rest = text_.substr(0, text_.find_first_of("\r\n"));
    const std::string_view facet = " facet";
    const auto* const end =
        std::search(rest.begin(), rest.end(), facet.begin(), facet.end(),
                    [](char a, char b) { return b == ' ' ? is_blank(a) : lower(a) == b; });
    rest = rest.substr(0, static_cast<std::size_t>(end - rest.begin()));
    take(rest.size());
    const std::size_t begin = std::min(rest.size(), rest.find_first_not_of(" \t"));
    return rest.substr(begin, rest.find_last_not_of(" \t") + 1 - begin);
  }

  double number() {
    std::string_view word = next();
    const std::string_view given = word;
    if (word.starts_with('+')) {
      word.remove_prefix(1);
    }
    double value = 0.0;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || rest != word.data() + word.size()) {
      throw std::runtime_error(
          given.empty() ? "the file is cut short: it ends inside a facet"
                        : fmt::format("line {}: '{}' is not a number", line_, given.substr(0, 60)));
    }
    return value;
  }

 private:
  std::string_view take(std::size_t size) {
    const std::string_view taken = text_.substr(0, size);
    text_.remove_prefix(size);
    return taken;
  }

  std::string_view text_;
  std::size_t line_ = 1;
};

void add_loop(const std::vector<glm::dvec3>& corners, RawPart& part) {
  const auto base = static_cast<std::uint32_t>(part.positions.size());
  part.positions.insert(part.positions.end(), corners.begin(), corners.end());
  for (std::uint32_t i = 1; i + 1 < corners.size(); ++i) {
    part.indices.insert(part.indices.end(), {base, base + i, base + i + 1});
  }
}

RawMesh read_text(std::string_view text, const std::string& submesh) {
  RawMesh mesh;
  RawPart taken;
  std::vector<glm::dvec3> corners;
  bool selected = submesh.empty();
  bool is_open = false;  // after "solid", before its "endsolid"
  Words words(text);
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (is_word(word, "solid")) {
      is_open = true;
      const std::string name(words.name());
      selected = submesh.empty() || name == submesh;
      if (!name.empty()) {
        mesh.names.push_back(name);
      }
    } else if (is_word(word, "endsolid")) {
      is_open = false;
      words.name();
    } else if (is_word(word, "vertex")) {
      const double x = words.number(), y = words.number();
      corners.emplace_back(x, y, words.number());
    } else if (is_word(word, "endloop")) {
      if (corners.size() < 3) {
        throw std::runtime_error(
            fmt::format("line {}: a facet has {} corners, expected 3", words.line(), corners.size()));
      }
      if (selected) {
        add_loop(corners, taken);
      }
      corners.clear();
    }
  }
  if (!corners.empty()) {
    throw std::runtime_error("the file is cut short: it ends inside a facet");
  }
  if (is_open) {
    throw std::runtime_error("the file is cut short: its last solid has no endsolid");
  }
  mesh.add(taken, glm::dmat4(1.0));
  return mesh;
}

std::uint32_t number_at(std::string_view bytes, std::size_t place) {
  std::uint32_t number = 0;
  for (std::size_t i = 4; i > 0; --i) {
    number = number << 8U | static_cast<unsigned char>(bytes[place + i - 1]);
  }
  return number;
}

float float_at(std::string_view bytes, std::size_t place) {
  const std::uint32_t number = number_at(bytes, place);
  float value = 0.0F;
  std::memcpy(&value, &number, sizeof value);
  return value;
}

RawMesh read_binary(std::string_view bytes, std::uint32_t count, const std::string& submesh) {
  RawMesh mesh;
  RawPart part;
  for (std::uint32_t i = 0; submesh.empty() && i < 3 * count; ++i) {
    // A triangle is a normal, three corners of three floats, and two unused bytes.
    const std::size_t corner = header_bytes + triangle_bytes * (i / 3) + 12 + 12 * (i % 3);
    part.positions.emplace_back(float_at(bytes, corner), float_at(bytes, corner + 4),
                                float_at(bytes, corner + 8));
    part.indices.push_back(i);
  }
  mesh.add(part, glm::dmat4(1.0));
  return mesh;
}

/// Whether the bytes begin with "solid" (or with a facet, if that line is missing) and have no bytes that
/// text never has. Headers of binary files may begin with "solid", too.
bool is_text(std::string_view bytes) {
  const std::string_view head = bytes.substr(bytes.starts_with("\xEF\xBB\xBF") ? 3 : 0, 1024);
  const std::string_view first = Words(head).next();
  return (is_word(first, "solid") || is_word(first, "facet")) && head.find('\0') == std::string_view::npos;
}

}  // namespace

RawMesh read_stl(const MeshSource& source) {
  const std::string bytes = content_of(source.file);
  const std::uint32_t count = bytes.size() < header_bytes ? 0 : number_at(bytes, header_bytes - 4);
  const std::uint64_t whole = header_bytes + std::uint64_t{triangle_bytes} * count;
  const bool has_size_of_binary = bytes.size() >= header_bytes && bytes.size() == whole;
  if (!has_size_of_binary && is_text(bytes)) {
    return read_text(bytes.starts_with("\xEF\xBB\xBF") ? std::string_view(bytes).substr(3) : bytes,
                     source.submesh);
  }
  if (!has_size_of_binary && (count == 0 || count > plausible_triangles)) {
    throw std::runtime_error(
        fmt::format("neither a text STL, which begins with 'solid', nor a binary one, which has 84 + 50 n "
                    "bytes for the n "
                    "triangles of its header (n is {}, there are {} bytes)",
                    count, bytes.size()));
  }
  if (bytes.size() < whole) {
    throw std::runtime_error(fmt::format("the file is cut short: {} triangles need {} bytes, there are {}",
                                         count, whole, bytes.size()));
  }
  return read_binary(bytes, count, source.submesh);
}

}  // namespace sonard::render
