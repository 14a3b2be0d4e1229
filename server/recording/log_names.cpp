// SPDX-License-Identifier: Apache-2.0
#include "server/recording/log_names.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "protocol/glf/log_time.hpp"

namespace sonard::server {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view dat_prefix = "data_";

// Names of heads can be any text.
std::string plain(std::string_view head) {
  std::string name(head);
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '.'; }, '_');
  return name;
}

bool is_free(const fs::path& directory, const std::string& stem) {
  const std::array paths{mcap_path(directory, stem),  pcapng_path(directory, stem),
                         sonar_path(directory, stem), dat_path(directory, stem),
                         glf_path(directory, stem),   unfinished_glf_path(directory, stem)};
  std::error_code ignored;
  return std::ranges::none_of(paths, [&](const fs::path& path) { return fs::exists(path, ignored); });
}

}  // namespace

std::string free_stem(const fs::path& directory, double time_s, std::string_view head) {
  const std::string wanted = glf::log_stamp(time_s) + (head.empty() ? "" : "_" + plain(head));
  std::string stem = wanted;
  for (int number = 2; !is_free(directory, stem); ++number) {
    stem = wanted + "-" + std::to_string(number);
  }
  return stem;
}

fs::path mcap_path(const fs::path& directory, const std::string& stem) {
  return directory / ("log_" + stem + ".mcap");
}
fs::path pcapng_path(const fs::path& directory, const std::string& stem) {
  return directory / ("log_" + stem + ".pcapng");
}
fs::path sonar_path(const fs::path& directory, const std::string& stem) {
  return directory / ("log_" + stem + ".sonar");
}
fs::path dat_path(const fs::path& directory, const std::string& stem) {
  return directory / glf::dat_name(stem);
}
fs::path glf_path(const fs::path& directory, const std::string& stem) {
  return directory / glf::log_name(stem);
}
fs::path unfinished_glf_path(const fs::path& directory, const std::string& stem) {
  return directory / (glf::log_name(stem) + ".part");
}

std::string stem_of_dat(const fs::path& path) {
  const std::string name = path.stem().string();
  return path.extension() == ".dat" && name.starts_with(dat_prefix) ? name.substr(dat_prefix.size())
                                                                    : std::string();
}

}  // namespace sonard::server
