// SPDX-License-Identifier: Apache-2.0
// realism: prints the table of docs/acoustics.md and the number of rows out of tolerance.
#include <algorithm>
#include <array>
#include <iostream>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "tests/realism/rows.hpp"

namespace {

/// @return whether the row is within its tolerance
bool print(const sonard::realism::Row& row) {
  const double ours = row.measure();
  const bool within = ours >= row.least && ours <= row.most;
  const std::string unit = row.unit.empty() ? "" : fmt::format(" {}", row.unit);
  std::cout << fmt::format("| {} | {} | {}{} | {:.3g}{} | {:.3g} to {:.3g} | {} |\n", row.head, row.what,
                           row.recorded, unit, ours, unit, row.least, row.most, within ? "yes" : "**no**")
            << std::flush;
  return within;
}

/// @return whether all four values are within their tolerances
bool print(const sonard::realism::PatchRow& row) {
  using namespace sonard::realism;
  const std::array variation = row.variation();
  const std::array index = row.index();
  const auto within = [](const std::array<double, 2>& values, double least, double most) {
    return std::ranges::all_of(values, [=](double value) { return value >= least && value <= most; });
  };
  const bool good =
      within(variation, least_variation, most_variation) && within(index, least_index, most_index);
  std::cout << fmt::format("| {} | {} | {:.3g} / {:.3g} | {:.3g} / {:.3g} | {} |\n", row.head, row.what,
                           variation[0], variation[1], index[0], index[1], good ? "yes" : "**no**")
            << std::flush;
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Measures images as a client has them, and compares with what recordings show.", "realism"};
  std::string only;
  app.add_option("--only", only, "Measure only the rows whose text contains this");
  CLI11_PARSE(app, argc, argv);
  std::cout << "| head | what | recorded | ours | tolerance | within |\n|---|---|---|---|---|---|\n";
  int out = 0;
  for (const auto& rows : {sonard::realism::gemini_noise_rows(), sonard::realism::gemini_scene_rows(),
                           sonard::realism::micron_rows()}) {
    for (const sonard::realism::Row& row : rows) {
      const bool wanted = only.empty() || row.what.find(only) != std::string::npos;
      out += !wanted || print(row) ? 0 : 1;
    }
  }
  std::cout << "\n| head | patches of | variation of the amplitude, middle / bright third | index of the "
               "intensity, middle / bright third | within |\n|---|---|---|---|---|\n";
  for (const sonard::realism::PatchRow& row : sonard::realism::patch_rows()) {
    const bool wanted = only.empty() || row.what.find(only) != std::string::npos;
    out += !wanted || print(row) ? 0 : 1;
  }
  return out;
}
