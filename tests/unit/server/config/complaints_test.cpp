// SPDX-License-Identifier: Apache-2.0
// What the loader says about configurations: the cases of complaints.txt.
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "tests/support/pattern.hpp"
#include "tests/unit/server/config/config_text.hpp"

namespace sonard::server {
namespace {

struct ComplaintCase {
  std::string name;
  std::string text;                     ///< the configuration
  std::vector<std::string> complaints;  ///< patterns
};

void PrintTo(const ComplaintCase& one, std::ostream* out) {
  *out << one.text;
}

/// Adds one line of complaints.txt, whose head explains it.
void add_line(ComplaintCase& one, const std::string& line) {
  const std::string rest = line.size() > 2 ? line.substr(2) : "";
  if (line[0] == '!') {
    if (rest != "nothing") {
      one.complaints.push_back(rest);
    }
    return;
  }
  if (line[0] != '|' && one.text.empty()) {
    one.text = minimal_config;
  }
  if (line[0] == '~') {
    const std::size_t arrow = rest.find(" -> ");
    one.text.replace(one.text.find(rest.substr(0, arrow)), arrow, rest.substr(arrow + 4));
  } else if (rest == "<minimal>") {
    one.text += minimal_config;
  } else if (rest == "<heads>") {
    one.text += minimal_config.substr(minimal_config.find("heads:"));
  } else if (line[0] == '+' || line[0] == '|') {
    one.text += rest + "\n";
  } else {
    throw std::runtime_error{"complaints.txt: " + line};
  }
}

std::vector<ComplaintCase> complaint_cases() {
  std::ifstream file{SONARD_SOURCE_DIR "/tests/unit/server/config/complaints.txt"};
  std::vector<ComplaintCase> cases;
  std::string group;
  std::map<std::string, int> counts;
  bool in_case = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('[')) {
      group = line.substr(1, line.size() - 2);
    } else if (!line.starts_with('#')) {
      if (!line.empty() && !in_case) {
        cases.push_back({fmt::format("{}_{}", group, ++counts[group]), "", {}});
      }
      in_case = !line.empty();
      if (in_case) {
        add_line(cases.back(), line);
      }
    }
  }
  if (cases.empty()) {
    throw std::runtime_error{"complaints.txt has no case"};
  }
  return cases;
}

class Complaints : public ConfigFolder, public testing::WithParamInterface<ComplaintCase> {};

TEST_P(Complaints, AreThoseOfTheFile) {
  const std::vector<std::string> lines = complaints(GetParam().text);
  const std::vector<std::string>& patterns = GetParam().complaints;
  ASSERT_EQ(lines.size(), patterns.size()) << fmt::format("{}", fmt::join(lines, "\n"));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_TRUE(test::matches(lines[i], patterns[i])) << lines[i] << "\nis not\n" << patterns[i];
  }
}

INSTANTIATE_TEST_SUITE_P(all, Complaints, testing::ValuesIn(complaint_cases()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace sonard::server
