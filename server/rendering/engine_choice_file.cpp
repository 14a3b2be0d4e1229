// SPDX-License-Identifier: Apache-2.0
#include "server/rendering/engine_choice_file.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "renderer/usable_cores.hpp"

namespace sonard::server {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_choices = 64;
constexpr char separator = '\t';

struct Line {
  std::string situation;
  KeptChoice choice;
};

std::optional<Line> parse(const std::string& text) {
  const std::size_t first = text.find(separator);
  const std::size_t second = first == std::string::npos ? first : text.find(separator, first + 1);
  if (second == std::string::npos) {
    return std::nullopt;
  }
  Line line{text.substr(0, first), {}};
  line.choice.measured = text.substr(second + 1);
  const std::string taken = text.substr(first + 1, second - first - 1);
  for (const render::EngineKind kind : {render::EngineKind::cpu, render::EngineKind::gpu}) {
    if (taken == render::name_of(kind)) {
      line.choice.taken = kind;
      return line;
    }
  }
  return std::nullopt;
}

std::vector<Line> lines_of(const fs::path& file) {
  std::vector<Line> lines;
  std::ifstream stream(file);
  for (std::string text; std::getline(stream, text);) {
    if (auto line = parse(text)) {
      lines.push_back(std::move(*line));
    }
  }
  return lines;
}

/// Sorted names and modification times of a folder's entries; empty if the folder does not exist.
std::string listing(const char* folder, const std::string& start) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.compare(0, start.size(), start) == 0) {
      const auto changed =
          entry.is_regular_file(ignored) ? entry.last_write_time(ignored).time_since_epoch().count() : 0;
      names.push_back(fmt::format("{}@{}", name, changed));
    }
  }
  std::sort(names.begin(), names.end());
  return fmt::format("{}", fmt::join(names, ","));
}

std::string processor() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    if (line.compare(0, 10, "model name") == 0) {
      return line.substr(std::min(line.size(), line.find(':') + 1));
    }
  }
  return "";
}

std::string ping_size(const render::SonarSettings& settings) {
  return fmt::format(
      "{}x{} preset {} {}x{}x{} model {} fine {} azimuth {} bearing {} multipath {} facets {}",
      settings.aperture.beam_count(), settings.range.count, static_cast<int>(settings.sampling.preset),
      settings.sampling.views, settings.sampling.columns_per_view, settings.sampling.rows,
      static_cast<int>(settings.model), settings.aperture.fine_beams,
      static_cast<int>(settings.aperture.azimuth), static_cast<int>(settings.aperture.bearing),
      static_cast<int>(settings.physical.multipath.level), static_cast<int>(settings.physical.backscatter));
}

std::string on_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == separator || c == '\n' || c == '\r'; }, ' ');
  return text;
}

}  // namespace

std::optional<KeptChoice> EngineChoiceFile::find(const std::string& situation) const {
  for (Line& line : lines_of(file_)) {
    if (line.situation == situation) {
      return std::move(line.choice);
    }
  }
  return std::nullopt;
}

void EngineChoiceFile::keep(const std::string& situation, const KeptChoice& choice) const {
  if (file_.empty()) {
    return;
  }
  std::vector<Line> lines = lines_of(file_);
  std::erase_if(lines, [&](const Line& line) { return line.situation == situation; });
  lines.push_back({situation, choice});
  if (lines.size() > most_choices) {
    lines.erase(lines.begin(), lines.end() - most_choices);
  }
  std::error_code ignored;
  fs::create_directories(file_.parent_path(), ignored);
  // Other daemons must never see half a file.
  fs::path fresh = file_;
  fresh += fmt::format(".{}", ::getpid());
  std::ofstream stream(fresh, std::ios::trunc);
  for (const Line& line : lines) {
    stream << line.situation << separator << render::name_of(line.choice.taken) << separator
           << on_one_line(line.choice.measured) << '\n';
  }
  stream.close();
  if (stream.good()) {
    fs::rename(fresh, file_, ignored);
  } else {
    fs::remove(fresh, ignored);
  }
}

fs::path engine_choice_path() {
  // NOLINTBEGIN(concurrency-mt-unsafe): at start-up, nothing sets them
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache == '/') {
    return fs::path(cache) / "sonard/engine_choices";
  }
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') {
    return fs::path(home) / ".cache/sonard/engine_choices";
  }
  // NOLINTEND(concurrency-mt-unsafe)
  return {};
}

std::string situation_of(const render::RendererOptions& options, const render::World& world,
                         std::span<const render::HeadRequest> first_pings) {
  std::vector<std::string> pings;
  for (const render::HeadRequest& ping : first_pings) {
    pings.push_back(ping_size(ping.request.settings));
  }
  std::error_code ignored;
  return on_one_line(
      fmt::format("program of {}; {} cores of {}, {} threads; dri {}, nvidia {}, egl {}; device '{}' of {} "
                  "MiB; world {} of "
                  "{} triangles; {}",
                  fs::last_write_time("/proc/self/exe", ignored).time_since_epoch().count(),
                  render::usable_cores(), processor(), options.threads, listing("/dev/dri", ""),
                  listing("/dev", "nvidia"), listing("/usr/share/glvnd/egl_vendor.d", ""), options.gpu.device,
                  options.gpu.memory_mib, world.name, world.triangle_count(), fmt::join(pings, "; ")));
}

}  // namespace sonard::server
