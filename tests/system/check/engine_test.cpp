// SPDX-License-Identifier: Apache-2.0
// Which engine the real program takes, with OpenGL and without, and how it says so.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/run_process.hpp"
#include "tests/support/temporary_folder.hpp"

namespace sonard::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

/// EGL finds its drivers in the folders this names: none.
const std::string no_gl = "__EGL_VENDOR_LIBRARY_DIRS=/nonexistent";

ProcessResult selftest(const std::string& setting, const std::string& engine) {
  return run_process({"env", setting, SONARD_PROGRAM, "selftest", "--engine", engine});
}

TEST(SelfTest, passes_on_every_engine_and_names_it) {
  const ProcessResult gpu = selftest("A=", "gpu");
  EXPECT_EQ(gpu.exit_code, 0) << gpu.err;
  EXPECT_THAT(gpu.out, ContainsRegex("OpenGL   devices of EGL:\n         0: "));
  EXPECT_THAT(gpu.out, ContainsRegex("\n         [0-9]+ is taken: "));
  EXPECT_THAT(gpu.out, ContainsRegex("\ngpu      a wall is [0-9.]+ % RMS from its closed form: gpu, "));
  EXPECT_THAT(gpu.out, HasSubstr("\nPASS\n"));
  const ProcessResult cpu = selftest("A=", "cpu");
  EXPECT_EQ(cpu.exit_code, 0) << cpu.err;
  EXPECT_THAT(cpu.out,
              ContainsRegex("^cpu      a wall is [0-9.]+ % RMS from its closed form: cpu, Embree [34]."));
  EXPECT_THAT(cpu.out, HasSubstr("\nPASS\n"));
}

TEST(SelfTest, measures_both_engines_and_tells_both_times) {
  const ProcessResult result = run_process({SONARD_PROGRAM, "selftest"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, ContainsRegex("\nauto     cpu takes [0-9.]+ ms a ping .*, gpu [0-9.]+ ms"));
  EXPECT_THAT(result.out, ContainsRegex("; (cpu|gpu) is taken"));
}

TEST(SelfTest, fails_with_its_own_exit_code_when_the_gpu_is_asked_for_without_gl) {
  const ProcessResult result = selftest(no_gl, "gpu");
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("renderer: no OpenGL 4.5 through EGL"));
  EXPECT_THAT(result.out, HasSubstr("libgl1-mesa-dri")) << "what to install";
}

TEST(SelfTest, names_the_devices_there_are_when_the_one_asked_for_is_not_there) {
  const ProcessResult result =
      run_process({SONARD_PROGRAM, "selftest", "--engine", "gpu", "--gpu-device", "no such card"});
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("gpu.device: no OpenGL 4.5 on a device 'no such card' (there is 0: "));
}

TEST(SelfTest, uses_the_cpu_where_there_is_no_gl) {
  for (const char* engine : {"auto", "cpu"}) {
    const ProcessResult result = selftest(no_gl, engine);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, ContainsRegex("from its closed form: cpu, Embree [34]."));
  }
}

TEST(SelfTest, knows_no_other_engine) {
  EXPECT_EQ(selftest("A=", "gl").exit_code, 64);
}

/// One head on loopback beside the shipped world.
class ServedConfig {
 public:
  explicit ServedConfig(const std::string& engine)
      : path_(testing::TempDir() + std::to_string(getpid()) + "_engine_" + engine + ".yaml") {
    std::ofstream(path_)
        << "world: {file: " << SONARD_SOURCE_DIR << "/configs/worlds/docking_station.sdf}\nengine: " << engine
        << "\nposes: {initial: {position_m: [0, -12, -25]}}\n"
           "heads:\n"
           "  - name: head\n"
           "    type: gemini_720i\n"
           "    sonar_id: 513\n"
           "    network: {alternate_address: 127.0.0.2, netmask: 255.0.0.0, status: [127.0.0.1]}\n";
  }
  ~ServedConfig() { std::filesystem::remove(path_); }
  ServedConfig(const ServedConfig&) = delete;
  ServedConfig& operator=(const ServedConfig&) = delete;

  ProcessResult run_without_gl() const { return run({no_gl, "XDG_CACHE_HOME=/nonexistent"}); }

  /// `sonard run` in a network of its own; SIGTERM when it is ready. The log is in `out`.
  ProcessResult run(const std::vector<std::string>& environment) const {
    std::vector<std::string> command{"unshare", "--net"};
    if (geteuid() != 0) {
      command.emplace_back("--map-root-user");
    }
    const std::string script =
        "ip link set lo up; log=$1.log; shift; \"$@\" 2>\"$log\" & pid=$!; tries=300; "
        "until grep -q 'sonard ready' \"$log\" || ! kill -0 $pid || [ $tries = 0 ]; do sleep 0.1; "
        "tries=$((tries - 1)); done; "
        "kill -TERM $pid; wait $pid; code=$?; cat \"$log\"; rm \"$log\"; exit $code";
    command.insert(command.end(), {"sh", "-c", script, "sh", path_, "env"});
    command.insert(command.end(), environment.begin(), environment.end());
    command.insert(command.end(), {SONARD_PROGRAM, "run", path_});
    return run_process(command);
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

TEST(Run, serves_from_the_cpu_where_there_is_no_gl) {
  const ServedConfig config("auto");
  const ProcessResult result = config.run_without_gl();
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_THAT(result.out,
              ContainsRegex("engine auto: cpu takes [0-9.]+ ms a ping .*gpu cannot be had: no OpenGL 4.5 "
                            "through EGL"));
  EXPECT_THAT(result.out, ContainsRegex("sonard ready heads=1 .*engine=\"cpu, Embree [34]"));
}

TEST(Run, measures_the_engines_at_the_first_start_only) {
  const ServedConfig config("auto");
  const TemporaryFolder cache;
  const std::vector<std::string> environment{"XDG_CACHE_HOME=" + cache.path().string()};
  EXPECT_THAT(config.run(environment).out,
              ContainsRegex("engine auto: cpu takes [0-9.]+ ms a ping .*; (cpu|gpu) is taken"));
  const std::string again = config.run(environment).out;
  EXPECT_THAT(again, ContainsRegex("engine auto: (cpu|gpu) is taken, as an earlier start measured: cpu takes "
                                   "[0-9.]+ ms a ping .* \\(kept in .*/sonard/engine_choices\\)"));
  EXPECT_THAT(again, HasSubstr("sonard ready heads=1"));
}

TEST(Run, ends_with_its_own_exit_code_when_the_gpu_is_asked_for_without_gl) {
  const ServedConfig config("gpu");
  const ProcessResult result = config.run_without_gl();
  EXPECT_EQ(result.exit_code, 4) << result.out;
  EXPECT_THAT(result.out, HasSubstr("renderer: no OpenGL 4.5 through EGL"));
}

TEST(Check, shows_the_engine_that_is_asked_for) {
  const ServedConfig config("gpu");
  const ProcessResult result = run_process({SONARD_PROGRAM, "check", "--no-network", config.path()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("\nengine  gpu\n"));
}

}  // namespace
}  // namespace sonard::test
