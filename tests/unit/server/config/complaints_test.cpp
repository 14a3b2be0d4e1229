// SPDX-License-Identifier: Apache-2.0
// What the loader says about configurations: the cases of complaints.txt here and in the folders of devices.
#include <filesystem>
#include <fstream>
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
  std::string text;                   ///< the configuration
  std::vector<std::string> patterns;  ///< of its complaints or warnings
  bool is_valid = false;
};

void PrintTo(const ComplaintCase& one, std::ostream* out) {
  *out << one.text;
}

/// Adds one line of complaints.txt, whose head explains it.
void add_line(ComplaintCase& one, const std::string& line) {
  const std::string rest = line.size() > 2 ? line.substr(2) : "";
  if (line[0] == '!' || line[0] == '?') {
    one.is_valid = line[0] == '?';
    if (rest != "nothing") {
      one.patterns.push_back(rest);
    }
    return;
  }
  if (line[0] != '|' && one.text.empty()) {
    const std::size_t first_head = minimal_config.find("  - ");
    one.text = minimal_config.substr(0, line[0] == '-' ? first_head : std::string::npos);
  }
  if (line[0] == '-') {
    one.text += "  - " + rest + "\n";
  } else if (line[0] == '~') {
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

void add_cases(std::vector<ComplaintCase>& cases, const std::filesystem::path& path) {
  std::ifstream file{path};
  std::string group;
  int number = 0;
  bool in_case = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('[')) {
      group = line.substr(1, line.size() - 2);
      number = 0;
    } else if (!line.starts_with('#')) {
      if (!line.empty() && !in_case) {
        cases.push_back({fmt::format("{}_{}", group, ++number), "", {}, false});
      }
      in_case = !line.empty();
      if (in_case) {
        add_line(cases.back(), line);
      }
    }
  }
}

/// The cases of this folder and of the devices.
std::vector<ComplaintCase> complaint_cases() {
  const std::filesystem::path folder{SONARD_SOURCE_DIR "/tests/unit/server"};
  std::vector<ComplaintCase> cases;
  add_cases(cases, folder / "config/complaints.txt");
  for (const auto& device : std::filesystem::directory_iterator(folder / "devices")) {
    add_cases(cases, device.path() / "complaints.txt");
  }
  return cases;
}

TEST(ComplaintCases, AreFound) {
  EXPECT_GT(complaint_cases().size(), 180U);
}

class Complaints : public ConfigFolder, public testing::WithParamInterface<ComplaintCase> {};

TEST_P(Complaints, AreThoseOfTheTable) {
  const auto& [name, text, patterns, is_valid] = GetParam();
  const std::vector<std::string> lines = is_valid ? warnings(text) : complaints(text);
  ASSERT_EQ(lines.size(), patterns.size()) << fmt::format("{}", fmt::join(lines, "\n"));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::string pattern = patterns[i];
    if (const std::size_t at = pattern.find("<folder>"); at != std::string::npos) {
      pattern.replace(at, 8, folder_.string());
    }
    EXPECT_TRUE(test::matches(lines[i], pattern)) << lines[i] << "\nis not\n" << pattern;
  }
}

INSTANTIATE_TEST_SUITE_P(all, Complaints, testing::ValuesIn(complaint_cases()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace sonard::server
