// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/sdf_frames.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "renderer/scene/uri_resolver.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {
namespace {

/// Thrown by SdfFrames::find(); what() names the model.
struct MissingModel : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// `relative_to`, which was `frame` up to SDF 1.6; "" if not given.
std::string_view relative_to(const SdfElement* pose) {
  for (const char* key : {"relative_to", "frame"}) {
    if (const std::string* const given = pose == nullptr ? nullptr : pose->attribute(key)) {
      return *given;
    }
  }
  return {};
}

}  // namespace

Pose read_pose(const SdfElement* pose) {
  if (pose == nullptr || pose->text.empty()) {
    return {};
  }
  try {
    const std::string* const format = pose->attribute("rotation_format");
    if (format != nullptr && *format == "quat_xyzw") {
      const std::vector<double> n = numbers_of(pose, std::vector<double>(7));
      const glm::dquat turn(n[6], n[3], n[4], n[5]);
      if (glm::length(turn) < 1e-6) {
        throw WorldError("the quaternion of the pose is zero");
      }
      return {{n[0], n[1], n[2]}, glm::normalize(turn)};
    }
    const std::vector<double> n = numbers_of(pose, std::vector<double>(6));
    const double unit_rad = is_true(pose->attribute("degrees")) ? std::numbers::pi / 180.0 : 1.0;
    const auto about = [&](double angle, const glm::dvec3& axis) {
      return glm::angleAxis(unit_rad * angle, axis);
    };
    return {{n[0], n[1], n[2]},
            glm::normalize(about(n[5], {0, 0, 1}) * about(n[4], {0, 1, 0}) * about(n[3], {1, 0, 0}))};
  } catch (const WorldError& error) {
    throw WorldError(fmt::format("{}: {}", pose->place(), error.what()));
  }
}

const Pose& SdfFrames::T_scope(const SdfElement& element) {
  if (const auto known = known_.find(&element); known != known_.end()) {
    return known->second;
  }
  if (!open_.insert(&element).second) {
    throw WorldError(fmt::format("{}: the pose of {} '{}' is relative to itself, through other frames",
                                 element.place_in_scope(), element.name, element.given_name()));
  }
  try {
    const Pose T_scope_element = worked_out(element);
    open_.erase(&element);
    return known_.emplace(&element, T_scope_element).first->second;
  } catch (const WorldError&) {
    open_.erase(&element);
    throw;
  }
}

Pose SdfFrames::worked_out(const SdfElement& element) {
  if (element.is_missing && element.child("placement_frame") != nullptr) {
    throw MissingFile(fmt::format("{}: the model '{}' is missing, so its placement_frame is unknown",
                                  element.place(), element.given_name()));
  }
  const SdfElement& scope = *element.parent;
  const SdfElement* const pose = element.child("pose");
  std::string_view base = relative_to(pose);
  const SdfElement* named_by = pose;
  if (base.empty()) {
    // By default, the base is the element that a frame is attached to, or the child of a joint.
    const std::string* const attached = element.name == "frame" ? element.attribute("attached_to") : nullptr;
    const SdfElement* const child = element.name == "joint" ? element.child("child") : nullptr;
    base = attached != nullptr ? std::string_view(*attached)
           : child != nullptr  ? std::string_view(child->text)
                               : "";
    named_by = &element;
  }
  Pose T = read_pose(pose);
  if (!base.empty()) {
    T = of_frame(scope, base, *named_by) * T;
  }
  const std::string* const placed_by =
      element.name == "model" ? element.attribute("placement_frame") : nullptr;
  return placed_by == nullptr || placed_by->empty() ? T : T * inverse(of_frame(element, *placed_by, element));
}

Pose SdfFrames::T_model(const SdfElement& in_link) {
  const SdfElement& link = *in_link.parent;
  const SdfElement* const pose = in_link.child("pose");
  const std::string_view base = relative_to(pose);
  return (base.empty() ? T_scope(link) : of_frame(*link.parent, base, *pose)) * read_pose(pose);
}

Pose SdfFrames::of_frame(const SdfElement& scope, std::string_view name, const SdfElement& named_by) {
  try {
    if (const auto T_scope_found = find(scope, name)) {
      return *T_scope_found;
    }
  } catch (const MissingModel& missing) {
    throw MissingFile(fmt::format("{}: frame '{}' is in {}, which is missing", named_by.place_in_scope(),
                                  name, missing.what()));
  }
  throw WorldError(fmt::format("{}: there is no frame '{}' in {} '{}'", named_by.place_in_scope(), name,
                               scope.name, scope.given_name()));
}

/// Names may contain "::", so the longest prefix is tried first.
std::optional<Pose> SdfFrames::find(const SdfElement& scope, std::string_view name) {
  if (name == "__model__" || (name == "world" && scope.name == "world")) {
    return Pose{};
  }
  const auto& names = names_in(scope);
  for (std::size_t end = name.size(); end != std::string_view::npos;
       end = end == 0 ? std::string_view::npos : name.rfind("::", end - 1)) {
    const auto found = names.find(name.substr(0, end));
    if (found == names.end()) {
      continue;
    }
    const SdfElement& element = *found->second;
    if (end == name.size()) {
      return T_scope(element);
    }
    if (element.is_missing) {
      throw MissingModel(fmt::format("the model '{}'", element.given_name()));
    }
    if (element.name == "model") {
      if (const auto T_model_found = find(element, name.substr(end + 2))) {
        return T_scope(element) * *T_model_found;
      }
    }
  }
  const auto is_merged = [](const auto& child) { return child->is_missing && child->given_name().empty(); };
  if (std::ranges::any_of(scope.children, is_merged)) {
    throw MissingModel("a model to be merged");
  }
  return std::nullopt;
}

const SdfFrames::Names& SdfFrames::names_in(const SdfElement& scope) {
  const auto [entry, is_new] = names_.try_emplace(&scope);
  if (is_new) {
    for (const auto& child : scope.children) {
      const std::string_view kind = child->name;
      if (kind == "link" || kind == "frame" || kind == "joint" || kind == "model") {
        if (const std::string* const name = child->attribute("name")) {
          entry->second.emplace(*name, child.get());
        }
      }
    }
  }
  return entry->second;
}

}  // namespace sonard::render
