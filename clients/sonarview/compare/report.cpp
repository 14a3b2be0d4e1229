// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/compare/report.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <vector>

#include "clients/sonarview/compare/frame.hpp"

namespace sonard::client {
namespace {

struct Row {
  const char* name;  ///< in the table
  const char* key;   ///< in JSON
  const char* unit;  ///< of the value; empty: none
  int identical;     ///< score of identical images
  std::optional<double> value;
  std::optional<double> score;
};

std::vector<Row> rows_of(const Similarity& similarity) {
  return {
      {"MSE", "mse", "", 0, similarity.mse, similarity.mse_score()},
      {"PSNR", "psnr", "dB", 1, similarity.psnr_db, similarity.psnr_score()},
      {"SSIM", "ssim", "", 1, similarity.ssim, similarity.ssim_score()},
      {"MS-SSIM", "ms_ssim", "", 1, similarity.ms_ssim, similarity.ms_ssim},
      {"SIFT distance", "sift_distance", "", 0, similarity.sift_distance, similarity.sift_distance},
  };
}

std::string number(const std::optional<double>& value, int digits, const char* otherwise) {
  return value ? fmt::format("{:.{}f}", *value, digits) : otherwise;
}

std::string quoted(const std::string& text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      json += '\\';
      json += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      json += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    } else {
      json += c;
    }
  }
  return json + '"';
}

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  if (!out.flush()) {
    throw std::runtime_error(fmt::format("cannot write {}", file.string()));
  }
}

}  // namespace

std::string table_of(const Similarity& similarity) {
  std::string table =
      fmt::format("{:<14}{:>12} {:<3}{:>10}{:>11}\n", "measure", "value", "", "score", "identical");
  for (const Row& row : rows_of(similarity)) {
    table += fmt::format("{:<14}{:>12} {:<3}{:>10}{:>11}\n", row.name, number(row.value, 4, "-"), row.unit,
                         number(row.score, 4, "-"), row.identical);
  }
  return table;
}

std::string json_of(const Similarity& similarity, const CompareOptions& options, int width, int height) {
  std::string json = fmt::format("{{\"a\": {}, \"b\": {}, \"width\": {}, \"height\": {}, \"measures\": [",
                                 quoted(options.a), quoted(options.b), width, height);
  const char* separator = "\n";
  for (const Row& row : rows_of(similarity)) {
    json += fmt::format(
        "{}  {{\"name\": \"{}\", \"value\": {}, \"unit\": \"{}\", \"score\": {}, \"identical\": {}}}",
        separator, row.key, number(row.value, 9, "null"), row.unit, number(row.score, 9, "null"),
        row.identical);
    separator = ",\n";
  }
  return json + "\n]}\n";
}

ExitStatus compare(const CompareOptions& options) {
  const cv::Mat a = load_frame(options.a);
  const cv::Mat b = load_frame(options.b);
  if (a.size() != b.size()) {
    throw std::runtime_error(
        fmt::format("{} is {} x {}, {} is {} x {}: only images of one size can be compared", options.a,
                    a.cols, a.rows, options.b, b.cols, b.rows));
  }
  const Similarity similarity = compare_images(a, b);
  fmt::print("{}", table_of(similarity));
  if (!options.json.empty()) {
    write(options.json, json_of(similarity, options, a.cols, a.rows));
  }
  return ExitStatus::ok;
}

}  // namespace sonard::client
