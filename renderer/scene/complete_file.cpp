// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/complete_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "renderer/scene/local_file.hpp"

namespace sonard::render {
namespace {

/// Bytes beyond the end of a header count as zeros.
std::uint64_t little_endian(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = at + size; i > at; --i) {
    value = value << 8U | (i - 1 < bytes.size() ? static_cast<unsigned char>(bytes[i - 1]) : 0U);
  }
  return value;
}

std::uint64_t big_endian(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = at; i < at + size; ++i) {
    value = value << 8U | (i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0U);
  }
  return value;
}

void require_bytes(std::string_view bytes, std::uint64_t promised, std::string_view what) {
  if (bytes.size() < promised) {
    throw std::runtime_error(fmt::format("the file is cut short: {} declares {} bytes, there are {}", what,
                                         promised, bytes.size()));
  }
}

[[noreturn]] void throw_without_end(std::string_view mark) {
  throw std::runtime_error(fmt::format("the file is cut short: it does not end with {}", mark));
}

/// ISO/IEC 15948: a signature of 8 bytes, then chunks of a length, a type, data and a checksum.
void check_png(std::string_view bytes) {
  for (std::uint64_t at = 8; at < bytes.size();) {
    const std::string_view type = bytes.substr(std::min<std::size_t>(at + 4, bytes.size()), 4);
    at += 12 + big_endian(bytes, at, 4);
    require_bytes(bytes, at, fmt::format("its chunk {}", type));
    if (type == "IEND") {
      return;
    }
  }
  throw_without_end("the chunk IEND");
}

/// ITU-T T.81: segments of a marker and a length until the first scan. In the scans, FF D9 is only the end.
void check_jpeg(std::string_view bytes) {
  constexpr std::uint64_t start_of_scan = 0xFFDA;
  std::size_t at = 2;
  while (at + 4 <= bytes.size() && big_endian(bytes, at, 2) != start_of_scan) {
    at += bytes[at + 1] == '\xFF' ? 1 : 2 + big_endian(bytes, at + 2, 2);
  }
  if (at >= bytes.size() || bytes.find("\xFF\xD9", at) == std::string_view::npos) {
    throw_without_end("the marker EOI");
  }
}

void check_bmp(std::string_view bytes) {
  constexpr std::uint64_t os2_header_bytes = 12, uncompressed = 0, bit_fields = 3;
  const std::uint64_t compression = little_endian(bytes, 30, 4);
  if (little_endian(bytes, 14, 4) == os2_header_bytes) {
    return;
  }
  if (compression != uncompressed && compression != bit_fields) {
    require_bytes(bytes, little_endian(bytes, 10, 4) + little_endian(bytes, 34, 4), "its header");
    return;
  }
  const std::uint64_t width_px = little_endian(bytes, 18, 4);
  const auto height_px = std::abs(std::int64_t{static_cast<std::int32_t>(little_endian(bytes, 22, 4))});
  const std::uint64_t row_bytes = (width_px * little_endian(bytes, 28, 2) + 31) / 32 * 4;
  require_bytes(bytes, little_endian(bytes, 10, 4) + row_bytes * static_cast<std::uint64_t>(height_px),
                "its header");
}

void check_tga(std::string_view bytes) {
  constexpr std::uint64_t run_lengths = 8;  // added to the image type
  const std::uint64_t type = little_endian(bytes, 2, 1);
  const std::uint64_t pixel_bytes = (little_endian(bytes, 16, 1) + 7) / 8;
  const std::uint64_t pixels = little_endian(bytes, 12, 2) * little_endian(bytes, 14, 2);
  const std::uint64_t colours_bytes =
      little_endian(bytes, 1, 1) == 1 ? little_endian(bytes, 5, 2) * ((little_endian(bytes, 7, 1) + 7) / 8)
                                      : 0;
  std::uint64_t at = 18 + little_endian(bytes, 0, 1) + colours_bytes;
  if (type < run_lengths) {
    require_bytes(bytes, at + pixels * pixel_bytes, "its header");
    return;
  }
  for (std::uint64_t done = 0; done < pixels;) {
    require_bytes(bytes, at + 1, fmt::format("its header, after {} of {} pixels,", done, pixels));
    const std::uint64_t packet = little_endian(bytes, at, 1);
    const std::uint64_t count = (packet & 127U) + 1;
    at += 1 + pixel_bytes * ((packet & 128U) != 0 ? 1 : count);
    require_bytes(bytes, at, fmt::format("its header, after {} of {} pixels,", done, pixels));
    done += count;
  }
}

/// The next word of a header, in which comments run from '#' to the end of the line.
std::string_view pnm_word(std::string_view bytes, std::size_t& at) {
  constexpr std::string_view blanks = " \t\r\n\v\f";
  at = std::min(bytes.find_first_not_of(blanks, at), bytes.size());
  while (at < bytes.size() && bytes[at] == '#') {
    at = std::min(bytes.find('\n', at), bytes.size());
    at = std::min(bytes.find_first_not_of(blanks, at), bytes.size());
  }
  const std::size_t begin = at;
  at = std::min(bytes.find_first_of(blanks, at), bytes.size());
  return bytes.substr(begin, at - begin);
}

