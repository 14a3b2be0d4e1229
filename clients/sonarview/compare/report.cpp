// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/compare/report.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include "clients/sonarview/compare/frame.hpp"

namespace sonard::client {
namespace {

struct Row {
  const char* name;  ///< in the table
  const char* key;   ///< in JSON
  const char* unit;  ///< of the value; empty: dimensionless
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

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{:.4f}", *value) : "-";
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
    table += fmt::format("{:<14}{:>12} {:<3}{:>10}{:>11}\n", row.name, number(row.value), row.unit,
                         number(row.score), row.identical);
  }
  return table;
}

std::string json_of(const Similarity& similarity, const CompareOptions& options, int width, int height) {
  using Json = nlohmann::ordered_json;
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(); };
  Json measures = Json::array();
  for (const Row& row : rows_of(similarity)) {
    measures.push_back({{"name", row.key},
                        {"value", number(row.value)},
                        {"unit", row.unit},
                        {"score", number(row.score)},
                        {"identical", row.identical}});
  }
  const Json json{
      {"a", options.a}, {"b", options.b}, {"width", width}, {"height", height}, {"measures", measures}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

ExitStatus compare(const CompareOptions& options) {
  const cv::Mat a = load_frame(options.a);
  const cv::Mat b = load_frame(options.b);
  if (a.size() != b.size()) {
    throw std::runtime_error(
        fmt::format("{} is {} x {}, {} is {} x {}: only images of equal size can be compared", options.a,
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
