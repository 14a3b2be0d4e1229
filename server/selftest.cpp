// SPDX-License-Identifier: Apache-2.0
#include "server/selftest.hpp"

#include <string>
#include <vector>

#include <fmt/format.h>

#include "renderer/engines/gpu/gl_devices.hpp"
#include "renderer/errors.hpp"
#include "renderer/pipeline/self_test.hpp"
#include "server/daemon/exit_codes.hpp"

namespace sonard::server {
namespace {

constexpr const char* what_to_install =
    "         To render on a GPU, install its OpenGL driver with EGL: libgl1-mesa-dri for Intel and AMD,\n"
    "         and for software, libnvidia-gl-* with nvidia-driver for NVIDIA; the user needs /dev/dri "
    "(groups\n"
    "         video and render). In a container: docs/gpu.md.\n";

void print_devices(const std::string& wanted) {
  const std::vector<render::GlDevice> devices = render::list_gl_devices();
  fmt::print("OpenGL   {}\n", devices.empty() ? "EGL lists no device" : "devices of EGL:");
  for (const std::string& line : describe(devices)) {
    fmt::print("         {}\n", line);
  }
  bool hardware = false;
  for (const render::GlDevice& device : devices) {
    hardware = hardware || (!device.software && !device.description.empty());
  }
  try {
    const render::GlDeviceChoice choice = choose_gl_device(devices, wanted);
    fmt::print("         {} is taken: {}\n", choice.number, choice.reason);
  } catch (const render::RendererError& error) {
    fmt::print("         none is taken: {}\n", error.what());
  }
  if (!hardware) {
    fmt::print("{}", what_to_install);
  }
}

/// @throws render::RendererError
void test(render::RendererOptions options, render::EngineKind engine) {
  options.engine = engine;
  const render::SelfTestResult result = render::run_self_test(options);
  fmt::print("{}      a wall is {:.3f} % RMS from its closed form: {}\n", name_of(engine),
             100.0 * result.error, result.engine);
}

}  // namespace

int selftest(const render::RendererOptions& options) {
  using render::EngineKind;
  try {
    if (options.engine != EngineKind::cpu) {
      print_devices(options.gpu.device);
    }
    if (options.engine != EngineKind::gpu) {
      test(options, EngineKind::cpu);
    }
    if (options.engine == EngineKind::gpu) {
      test(options, EngineKind::gpu);
    }
    if (options.engine == EngineKind::automatic) {
      try {
        test(options, EngineKind::gpu);
      } catch (const render::RendererError& error) {
        fmt::print("gpu      {}\n", error.what());
      }
      fmt::print(
          "auto     {}. Timed before that wall, with 256 beams of 1000 range lines; `sonard run` measures in "
          "its own world\n",
          describe(render::time_engines(options)));
    }
  } catch (const render::RendererError&) {
    fmt::print("FAIL\n");
    throw;
  }
  fmt::print("PASS\n");
  return exit_clean;
}

}  // namespace sonard::server
