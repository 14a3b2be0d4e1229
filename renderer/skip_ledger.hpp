// SPDX-License-Identifier: Apache-2.0
// Named rules for work that the renderer leaves out, and why the image allows it. Rules can be switched off,
// and they count what they save (docs/skipping.md).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace sonard::render {

enum class SkipRule : std::uint8_t {
  nobody_listening,
  unchanged_scene,
  unchanged_settings,
  culled_clusters,
  hidden_faces,
  empty_beams,
  geometric_normals,
  absent_normal_map,
  coplanar_facets,
  flat_elevation,
  facet_kernel,
  multipath,
  bounces,
  bins_without_echo,
  blanked_near_field,
  no_noise,
  unmoved_speckle,
  narrow_aperture,
  long_bins,
  many_scatterers,
  ring_down_over,
  no_interference,
  separate_beams,
  even_bins,
  perfect_elements,
  short_pulse,
  motion_within_ping,
  straight_rays,
  terrain_detail,
};

/// One line of the ledger. `bound` is the largest difference between a ping with the rule on and the same
/// ping with the rule off.
struct SkipRuleEntry {
  SkipRule rule;
  std::string_view name;  ///< as in the key `skip.off` of a configuration
  std::string_view criterion;
  std::string_view counts;  ///< unit of the counter; "bins": range bins
  double bound;
  std::string_view bound_unit = "of the image's maximum";
};

/// In the order of SkipRule.
inline constexpr std::array skip_rules{
    SkipRuleEntry{SkipRule::nobody_listening, "nobody_listening",
                  "the ping was cancelled before its turn to be rendered: client gone, reboot, new settings",
                  "pings", 0},
    SkipRuleEntry{
        SkipRule::unchanged_scene, "unchanged_scene",
        "sonar, bodies and all settings that affect the echo are unchanged since the head's last ping",
        "pings", 0},
    SkipRuleEntry{SkipRule::unchanged_settings, "unchanged_settings",
                  "the settings of a table are unchanged since it was last made", "tables", 0},
    SkipRuleEntry{SkipRule::culled_clusters, "culled_clusters",
                  "the bounding sphere is beyond the range, the azimuths or the elevations of the fan",
                  "clusters", 1e-3},
    SkipRuleEntry{
        SkipRule::hidden_faces, "hidden_faces",
        "the face turns its inner side to the sonar, and the sonar is outside of the box of its closed "
        "surface, or above its bed; rays are straight",
        "triangles", 2e-4, "of the image's maximum, with preset `reference`"},
    SkipRuleEntry{SkipRule::empty_beams, "empty_beams", "the beam contains no surface", "beams", 0},
    SkipRuleEntry{SkipRule::geometric_normals, "geometric_normals",
                  "the part has no vertex normals, or all are within 1e-4 rad of their facet's", "parts",
                  1e-4},
    SkipRuleEntry{SkipRule::absent_normal_map, "absent_normal_map", "the part has no normal map", "parts",
                  1e-4},
    SkipRuleEntry{SkipRule::coplanar_facets, "coplanar_facets",
                  "facets echo like flat ones and lie in one plane, within 1e-4 rad and 0.02 mm", "facets",
                  1e-2},
    SkipRuleEntry{SkipRule::flat_elevation, "flat_elevation", "the elevation pattern is `top_hat`", "pings",
                  1e-6},
    SkipRuleEntry{
        SkipRule::facet_kernel, "facet_kernel",
        "the material has no facets, or they echo less than 0.1 % of its Lambert part at that incidence",
        "segments", 2e-3},
    SkipRuleEntry{SkipRule::multipath, "multipath",
                  "no surface in range mirrors more than -15 dB, R^2 exp(-P^2), at its least grazing angle",
                  "pings", 0.13, "of the echo of the mirrored objects"},
    SkipRuleEntry{SkipRule::bounces, "bounces",
                  "no surface in range sends on more than -15 dB, R^2 + pi mu, of the incident sound",
                  "pings", 0.032, "of the incident sound"},
    SkipRuleEntry{
        SkipRule::bins_without_echo, "bins_without_echo",
        "no beam has an echo in the bin: it is before the first echo, between echoes or beyond the last",
        "bins", 1, "output code"},
    SkipRuleEntry{SkipRule::blanked_near_field, "blanked_near_field",
                  "the bin is nearer than `near_field_blank_m`: the device outputs 0 there", "bins", 0,
                  "output codes"},
    SkipRuleEntry{SkipRule::no_noise, "no_noise", "`noise` is off: its amplitude is 0", "bins", 0,
                  "output codes"},
    SkipRuleEntry{SkipRule::unmoved_speckle, "unmoved_speckle",
                  "the sonar has not moved since the speckle of the bin was drawn", "bins", 0,
                  "output codes"},
    SkipRuleEntry{SkipRule::narrow_aperture, "narrow_aperture",
                  "beams do not share elements: one beam only, or beams no wider than their spacing", "rows",
                  0, "output codes"},
    SkipRuleEntry{SkipRule::long_bins, "long_bins", "no two bins lie within one pulse", "rows", 0,
                  "output codes"},
    SkipRuleEntry{
        SkipRule::many_scatterers, "many_scatterers",
        "more than 20 scatterers in a cell: intensities vary by less than a tenth more than speckle's",
        "bins", 0.1, "of the scintillation index"},
    SkipRuleEntry{SkipRule::ring_down_over, "ring_down_over",
                  "the bin lies beyond `ring_down.end_m`: the ring-down has fallen by 80 dB there", "bins",
                  1e-3, "of its highest output code"},
    SkipRuleEntry{SkipRule::no_interference, "no_interference",
                  "the ping has no burst of interference, or the bin lies outside it", "bins", 0,
                  "output codes"},
    SkipRuleEntry{
        SkipRule::separate_beams, "separate_beams",
        "no beam would receive from other beams, or lose to them, more than 1 % of the strongest echo",
        "pings", 1e-2},
    SkipRuleEntry{SkipRule::even_bins, "even_bins",
                  "per angle all beams receive the same from 32 neighbouring bins, within 1 %, or nothing",
                  "bins", 1e-2},
    SkipRuleEntry{SkipRule::perfect_elements, "perfect_elements",
                  "the elements of the array have no errors, so nothing leaks beyond the lobes", "pings", 0},
    SkipRuleEntry{SkipRule::short_pulse, "short_pulse",
                  "at most 0.5 % of an echo is received outside of its bin", "pings", 1e-2},
    SkipRuleEntry{SkipRule::motion_within_ping, "motion_within_ping",
                  "the sonar turns by at most half of a receive beam while it listens", "pings", 0.5,
                  "receive beamwidths of bearing"},
    SkipRuleEntry{SkipRule::straight_rays, "straight_rays",
                  "at the end of the range refraction bends rays by less than a quarter of the vertical beam",
                  "pings", 0.25, "vertical beamwidths of elevation"},
    SkipRuleEntry{SkipRule::terrain_detail, "terrain_detail",
                  "the tile is within 0.03 bins and 0.3 mm per metre of distance of the finer terrain",
                  "triangles", 0.1, "of the image's maximum, over ground rough at all lengths"},
};

