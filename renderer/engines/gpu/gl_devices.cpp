// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gl_devices.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/text/lower_case.hpp"
#include "renderer/errors.hpp"

namespace sonard::render {

namespace {

std::string list_of(const std::vector<GlDevice>& devices) {
  return devices.empty() ? "EGL lists no device" : fmt::format("{}", fmt::join(describe(devices), "; "));
}

GlDeviceChoice asked_for(const std::vector<GlDevice>& devices, const std::string& wanted) {
  std::size_t number = 0;
  const char* end = wanted.data() + wanted.size();
  const auto [stop, error] = std::from_chars(wanted.data(), end, number);
  if (error == std::errc() && stop == end) {
    if (number < devices.size() && !devices[number].description.empty()) {
      return {number, "gpu.device selects its number"};
    }
  } else {
    for (std::size_t i = 0; i < devices.size(); ++i) {
      if (lower_case(devices[i].description).find(lower_case(wanted)) != std::string::npos) {
        return {i, "gpu.device selects its name"};
      }
    }
  }
  throw RendererError(
      fmt::format("gpu.device: no device '{}' with OpenGL 4.5 (found {})", wanted, list_of(devices)));
}

}  // namespace

bool is_software_renderer(const std::string& description) {
  constexpr std::array<std::string_view, 6> names{"llvmpipe",    "softpipe", "swrast", "software rasterizer",
                                                  "swiftshader", "openswr"};
  const std::string text = lower_case(description);
  return std::ranges::any_of(names,
                             [&](std::string_view name) { return text.find(name) != std::string::npos; });
}

std::vector<std::string> describe(const std::vector<GlDevice>& devices) {
  std::vector<std::string> lines;
  for (const GlDevice& device : devices) {
    lines.push_back(fmt::format(
        "{}: {}{}{}{}", lines.size(), device.description.empty() ? "no OpenGL 4.5" : device.description,
        device.node.empty() ? "" : ", " + device.node, device.software ? ", software" : "",
        device.memory_mib == 0 ? "" : fmt::format(", {} MiB", device.memory_mib)));
  }
  return lines;
}

GlDeviceChoice choose_gl_device(const std::vector<GlDevice>& devices, const std::string& wanted) {
  if (!wanted.empty()) {
    return asked_for(devices, wanted);
  }
  std::vector<std::size_t> usable;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    if (!devices[i].description.empty()) {
      usable.push_back(i);
    }
  }
  if (usable.empty()) {
    throw RendererError(
        "no OpenGL 4.5 through EGL: " + list_of(devices) +
        " (check that a GL driver, for example Mesa's libgl1-mesa-dri, is installed, and that "
        "/dev/dri is accessible: docs/gpu.md)");
  }
  const auto rank = [&](std::size_t i) { return std::tuple(devices[i].software, ~devices[i].memory_mib, i); };
  const std::size_t best = *std::min_element(usable.begin(), usable.end(),
                                             [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  if (usable.size() == 1) {
    return {best, "the only device"};
  }
  const auto hardware =
      std::count_if(usable.begin(), usable.end(), [&](std::size_t i) { return !devices[i].software; });
  if (hardware == 1) {
    return {best, "the only hardware device"};
  }
  return {best, devices[best].memory_mib > 0 ? "most memory" : "the first device listed by EGL"};
}

}  // namespace sonard::render
