// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/ply_reader.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "renderer/scene/local_file.hpp"

namespace sonard::render {
namespace {

enum class Encoding { text, little_endian, big_endian };
enum class Kind { signed_integer, unsigned_integer, real };

struct Type {
  std::string_view name, other_name;
  Kind kind;
  std::size_t bytes;
};
constexpr std::array<Type, 8> types{{{"char", "int8", Kind::signed_integer, 1},
                                     {"uchar", "uint8", Kind::unsigned_integer, 1},
                                     {"short", "int16", Kind::signed_integer, 2},
                                     {"ushort", "uint16", Kind::unsigned_integer, 2},
                                     {"int", "int32", Kind::signed_integer, 4},
                                     {"uint", "uint32", Kind::unsigned_integer, 4},
                                     {"float", "float32", Kind::real, 4},
                                     {"double", "float64", Kind::real, 8}}};

/// Names differ between programs.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> texture_names{
    {{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}}};

struct Property {
  std::string name;
  const Type* type;
  const Type* count_type;  ///< of a list; null: a single value
};

struct Element {
  std::string name;
  std::uint64_t count;
  std::vector<Property> properties;
};

struct PlyHeader {
  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
  std::size_t bytes = 0;
  std::size_t lines = 0;
};

const Type& type_of(const std::string& name) {
  const auto* const found = std::ranges::find_if(
      types, [&](const Type& type) { return type.name == name || type.other_name == name; });
  if (found == types.end()) {
    throw std::runtime_error(fmt::format("'{}' is not a type of a property", name));
  }
  return *found;
}

Encoding encoding_of(const std::string& name) {
  if (name == "ascii") {
    return Encoding::text;
  }
  if (name != "binary_little_endian" && name != "binary_big_endian") {
    throw std::runtime_error(
        fmt::format("format '{}' (expected ascii, binary_little_endian or binary_big_endian)", name));
  }
  return name == "binary_little_endian" ? Encoding::little_endian : Encoding::big_endian;
}

Property property_of(std::istringstream& words) {
  std::string type, count_type, name;
  words >> type;
  const bool is_list = type == "list";
  if (is_list) {
    words >> count_type >> type;
  }
  if (!(words >> name)) {
    throw std::runtime_error("a property without a type and a name");
  }
  return {name, &type_of(type), is_list ? &type_of(count_type) : nullptr};
}

/// @return whether it was the last line of the header
bool add_line(const std::string& line, PlyHeader& header) {
  std::istringstream words(line);
  std::string keyword;
  words >> keyword;
  if (keyword == "format") {
    std::string name;
    words >> name;
    header.encoding = encoding_of(name);
  } else if (keyword == "element") {
    Element element{"", 0, {}};
    if (!(words >> element.name >> element.count)) {
      throw std::runtime_error("an element without a name and a count");
    }
    header.elements.push_back(std::move(element));
  } else if (keyword == "property") {
    if (header.elements.empty()) {
      throw std::runtime_error("a property before any element");
    }
    header.elements.back().properties.push_back(property_of(words));
  } else if (!keyword.empty() && keyword != "ply" && keyword != "comment" && keyword != "obj_info" &&
             keyword != "end_header") {
    throw std::runtime_error(fmt::format("'{}' is not a keyword of a PLY header", keyword.substr(0, 60)));
  }
  return keyword == "end_header";
}

PlyHeader header_of(std::string_view bytes) {
  PlyHeader header;
  if (!bytes.starts_with("ply")) {
    throw std::runtime_error("a PLY file must begin with 'ply'");
  }
  for (bool ended = false; !ended;) {
    const std::string_view rest = bytes.substr(header.bytes);
    const std::size_t length = rest.find('\n');
    if (length == std::string_view::npos) {
      throw std::runtime_error("the file is cut short: its header has no end_header");
    }
    header.bytes += length + 1;
    ++header.lines;
    try {
      ended = add_line(std::string(rest.substr(0, length)), header);
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(fmt::format("line {}: {}", header.lines, error.what()));
    }
  }
  return header;
}

/// Reads one value after another; nullopt at the end of the file.
class BinaryValues {
 public:
  BinaryValues(std::string_view bytes, bool is_big_endian) : bytes_(bytes), is_big_endian_(is_big_endian) {}

  std::uint64_t most_values(const Type& type) const { return bytes_.size() / type.bytes; }

  std::optional<double> next(const Type& type) {
    if (bytes_.size() < type.bytes) {
      return std::nullopt;
    }
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < type.bytes; ++i) {
      const std::size_t place = is_big_endian_ ? i : type.bytes - 1 - i;
      number = number << 8U | static_cast<unsigned char>(bytes_[place]);
    }
    bytes_.remove_prefix(type.bytes);
    if (type.kind == Kind::real) {
      return type.bytes == 8 ? std::bit_cast<double>(number)
                             : static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(number)));
    }
    const std::uint64_t sign = std::uint64_t{1} << (8 * type.bytes - 1);
    const bool is_negative = type.kind == Kind::signed_integer && (number & sign) != 0;
    return static_cast<double>(number) - (is_negative ? 2.0 * static_cast<double>(sign) : 0.0);
  }

 private:
  std::string_view bytes_;
  bool is_big_endian_;
};

class TextValues {
 public:
  TextValues(std::string_view bytes, std::size_t lines_before)
      : begin_of_line_(bytes), rest_(bytes), line_(lines_before + 1) {}