inline constexpr std::size_t skip_rule_count = skip_rules.size();

constexpr const SkipRuleEntry& entry_of(SkipRule rule) {
  return skip_rules[static_cast<std::size_t>(rule)];
}

/// nullopt if no rule has that name.
constexpr std::optional<SkipRule> skip_rule_named(std::string_view name) {
  const auto* entry = std::find_if(skip_rules.begin(), skip_rules.end(),
                                   [name](const SkipRuleEntry& rule) { return rule.name == name; });
  return entry == skip_rules.end() ? std::nullopt : std::optional(entry->rule);
}

/// The rules that apply; by default all.
class SkipSwitches {
 public:
  constexpr bool on(SkipRule rule) const { return (off_ >> static_cast<unsigned>(rule) & 1U) == 0; }
  constexpr SkipSwitches& turn_off(SkipRule rule) {
    off_ |= std::uint64_t{1} << static_cast<unsigned>(rule);
    return *this;
  }
  /// All rules off: every image is computed in full.
  static constexpr SkipSwitches none() {
    SkipSwitches switches;
    switches.off_ = (std::uint64_t{1} << skip_rule_count) - 1;
    return switches;
  }

  constexpr bool operator==(const SkipSwitches&) const = default;

 private:
  static_assert(skip_rule_count < 64);
  std::uint64_t off_ = 0;
};

/// How often each rule skipped something, in units of SkipRuleEntry::counts. Each thread has its own counts,
/// which are added up later.
class SkipCounts {
 public:
  constexpr void add(SkipRule rule, std::uint64_t count = 1) {
    counts_[static_cast<std::size_t>(rule)] += count;
  }
  constexpr std::uint64_t of(SkipRule rule) const { return counts_[static_cast<std::size_t>(rule)]; }
  constexpr SkipCounts& operator+=(const SkipCounts& other) {
    for (std::size_t i = 0; i < skip_rule_count; ++i) {
      counts_[i] += other.counts_[i];
    }
    return *this;
  }
  /// The counts since `before`.
  constexpr SkipCounts operator-(const SkipCounts& before) const {
    SkipCounts since;
    for (std::size_t i = 0; i < skip_rule_count; ++i) {
      since.counts_[i] = counts_[i] - before.counts_[i];
    }
    return since;
  }

  constexpr bool operator==(const SkipCounts&) const = default;

 private:
  std::array<std::uint64_t, skip_rule_count> counts_{};
};

static_assert(std::all_of(skip_rules.begin(), skip_rules.end(), [](const SkipRuleEntry& entry) {
  return &entry == &skip_rules[static_cast<std::size_t>(entry.rule)];
}));

}  // namespace sonard::render
