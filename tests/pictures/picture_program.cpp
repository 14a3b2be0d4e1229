// SPDX-License-Identifier: Apache-2.0
#include "tests/pictures/picture_program.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <map>

namespace sonard::pictures {

int run_picture_program(const PictureProgram& program, int argc, const char* const* argv) {
  std::vector<std::string> names = program.names;
  std::string folder = program.folder;
  std::string engine = "cpu";
  int radius_px = 380;
  CLI::App app(program.description, program.name);
  app.add_option("names", names, "Pictures; all of them when none is named")
      ->check(CLI::IsMember(program.names));
  app.add_option("--out", folder, "Folder for the pictures")->capture_default_str();
  app.add_option("--engine", engine, "Of the renderer")
      ->check(CLI::IsMember({"cpu", "gpu"}))
      ->capture_default_str();
  app.add_option("--radius", radius_px, "Pixels from the sonar to the full range")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    draw_halves(program.halves(names), folder,
                engine == "gpu" ? render::EngineKind::gpu : render::EngineKind::cpu, radius_px);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", program.name, error.what());
    return 1;
  }
  return 0;
}

}  // namespace sonard::pictures
