// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/materials.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/text/edit_distance.hpp"

namespace sonard::render {
namespace {

struct TableRow {
  std::string_view name;
  double reflectance;
  double lambert_mu_db;
  double pressure_reflection;
  double rms_slope;
  double rms_height_mm;
};

/// R, mu, m and sigma: docs/physics.md 2.4 (typical values; 720 kHz is an extrapolation). rho: |R|, scaled so
/// that clean steel is the brightest example of the paper, 2.12. Two materials depend on the weather: `air`
/// is a surface at rest, and `sea_surface` one in 5 m/s of wind (slopes by Cox & Munk 1954, heights by
/// Pierson & Moskowitz 1964). `default` is an unknown material, so it has no facets.
constexpr std::array<TableRow, 14> table{{
    {"default", 1.00, -22.0, 0.0, 0.2, 2.0},
    {"steel", 2.12, -25.0, 0.94, 0.05, 0.1},
    {"steel_fouled", 2.03, -15.0, 0.90, 0.3, 2.0},
    {"aluminium", 1.89, -25.0, 0.84, 0.05, 0.1},
    {"concrete", 1.53, -18.0, 0.68, 0.2, 1.0},
    {"pvc", 0.81, -28.0, 0.36, 0.05, 0.1},
    {"rock", 1.87, -15.0, 0.83, 0.4, 10.0},
    {"gravel", 1.35, -15.0, 0.60, 0.4, 5.0},
    {"sand", 0.86, -22.0, 0.38, 0.2, 2.0},
    {"mud", 0.14, -32.0, 0.06, 0.1, 1.0},
    {"wood", 0.15, -28.0, 0.065, 0.2, 0.5},
    {"rubber", 0.20, -32.0, 0.09, 0.1, 0.3},
    {"air", 2.26, -20.0, -1.0, 0.05, 0.1},
    {"sea_surface", 2.26, -20.0, -1.0, 0.12, 130.0},
}};

constexpr std::array<std::pair<std::string_view, std::string_view>, 5> aliases{{
    {"aluminum", "aluminium"},
    {"steel_clean", "steel"},
    {"fouled_steel", "steel_fouled"},
    {"water_surface", "air"},
    {"stone", "rock"},
}};

constexpr double max_mu = std::numbers::inv_pi;
constexpr double huge_reflectance = 10.0;
constexpr double retro_reference_rho = 0.35;
constexpr double retro_reference_mu_db = -22.0;
constexpr double least_rms_slope = 0.01;  // 0.6 degrees
constexpr double most_rms_slope = 0.5;    // if steeper, the law of facets grows away from normal incidence
constexpr double most_rms_height_mm = 1000.0;

double linear(double level_db) {
  return std::pow(10.0, level_db / 10.0);
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

/// "Steel.001", "steel_clean" and "steel" are the same material.
std::string canonical(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  if (dot != std::string_view::npos && dot + 1 < name.size() &&
      std::all_of(name.begin() + static_cast<std::ptrdiff_t>(dot) + 1, name.end(),
                  [](unsigned char c) { return std::isdigit(c) != 0; })) {
    name = name.substr(0, dot);
  }
  const std::string key = lower(name);
  const auto* alias =
      std::find_if(aliases.begin(), aliases.end(), [&](const auto& a) { return a.first == key; });
  return alias == aliases.end() ? key : std::string(alias->second);
}

double checked_reflectance(double rho, std::string_view what, std::vector<std::string>& warnings) {
  if (!std::isfinite(rho) || rho < 0.0) {
    throw WorldError(fmt::format("{} is {}: expected a number >= 0", what, rho));
  }
  if (rho > huge_reflectance) {
    warnings.push_back(fmt::format("{} {} is far above the usual 0 to 2.5", what, rho));
  }
  return rho;
}

double checked_mu(double mu_db, std::vector<std::string>& warnings) {
  if (std::isnan(mu_db) || std::isinf(mu_db)) {
    throw WorldError(fmt::format("lambert_mu_db is {}: expected a finite number", mu_db));
  }
  const double mu = linear(mu_db);
  if (mu > max_mu) {
    warnings.push_back(fmt::format(
        "Lambert coefficient {} dB scatters more energy than arrives: lowered to 1/pi (-4.97 dB)", mu_db));
    return max_mu;
  }
  return mu;
}

double mu_of_reflectance(double rho, std::vector<std::string>& warnings) {
  if (rho == 0.0) {
    return 0.0;
  }
  return checked_mu(retro_reference_mu_db + 20.0 * std::log10(rho / retro_reference_rho), warnings);
}

double checked(double value, double least, double most, std::string_view what) {
  if (!(value >= least && value <= most)) {
    throw WorldError(fmt::format("{} is {}: expected a number from {} to {}", what, value, least, most));
  }
  return value;
}

/// Replaces values of the material by the numbers in the request.
void replace_facets(const MaterialRequest& request, AcousticMaterial& material) {
  if (request.pressure_reflection) {
    material.pressure_reflection = checked(*request.pressure_reflection, -1.0, 1.0, "pressure_reflection");
  }
  if (request.rms_slope) {
    material.rms_slope = checked(*request.rms_slope, least_rms_slope, most_rms_slope, "rms_slope");
  }
  if (request.rms_height_mm) {
    material.rms_height_m = checked(*request.rms_height_mm, 0.0, most_rms_height_mm, "rms_height_mm") / 1000;
  }
}

std::string unknown_name_message(std::string_view name) {
  const std::string similar = similar_material_name(name);
  return fmt::format("unknown material '{}'{}; known: {}; a new one needs reflectance and lambert_mu_db",
                     name, similar.empty() ? "" : " (did you mean '" + similar + "'?)",
                     fmt::join(acoustic_material_names(), ", "));
}

}  // namespace

std::vector<std::string> acoustic_material_names() {
  std::vector<std::string> names;
  names.reserve(table.size());
  for (const TableRow& row : table) {
    names.emplace_back(row.name);
  }
  return names;
}

std::optional<AcousticMaterial> find_acoustic_material(std::string_view name) {
  const std::string key = canonical(name);
  const auto row = std::find_if(table.begin(), table.end(), [&](const TableRow& r) { return r.name == key; });
  if (row == table.end()) {
    return std::nullopt;
  }
  return AcousticMaterial{std::string(row->name),   row->reflectance, linear(row->lambert_mu_db),
                          row->pressure_reflection, row->rms_slope,   row->rms_height_mm / 1000};
}

std::string similar_material_name(std::string_view name) {
  const std::string key = canonical(name);
  const TableRow* best = nullptr;
  std::size_t best_distance = std::max<std::size_t>(1, key.size() / 3) + 1;
  for (const TableRow& row : table) {
    const std::size_t distance = edit_distance(key, row.name);
    if (distance < best_distance) {
      best_distance = distance;
      best = &row;
    }
  }
  return best == nullptr ? std::string() : std::string(best->name);
}

AcousticMaterial make_acoustic_material(const MaterialRequest& request, std::vector<std::string>& warnings) {
  AcousticMaterial material;
  if (!request.name.empty()) {
    const auto named = find_acoustic_material(request.name);
    if (!named && !(request.reflectance && request.lambert_mu_db)) {
      throw WorldError(unknown_name_message(request.name));
    }
    material = named.value_or(material);
    material.name = named ? named->name : request.name;
  }
  if (request.reflectance) {
    material.reflectance = checked_reflectance(*request.reflectance, "reflectance", warnings);
  }
  if (request.lambert_mu_db) {
    material.lambert_mu = checked_mu(*request.lambert_mu_db, warnings);
  } else if (request.reflectance && request.name.empty()) {
    material.lambert_mu = mu_of_reflectance(material.reflectance, warnings);
  }
  replace_facets(request, material);
  return material;
}

AcousticMaterial material_of_laser_retro(double laser_retro, std::vector<std::string>& warnings) {
  const double rho = checked_reflectance(laser_retro, "laser_retro", warnings);
  if (rho == 0.0) {
    return {};
  }
  AcousticMaterial material;
  material.name = "laser_retro";
  material.reflectance = rho;
  material.lambert_mu = mu_of_reflectance(rho, warnings);
  return material;
}

}  // namespace sonard::render
