// SPDX-License-Identifier: Apache-2.0
#include "server/check_report.hpp"

#include <cstdio>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/text/counted.hpp"
#include "common/text/printable.hpp"

namespace sonard::server {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t area_width = 9;  // of a finding: "head     bow: ..."

Json problem_json(const std::filesystem::path& file, const ConfigProblem& problem) {
  const auto place = [](int number) { return number > 0 ? Json(number) : Json(nullptr); };
  return {{"file", file.string()},
          {"line", place(problem.at.line)},
          {"column", place(problem.at.column)},
          {"key", problem.key},
          {"message", problem.message}};
}

Json problems_json(const std::filesystem::path& file, const std::vector<ConfigProblem>& problems) {
  Json list = Json::array();
  for (const ConfigProblem& problem : problems) {
    list.push_back(problem_json(file, problem));
  }
  return list;
}

std::string trimmed(std::string_view text) {
  const std::size_t last = text.find_last_not_of(' ');
  return std::string(text.substr(0, last == std::string_view::npos ? 0 : last + 1));
}

/// A line that begins with blanks belongs to the area of the line before it.
Json findings_json(const std::vector<std::string>& summary) {
  Json list = Json::array();
  std::string area;
  for (const std::string_view line : summary) {
    const std::string begin = trimmed(line.substr(0, area_width));
    area = begin.empty() ? area : begin;
    list.push_back({{"area", area}, {"text", line.size() > area_width ? line.substr(area_width) : ""}});
  }
  return list;
}

std::string text_of(const Json& json) {
  return json.dump(2, ' ', /*ensure_ascii=*/true, Json::error_handler_t::replace);
}

}  // namespace

void print_report(const std::filesystem::path& file, const CheckReport& report) {
  for (const std::string& line : report.summary) {
    fmt::print("{}\n", printable(line));
  }
  for (const ConfigProblem& warning : report.warnings) {
    fmt::print(stderr, "warning: {}\n", printable(problem_text(file, warning)));
  }
  for (const ConfigProblem& problem : report.problems) {
    fmt::print(stderr, "{}\n", printable(problem_text(file, problem)));
  }
  if (report.problems.empty()) {
    const std::size_t warnings = report.warnings.size();
    fmt::print("{}: good{}\n", printable(file.string()),
               warnings == 0 ? "" : ", with " + counted(warnings, "warning"));
  } else {
    fmt::print("{}: {}\n", printable(file.string()), counted(report.problems.size(), "problem"));
  }
}

std::string report_json(const std::filesystem::path& file, const CheckReport& report) {
  Json costs = Json::object();
  for (const auto& [head, ms] : report.cost_ms) {
    costs[head] = ms;
  }
  return text_of({{"configuration", file.string()},
                  {"good", report.problems.empty()},
                  {"problems", problems_json(file, report.problems)},
                  {"warnings", problems_json(file, report.warnings)},
                  {"findings", findings_json(report.summary)},
                  {"cost_ms", std::move(costs)}});
}

std::string report_json(const std::filesystem::path& file, const ConfigError& error) {
  CheckReport report;
  report.problems = error.problems();
  return report_json(file, report);
}

}  // namespace sonard::server
