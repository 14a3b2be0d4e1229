// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/sdf_state.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "renderer/scene/sdf_frames.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {
namespace {

SdfElement* part_named(SdfElement& around, std::string_view kind, std::string_view name) {
  const auto found = std::ranges::find_if(
      around.children, [&](const auto& child) { return child->name == kind && child->given_name() == name; });
  return found == around.children.end() ? nullptr : found->get();
}

/// Multiplies the numbers of a child; if it is not given, they are 1.
void multiply(SdfElement& shape, const char* name, const std::vector<double>& factors) {
  std::vector<double> numbers = numbers_of(shape.child(name), std::vector<double>(factors.size(), 1.0));
  for (std::size_t i = 0; i < factors.size(); ++i) {
    numbers[i] *= factors[i];
  }
  SdfElement* const given = shape.child(name);
  (given == nullptr ? shape.add_child(name, shape) : *given).text =
      fmt::format("{}", fmt::join(numbers, " "));
}

void scale_shape(SdfElement& shape, const std::vector<double>& scale) {
  if (shape.name == "box") {
    multiply(shape, "size", scale);
  } else if (shape.name == "sphere") {
    multiply(shape, "radius", {std::ranges::max(scale)});
  } else if (shape.name == "cylinder") {
    multiply(shape, "radius", {std::max(scale[0], scale[1])});
    multiply(shape, "length", {scale[2]});
  } else if (shape.name == "mesh") {
    multiply(shape, "scale", scale);
  }
}

void scale_links(SdfElement& model, const std::vector<double>& scale) {
  for (auto& link : model.children) {
    if (link->name != "link") {
      continue;
    }
    for (auto& part : link->children) {
      SdfElement* const geometry = part->child("geometry");
      if (geometry != nullptr && (part->name == "visual" || part->name == "collision")) {
        for (auto& shape : geometry->children) {
          scale_shape(*shape, scale);
        }
      }
    }
  }
}

}  // namespace

void SavedState::apply(SdfElement& world, std::vector<std::string>& warnings) {
  SdfElement* const state = world.child("state");
  if (state == nullptr) {
    return;
  }
  insert_models(*state, world);
  set_models(*state, world, "");
  remove_models(*state, world);
  if (!unknown_.empty()) {
    constexpr std::size_t most = 6;
    const std::size_t count = unknown_.size();
    unknown_.resize(std::min(count, most));
    warnings.push_back(fmt::format(
        "{}: <state> has poses of {} models or links that are not in this world: {}{}; save the world "
        "again, or remove them",
        state->place(), count, fmt::join(unknown_, ", "), count > most ? ", ..." : ""));
  }
}

const Pose* SavedState::T_world(const SdfElement& model_or_link) const {
  const auto known = T_world_.find(&model_or_link);
  return known == T_world_.end() ? nullptr : &known->second;
}

void SavedState::insert_models(SdfElement& state, SdfElement& world) {
  SdfElement* const insertions = state.child("insertions");
  if (insertions == nullptr) {
    return;
  }
  for (auto& model : insertions->children) {
    model->parent = &world;
    world.children.push_back(std::move(model));
  }
  insertions->children.clear();
}

void SavedState::set_models(const SdfElement& states, SdfElement& around, const std::string& path) {
  for (const auto& state : states.children) {
    if (state->name != "model" && state->name != "link") {
      continue;
    }
    const std::string name = state->given_name();
    SdfElement* const found = part_named(around, state->name, name);
    if (found == nullptr) {
      unknown_.push_back(path + name);
    } else if (state->name == "model") {
      set_model(*state, *found, path + name + "::");
    } else {
      T_world_.emplace(found, read_pose(state->child("pose")));
    }
  }
}

void SavedState::set_model(const SdfElement& state, SdfElement& model, const std::string& path) {
  T_world_.emplace(&model, read_pose(state.child("pose")));
  try {
    const std::vector<double> scale = numbers_of(state.child("scale"), {1, 1, 1});
    if (std::ranges::any_of(scale, [](double factor) { return factor != 1.0; })) {
      scale_links(model, scale);
    }
  } catch (const WorldError& error) {
    throw WorldError(fmt::format("{}: {}", state.place(), error.what()));
  }
  set_models(state, model, path);
}

void SavedState::remove_models(const SdfElement& state, SdfElement& world) {
  const SdfElement* const deletions = state.child("deletions");
  if (deletions == nullptr) {
    return;
  }
  for (const auto& name : deletions->children) {
    std::erase_if(world.children, [&](const auto& child) {
      return (child->name == "model" || child->name == "light") && child->given_name() == name->text;
    });
  }
}

}  // namespace sonard::render