  /// A value and the blank after it take at least two bytes.
  std::uint64_t most_values(const Type&) const { return (rest_.size() + 1) / 2; }

  /// @throws std::runtime_error with the line, if a word is not a finite number
  std::optional<double> next(const Type&) {
    while (!rest_.empty() && is_blank(rest_.front())) {
      if (rest_.front() == '\n') {
        ++line_;
        begin_of_line_ = rest_.substr(1);
      }
      rest_.remove_prefix(1);
    }
    if (rest_.empty()) {
      return std::nullopt;
    }
    const auto* const end = std::ranges::find_if(rest_, is_blank);
    std::string_view word = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
    rest_.remove_prefix(word.size());
    word.remove_prefix(word.starts_with('+') ? 1 : 0);
    double value = 0.0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool is_tiny = error == std::errc::result_out_of_range && std::abs(value) < 1.0;
    if ((error != std::errc() && !is_tiny) || stop != word.data() + word.size() || !std::isfinite(value)) {
      throw std::runtime_error(fmt::format(
          "line {}: '{}' has values that are not finite numbers", line_,
          begin_of_line_.substr(0, std::min<std::size_t>(begin_of_line_.find_first_of("\r\n"), 60))));
    }
    return value;
  }

 private:
  static bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  std::string_view begin_of_line_, rest_;
  std::size_t line_;
};

std::uint32_t index_of(double value) {
  constexpr double beyond = std::numeric_limits<std::uint32_t>::max();
  return value >= 0.0 && value < beyond ? static_cast<std::uint32_t>(value)
                                        : std::numeric_limits<std::uint32_t>::max();  // refused with its mesh
}

void add_fan(const std::vector<double>& corners, RawPart& part) {
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    part.indices.insert(part.indices.end(),
                        {index_of(corners[0]), index_of(corners[i]), index_of(corners[i + 1])});
  }
}

template <class Values>
class PlyBody {
 public:
  PlyBody(const PlyHeader& header, Values values) : header_(header), values_(std::move(values)) {}

  RawPart read() {
    for (const Element& element : header_.elements) {
      if (element.properties.empty()) {
        continue;
      }
      const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
      for (std::uint64_t i = 0; i < element.count; ++i) {
        scalars_.assign(element.properties.size(), 0.0);
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
          if (!read(element.properties[p], scalars_[p])) {
            throw std::runtime_error(
                fmt::format("the file is cut short: its header declares {} of element {}, there "
                            "are {}",
                            element.count, element.name, i));
          }
          if (is_face && is_corners(element.properties[p])) {
            add_fan(list_, part_);
          }
        }
        if (is_vertex) {
          add_vertex(element);
        }
      }
    }
    return std::move(part_);
  }

 private:
  static bool is_corners(const Property& property) {
    return property.count_type != nullptr &&
           (property.name == "vertex_indices" || property.name == "vertex_index");
  }

  /// @return false at the end of the file
  bool read(const Property& property, double& scalar) {
    if (property.count_type == nullptr) {
      const std::optional<double> value = values_.next(*property.type);
      scalar = value.value_or(0.0);
      return value.has_value();
    }
    list_.clear();
    const std::optional<double> count = values_.next(*property.count_type);
    if (!count || !(*count <= static_cast<double>(values_.most_values(*property.type)))) {
      return false;
    }
    for (double i = 0.0; i < *count; ++i) {
      const std::optional<double> value = values_.next(*property.type);
      if (!value) {
        return false;
      }
      list_.push_back(*value);
    }
    return true;
  }

  /// nullptr if the vertices have no such property.
  const double* value(const Element& element, std::string_view name) const {
    const auto found = std::ranges::find(element.properties, name, &Property::name);
    return found == element.properties.end()
               ? nullptr
               : &scalars_[static_cast<std::size_t>(found - element.properties.begin())];
  }

  void add_vertex(const Element& element) {
    const double *x = value(element, "x"), *y = value(element, "y"), *z = value(element, "z");
    if (x == nullptr || y == nullptr || z == nullptr) {
      throw std::runtime_error("its element vertex lacks a property x, y or z");
    }
    part_.positions.emplace_back(*x, *y, *z);
    const double *nx = value(element, "nx"), *ny = value(element, "ny"), *nz = value(element, "nz");
    if (nx != nullptr && ny != nullptr && nz != nullptr) {
      part_.normals.emplace_back(*nx, *ny, *nz);
    }
    for (const auto& [u_name, v_name] : texture_names) {
      const double *u = value(element, u_name), *v = value(element, v_name);
      if (u != nullptr && v != nullptr) {
        part_.texcoords.emplace_back(*u, *v);
        break;
      }
    }
  }

  const PlyHeader& header_;
  Values values_;
  RawPart part_;
  std::vector<double> scalars_, list_;  ///< of the current instance
};

}  // namespace

RawMesh read_ply(const MeshSource& source) {
  const std::string bytes = content_of(source.file);
  const PlyHeader header = header_of(bytes);
  const std::string_view body = std::string_view(bytes).substr(header.bytes);
  const RawPart part =
      header.encoding == Encoding::text
          ? PlyBody(header, TextValues(body, header.lines)).read()
          : PlyBody(header, BinaryValues(body, header.encoding == Encoding::big_endian)).read();
  RawMesh mesh;
  if (source.submesh.empty()) {
    mesh.add(part, glm::dmat4(1.0));
  }
  return mesh;
}

}  // namespace sonard::render
