// SPDX-License-Identifier: Apache-2.0
// The ledger itself: its table, its switches, and equal rules in configuration and documentation.
#include "renderer/skip_ledger.hpp"

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/config/config_text.hpp"

namespace sonard {
namespace {

using render::SkipCounts;
using render::SkipRule;
using render::SkipSwitches;

const std::string source_folder = SONARD_SOURCE_DIR;

std::set<std::string> rule_names() {
  std::set<std::string> names;
  for (const render::SkipRuleEntry& entry : render::skip_rules) {
    names.emplace(entry.name);
  }
  return names;
}

TEST(SkipLedger, EveryRuleHasItsOwnNameAndIsFoundByIt) {
  EXPECT_EQ(rule_names().size(), render::skip_rule_count);
  for (const render::SkipRuleEntry& entry : render::skip_rules) {
    EXPECT_EQ(render::skip_rule_named(entry.name), entry.rule);
    EXPECT_GE(entry.bound, 0);
    EXPECT_LE(entry.bound, entry.bound_unit == "of the image's maximum" ? 1e-2 : 1.0) << entry.name;
    EXPECT_FALSE(entry.criterion.empty());
  }
  EXPECT_EQ(render::skip_rule_named("unchanged scene"), std::nullopt);
}

TEST(SkipLedger, SwitchesTurnOffOneRuleAtATime) {
  SkipSwitches switches;
  switches.turn_off(SkipRule::no_noise).turn_off(SkipRule::narrow_aperture);
  for (const render::SkipRuleEntry& entry : render::skip_rules) {
    EXPECT_TRUE(SkipSwitches{}.on(entry.rule));
    EXPECT_FALSE(SkipSwitches::none().on(entry.rule));
    EXPECT_EQ(switches.on(entry.rule),
              entry.rule != SkipRule::no_noise && entry.rule != SkipRule::narrow_aperture);
  }
}

TEST(SkipLedger, CountsAddUpRuleByRule) {
  SkipCounts first;
  first.add(SkipRule::empty_beams, 5);
  SkipCounts all = first;
  SkipCounts second;
  second.add(SkipRule::empty_beams);
  second.add(SkipRule::no_noise, 2);
  all += second;
  EXPECT_EQ(all.of(SkipRule::empty_beams), 6u);
  EXPECT_EQ(all.of(SkipRule::no_noise), 2u);
  EXPECT_EQ(all.of(SkipRule::unchanged_scene), 0u);
  EXPECT_EQ(all - first, second);
}

// docs/skipping.md: | `rule` | criterion | bound | ... |
TEST(SkipLedger, DocumentationListsTheSameRulesWithTheSameCriteriaAndBounds) {
  std::ifstream page(source_folder + "/docs/skipping.md");
  ASSERT_TRUE(page);
  const std::regex row(R"(\| `([a-z_]+)` \| ([^|]+) \| ([^|]+) \|.*)");
  std::set<std::string> documented;
  for (std::string line; std::getline(page, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, row)) {
      continue;
    }
    const auto rule = render::skip_rule_named(match.str(1));
    ASSERT_TRUE(rule) << match.str(1);
    EXPECT_TRUE(documented.insert(match.str(1)).second) << match.str(1);
    EXPECT_EQ(match.str(2), render::entry_of(*rule).criterion);
    EXPECT_EQ(std::stod(match.str(3)), render::entry_of(*rule).bound) << match.str(1);
    EXPECT_THAT(match.str(3), testing::HasSubstr(std::string(render::entry_of(*rule).bound_unit)));
  }
  EXPECT_EQ(documented, rule_names());
}

using SkipSection = server::ConfigFolder;

TEST_F(SkipSection, EveryRuleIsOnUnlessItIsListed) {
  EXPECT_EQ(load(server::minimal_config).config.skip, SkipSwitches{});
  const SkipSwitches skip =
      load(server::minimal_config + "skip: {off: [unchanged_scene, empty_beams]}\n").config.skip;
  EXPECT_EQ(skip, SkipSwitches{}.turn_off(SkipRule::unchanged_scene).turn_off(SkipRule::empty_beams));
}

TEST_F(SkipSection, FormerNamesAreReadWithAWarning) {
  const auto loaded = load(server::minimal_config + "skip: {off: [empty_beams, even_lines]}\n");
  EXPECT_EQ(loaded.config.skip, SkipSwitches{}.turn_off(SkipRule::empty_beams).turn_off(SkipRule::even_bins));
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_EQ(loaded.warnings[0].message, "has 'even_lines', which is a former name; write 'even_bins'");
}

TEST_F(SkipSection, UnknownRuleIsReportedWithItsPlace) {
  const auto said = complaints(server::minimal_config + "skip:\n  off: [empty_beams, full_beams]\n");
  ASSERT_EQ(said.size(), 1u);
  EXPECT_THAT(said[0], testing::StartsWith("config.yaml:12:22: skip.off[1]: is 'full_beams' (expected one of "
                                           "nobody_listening, unchanged_scene, "));
}

}  // namespace
}  // namespace sonard
