// SPDX-License-Identifier: Apache-2.0
#include "server/yaml/config_error.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>

namespace sonard::server {
namespace {

constexpr std::size_t longest_key_shown = 300;  // of what is shown

std::vector<ConfigProblem> in_file_order(std::vector<ConfigProblem> problems) {
  std::stable_sort(problems.begin(), problems.end(), [](const ConfigProblem& a, const ConfigProblem& b) {
    return std::tie(a.at.line, a.at.column) < std::tie(b.at.line, b.at.column);
  });
  return problems;
}

ErrorKind kind_of(const std::vector<ConfigProblem>& problems) {
  return std::ranges::all_of(problems, &ConfigProblem::of_network) ? ErrorKind::network
                                                                   : ErrorKind::configuration;
}

}  // namespace

SourcePosition nearest_position(const KeyPositions& positions, std::string_view key) {
  while (!key.empty()) {
    if (const auto found = positions.find(key); found != positions.end()) {
      return found->second;
    }
    const std::size_t cut = key.find_last_of(".[");
    key = key.substr(0, cut == std::string_view::npos ? 0 : cut);
  }
  return {};
}

std::string problem_text(const std::filesystem::path& file, const ConfigProblem& problem) {
  std::string text = file.string();
  if (problem.at.line > 0) {
    text += ':' + std::to_string(problem.at.line) + ':' + std::to_string(problem.at.column);
  }
  if (!problem.key.empty()) {
    text += ": " + (problem.key.size() > longest_key_shown ? problem.key.substr(0, longest_key_shown) + "..."
                                                           : problem.key);
  }
  return text + ": " + problem.message;
}

std::vector<std::string> problem_lines(const std::filesystem::path& file,
                                       const std::vector<ConfigProblem>& problems) {
  std::vector<std::string> lines;
  std::ranges::transform(problems, std::back_inserter(lines),
                         [&](const ConfigProblem& problem) { return problem_text(file, problem); });
  return lines;
}

ConfigError::ConfigError(const std::filesystem::path& file, std::vector<ConfigProblem> problems)
    : Error(kind_of(problems), problem_text(file, in_file_order(problems).front())),
      problems_(in_file_order(std::move(problems))) {
  more = problem_lines(file, problems_);
  more.erase(more.begin());
}

}  // namespace sonard::server
