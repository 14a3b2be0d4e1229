// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/compare/subcommand.hpp"

#include <memory>

#include "clients/sonarview/compare/options.hpp"
#include "clients/sonarview/compare/report.hpp"

namespace sonard::client {
namespace {

constexpr const char* summary = "Compares two images by MSE, PSNR, SSIM, MS-SSIM and SIFT.";

constexpr const char* footer = R"(Examples:
  sonarview compare out/polar-last.png before/polar-last.png
  sonarview compare dump/bow.csv#12 dump/bow.csv#13 --json difference.json
  sonarview compare sweep.jsonl#0 sweep.jsonl#1

Exit status: 0 compared; 1 a file could not be read or written, or the sizes differ; 2 invalid command line.)";

Prepare declare(CLI::App& app) {
  const auto arguments = std::make_shared<CompareArguments>(app);
  return [arguments] { return [options = arguments->options()] { return compare(options); }; };
}

}  // namespace

const Subcommand& compare_subcommand() {
  static constexpr Subcommand subcommand{"compare", summary, footer, &declare};
  return subcommand;
}

}  // namespace sonard::client
