// SPDX-License-Identifier: Apache-2.0
#include "server/selftest.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/text/printable.hpp"
#include "renderer/engines/gpu/gl_devices.hpp"
#include "renderer/errors.hpp"
#include "renderer/pipeline/self_test.hpp"
#include "server/daemon/exit_codes.hpp"

namespace sonard::server {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* what_to_install =
    "         To render on a GPU, install its OpenGL driver with EGL: libgl1-mesa-dri for Intel and AMD,\n"
    "         and for software, libnvidia-gl-* with nvidia-driver for NVIDIA; the user needs /dev/dri "
    "(groups\n"
    "         video and render). In a container: docs/gpu.md.\n";

/// Results of `selftest`, printed as text or JSON.
struct Report {
  struct Engine {
    render::EngineKind kind = render::EngineKind::cpu;
    render::SelfTestResult result;
    std::string problem;  ///< why it is unavailable; empty: it is available
  };
  std::vector<render::GlDevice> devices;
  std::optional<render::GlDeviceChoice> taken;
  std::string device_problem;  ///< why no device is chosen
  std::vector<Engine> engines;
  std::optional<render::EngineTrial> trial;
  std::string problem;  ///< why the test failed; empty: it passed
};

void look_at_devices(Report& report, const std::string& wanted) {
  report.devices = render::list_gl_devices();
  try {
    report.taken = choose_gl_device(report.devices, wanted);
  } catch (const render::RendererError& error) {
    report.device_problem = error.what();
  }
}

/// @throws render::RendererError
void test(Report& report, render::RendererOptions options, render::EngineKind engine) {
  options.engine = engine;
  report.engines.push_back({engine, render::run_self_test(options), ""});
}

/// @throws render::RendererError; `report` then holds the results so far
void run_tests(Report& report, const render::RendererOptions& options) {
  using render::EngineKind;
  if (options.engine != EngineKind::cpu) {
    look_at_devices(report, options.gpu.device);
  }
  if (options.engine != EngineKind::gpu) {
    test(report, options, EngineKind::cpu);
  }
  if (options.engine == EngineKind::gpu) {
    test(report, options, EngineKind::gpu);
  }
  if (options.engine == EngineKind::automatic) {
    try {
      test(report, options, EngineKind::gpu);
    } catch (const render::RendererError& error) {
      report.engines.push_back({EngineKind::gpu, {}, error.what()});
    }
    report.trial = render::time_engines(options);
  }
}

void print_devices(const Report& report) {
  fmt::print("OpenGL   {}\n", report.devices.empty() ? "EGL lists no device" : "devices of EGL:");
  for (const std::string& line : describe(report.devices)) {
    fmt::print("         {}\n", printable(line));
  }
  if (report.taken) {
    fmt::print("         {} is used: {}\n", report.taken->number, printable(report.taken->reason));
  } else {
    fmt::print("         no device is used: {}\n", printable(report.device_problem));
  }
  const bool hardware = std::ranges::any_of(report.devices, [](const render::GlDevice& device) {
    return !device.software && !device.description.empty();
  });
  if (!hardware) {
    fmt::print("{}", what_to_install);
  }
}

void print_text(const Report& report, bool with_devices) {
  if (with_devices) {
    print_devices(report);
  }
  for (const Report::Engine& engine : report.engines) {
    if (engine.problem.empty()) {
      fmt::print("{}      a wall differs by {:.3f} % RMS from its closed form: {}\n", name_of(engine.kind),
                 100.0 * engine.result.error, printable(engine.result.engine));
    } else {
      fmt::print("{}      {}\n", name_of(engine.kind), printable(engine.problem));
    }
  }
  if (report.trial) {
    fmt::print(
        "auto     {}. {}\n", printable(describe(*report.trial)),
        report.trial->software_gl.empty()
            ? "Timed before that wall, with 256 beams of 1000 range lines; `sonard run` measures in its "
              "own world"
            : "`sonard run` chooses in the same way");
  }
  fmt::print("{}\n", report.problem.empty() ? "PASS" : "FAIL");
}

Json device_json(const render::GlDevice& device, std::size_t number) {
  return {{"number", number},
          {"description", device.description},
          {"node", device.node},
          {"software", device.software},
          {"memory_mib", device.memory_mib}};
}

Json engine_json(const Report::Engine& engine) {
  const bool passed = engine.problem.empty();
  return {{"engine", name_of(engine.kind)},
          {"passed", passed},
          {"error_percent", passed ? Json(100.0 * engine.result.error) : Json(nullptr)},
          {"description", engine.result.engine},
          {"problem", engine.problem}};
}

Json trial_json(const std::optional<render::EngineTrial>& trial) {
  if (!trial) {
    return nullptr;
  }
  const auto time = [](double ms) { return ms > 0.0 ? Json(ms) : Json(nullptr); };
  return {{"taken", name_of(trial->taken)},
          {"cpu_ms", time(trial->cpu_ms)},
          {"gpu_ms", time(trial->gpu_ms)},
          {"why", describe(*trial)}};
}

Json selftest_json(const Report& report) {
  Json devices = Json::array();
  for (const render::GlDevice& device : report.devices) {
    devices.push_back(device_json(device, devices.size()));
  }
  Json engines = Json::array();
  for (const Report::Engine& engine : report.engines) {
    engines.push_back(engine_json(engine));
  }
  return {{"passed", report.problem.empty()},
          {"problem", report.problem},
          {"devices", std::move(devices)},
          {"device_taken", report.taken ? Json(report.taken->number) : Json(nullptr)},
          {"engines", std::move(engines)},
          {"auto", trial_json(report.trial)}};
}

}  // namespace

int selftest(const render::RendererOptions& options, bool json) {
  Report report;
  std::exception_ptr failure;
  try {
    run_tests(report, options);
  } catch (const render::RendererError& error) {
    report.problem = error.what();
    failure = std::current_exception();
  }
  if (json) {
    fmt::print("{}\n", selftest_json(report).dump(2, ' ', false, Json::error_handler_t::replace));
    return failure ? exit_renderer : exit_clean;
  }
  print_text(report, options.engine != render::EngineKind::cpu);
  if (failure) {
    std::rethrow_exception(failure);
  }
  return exit_clean;
}

}  // namespace sonard::server
