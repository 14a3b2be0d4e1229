// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/local_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "renderer/scene/world.hpp"

namespace sonard::render {

bool lies_below(const std::filesystem::path& path, const std::filesystem::path& folder) {
  const auto differs = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first;
  return !folder.empty() && differs == folder.end();
}

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  if (!extension.empty()) {
    extension.erase(0, 1);
  }
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

ReaderJail reader_jail(const std::filesystem::path& file, std::vector<std::filesystem::path> readable) {
  constexpr std::uintmax_t base_s = 3;
  constexpr std::uintmax_t bytes_per_s = 1'000'000;
  constexpr std::uintmax_t longest_s = 3600;
  constexpr std::uint64_t memory_bytes_per_byte = 40;
  std::error_code error;
  const std::uintmax_t found = std::filesystem::file_size(file, error);
  const std::uintmax_t size = error ? 0 : found;
  ReaderJail jail;
  jail.readable = std::move(readable);
  jail.processor_limit_s = static_cast<unsigned int>(std::min(longest_s, base_s + size / bytes_per_s));
  jail.memory_limit_bytes += memory_bytes_per_byte * size;
  return jail;
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::string head_of(const std::filesystem::path& file, std::size_t limit) {
  std::ifstream in(file, std::ios::binary);
  std::string text(limit, '\0');
  in.read(text.data(), static_cast<std::streamsize>(limit));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

namespace {

std::string cannot_be_read(const std::filesystem::path& path, const std::error_code& why) {
  return fmt::format("{}: cannot be read: {} (expected a file that the user of sonard may read)",
                     path.string(), why.message());
}

}  // namespace

std::string trouble_reaching(const std::filesystem::path& path) {
  std::error_code why;
  if (std::filesystem::exists(path, why) ||
      (why != std::errc::permission_denied && why != std::errc::too_many_symbolic_link_levels)) {
    return {};
  }
  return cannot_be_read(path, why);
}

void require_reachable(const std::filesystem::path& path) {
  if (const std::string trouble = trouble_reaching(path); !trouble.empty()) {
    throw WorldError(trouble);
  }
}

void require_readable(const std::filesystem::path& file) {
  if (faccessat(AT_FDCWD, file.c_str(), R_OK, AT_EACCESS) != 0) {
    const std::error_code why(errno, std::generic_category());
    throw WorldError(cannot_be_read(file, why));
  }
}

void require_local_file(const std::filesystem::path& file, std::span<const std::string_view> extensions,
                        std::string_view what) {
  if (file.string().find("://") != std::string::npos) {
    throw WorldError(
        fmt::format("{}: {} must be a local file; sonard downloads nothing", file.string(), what));
  }
  std::error_code error;
  require_reachable(file);
  if (!file.is_absolute() || !std::filesystem::exists(file, error)) {
    throw WorldError(fmt::format("{}: {} file not found", file.string(), what));
  }
  if (!std::filesystem::is_regular_file(file, error)) {
    throw WorldError(fmt::format("{}: not a file", file.string()));
  }
  require_readable(file);
  const std::string extension = lower_extension(file);
  if (std::find(extensions.begin(), extensions.end(), extension) == extensions.end()) {
    throw WorldError(fmt::format("{}: '{}' is not a supported {} format; supported: {}", file.string(),
                                 extension, what, fmt::join(extensions, ", ")));
  }
}

}  // namespace sonard::render