void check_pnm(std::string_view bytes) {
  std::size_t at = 0;
  const std::string_view magic = pnm_word(bytes, at);
  const char kind = magic.size() == 2 && magic[0] == 'P' ? magic[1] : '0';
  const auto number = [&] { return std::strtoull(std::string(pnm_word(bytes, at)).c_str(), nullptr, 10); };
  const std::uint64_t width_px = number(), height_px = number();
  const bool is_bitmap = kind == '1' || kind == '4';
  const std::uint64_t brightest = is_bitmap ? 1 : number();
  const std::uint64_t samples = width_px * height_px * (kind == '3' || kind == '6' ? 3 : 1);
  if (kind >= '4') {  // binary; one blank ends the header
    const std::uint64_t size =
        is_bitmap ? (width_px + 7) / 8 * height_px : samples * (brightest > 255 ? 2 : 1);
    require_bytes(bytes, at + 1 + size, "its header");
    return;
  }
  std::uint64_t there = 0;
  if (is_bitmap) {
    const std::string_view bits = bytes.substr(at);
    there =
        static_cast<std::uint64_t>(std::ranges::count_if(bits, [](char c) { return c == '0' || c == '1'; }));
  } else {
    for (; there < samples && !pnm_word(bytes, at).empty(); ++there) {
    }
  }
  if (there < samples) {
    throw std::runtime_error(
        fmt::format("the file is cut short: its header declares {} values, there are {}", samples, there));
  }
}

/// glTF 2.0, 4.4: a header of 12 bytes with the length of the file, then chunks of a length, a type and data.
void check_glb(std::string_view bytes) {
  const std::uint64_t length = little_endian(bytes, 8, 4);
  require_bytes(bytes, length, "its header");
  const bool has_chunks = little_endian(bytes, 4, 4) >= 2;
  for (std::uint64_t at = 12; has_chunks && at < length;) {
    at += 8 + little_endian(bytes, at, 4);
    require_bytes(bytes.substr(0, length), at, "a chunk of it");
  }
}

void check_3ds(std::string_view bytes) {
  require_bytes(bytes, std::max<std::uint64_t>(6, little_endian(bytes, 2, 4)), "its main chunk");
}

void check_collada(std::string_view bytes) {
  constexpr std::size_t longest_tail = 65536;
  std::string tail(bytes.substr(bytes.size() - std::min(bytes.size(), longest_tail)));
  std::erase(tail, '\0');  // the second halves of UTF-16 characters in tags
  if (tail.find("COLLADA>", std::min(tail.rfind("</"), tail.size())) == std::string::npos) {
    throw_without_end("</COLLADA>");
  }
}

/// OpenSceneGraph's text format: braces around each object, names in quotes.
void check_osgt(std::string_view bytes) {
  int depth = 0;
  bool is_quoted = false;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    is_quoted = is_quoted != (bytes[i] == '"');
    i += is_quoted && bytes[i] == '\\' ? 1 : 0;
    depth += is_quoted ? 0 : static_cast<int>(bytes[i] == '{') - static_cast<int>(bytes[i] == '}');
  }
  if (depth > 0) {
    throw std::runtime_error(fmt::format("the file is cut short: {} of its braces are not closed", depth));
  }
}

/// Bytes that every file of a format begins with.
struct Magic {
  std::string_view extension, name, bytes;
};
constexpr std::array<Magic, 6> magics{{{"png", "PNG", "\x89PNG\r\n\x1A\n"},
                                       {"jpg", "JPEG", "\xFF\xD8"},
                                       {"jpeg", "JPEG", "\xFF\xD8"},
                                       {"bmp", "BMP", "BM"},
                                       {"glb", "GLB", "glTF"},
                                       {"3ds", "3DS", "MM"}}};
constexpr std::array<std::string_view, 5> text_formats{"obj", "stl", "ply", "gltf", "osgt"};

/// A download may leave something else under the name of a file.
/// @param begin of the file, as many bytes as its longest magic and the tags of a page take
void require_kind(std::string_view begin, std::string_view extension) {
  if (begin.starts_with("version https://git-lfs")) {
    throw std::runtime_error("it is a Git LFS pointer, not the file (fetch the file with `git lfs pull`)");
  }
  std::string text(begin.substr(std::min(begin.find_first_not_of(" \t\r\n\xEF\xBB\xBF"), begin.size()), 14));
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (text.starts_with("<!doctype html") || text.starts_with("<html")) {
    throw std::runtime_error("it is a web page, perhaps from a failed download");
  }
  if (std::ranges::find(text_formats, extension) != text_formats.end() &&
      (begin.starts_with("\xFF\xFE") || begin.starts_with("\xFE\xFF"))) {
    throw std::runtime_error("it is UTF-16 text (save it as UTF-8)");
  }
  const auto* const magic = std::ranges::find(magics, extension, &Magic::extension);
  if (magic != magics.end() && !begin.empty() && !begin.starts_with(magic->bytes.substr(0, begin.size()))) {
    throw std::runtime_error(fmt::format("it does not begin like a {} file", magic->name));
  }
}

struct Check {
  std::string_view extension;
  void (*check)(std::string_view bytes);
};

constexpr std::array<Check, 12> checks{{{"png", check_png},
                                        {"jpg", check_jpeg},
                                        {"jpeg", check_jpeg},
                                        {"bmp", check_bmp},
                                        {"tga", check_tga},
                                        {"pgm", check_pnm},
                                        {"ppm", check_pnm},
                                        {"pnm", check_pnm},
                                        {"glb", check_glb},
                                        {"3ds", check_3ds},
                                        {"dae", check_collada},
                                        {"osgt", check_osgt}}};

}  // namespace

void require_complete(const std::filesystem::path& file) {
  constexpr std::size_t begin_bytes = 64;
  const std::string extension = lower_extension(file);
  require_kind(head_of(file, begin_bytes), extension);
  const auto* const known = std::ranges::find(checks, extension, &Check::extension);
  if (known == checks.end()) {
    return;
  }
  known->check(content_of(file));
}

}  // namespace sonard::render
