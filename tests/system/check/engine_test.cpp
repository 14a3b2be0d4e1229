// SPDX-License-Identifier: Apache-2.0
// The engine that the real program selects with OpenGL and without, and its log lines.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/run_process.hpp"
#include "tests/support/temporary_folder.hpp"

namespace sonard::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// EGL searches this folder for drivers and finds no drivers.
const std::string no_gl = "__EGL_VENDOR_LIBRARY_DIRS=/nonexistent";

/// The message of `auto` if it did not time OpenGL because OpenGL runs in software.
const std::string software = "OpenGL runs in software here";

ProcessResult selftest(const std::string& setting, const std::string& engine) {
  return run_process({"env", setting, SONARD_PROGRAM, "selftest", "--engine", engine});
}

TEST(SelfTest, PassesOnEveryEngineAndNamesIt) {
  const ProcessResult gpu = selftest("A=", "gpu");
  EXPECT_EQ(gpu.exit_code, 0) << gpu.err;
  EXPECT_THAT(gpu.out, ContainsRegex("OpenGL   devices of EGL:\n         0: "));
  EXPECT_THAT(gpu.out, ContainsRegex("\n         [0-9]+ is used: "));
  EXPECT_THAT(gpu.out,
              ContainsRegex("\ngpu      a wall differs by [0-9.]+ % RMS from its closed form: gpu, "));
  EXPECT_THAT(gpu.out, HasSubstr("\nPASS\n"));
  const ProcessResult cpu = selftest("A=", "cpu");
  EXPECT_EQ(cpu.exit_code, 0) << cpu.err;
  EXPECT_THAT(
      cpu.out,
      ContainsRegex("^cpu      a wall differs by [0-9.]+ % RMS from its closed form: cpu, Embree [34]."));
  EXPECT_THAT(cpu.out, HasSubstr("\nPASS\n"));
}

TEST(SelfTest, MeasuresBothEnginesAndTellsBothTimes) {
  const ProcessResult result = run_process({SONARD_PROGRAM, "selftest"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  if (result.out.find(software) != std::string::npos) {
    EXPECT_THAT(result.out,
                ContainsRegex("\nauto     cpu is taken \\(cpu, Embree .*OpenGL runs in software here"));
    return;
  }
  EXPECT_THAT(result.out, ContainsRegex("\nauto     cpu takes [0-9.]+ ms per ping .*, gpu [0-9.]+ ms"));
  EXPECT_THAT(result.out, ContainsRegex("; (cpu|gpu) is taken"));
}

TEST(SelfTest, TellsProgramsTheSame) {
  const ProcessResult result = run_process({SONARD_PROGRAM, "selftest", "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report["passed"], true);
  EXPECT_EQ(report["engines"][0]["engine"], "cpu");
  EXPECT_LT(report["engines"][0]["error_percent"].get<double>(), 5.0);
  EXPECT_THAT(report["auto"]["taken"].get<std::string>(), testing::AnyOf("cpu", "gpu"));
  for (const auto& device : report["devices"]) {
    EXPECT_TRUE(device["software"].is_boolean());
  }
  const ProcessResult without =
      run_process({"env", no_gl, SONARD_PROGRAM, "selftest", "--engine", "gpu", "--json"});
  EXPECT_EQ(without.exit_code, 4);
  EXPECT_EQ(without.err, "");
  const auto failed = nlohmann::json::parse(without.out);
  EXPECT_EQ(failed["passed"], false);
  EXPECT_THAT(failed["problem"].get<std::string>(), HasSubstr("no OpenGL 4.5 through EGL"));
  EXPECT_EQ(failed["device_taken"], nullptr);
}

TEST(SelfTest, FailsWithItsOwnExitCodeWhenTheGpuIsAskedForWithoutGl) {
  const ProcessResult result = selftest(no_gl, "gpu");
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("renderer: no OpenGL 4.5 through EGL"));
  EXPECT_THAT(result.out, HasSubstr("libgl1-mesa-dri")) << "what to install";
}

TEST(SelfTest, NamesTheDevicesThereAreWhenTheOneAskedForIsNotThere) {
  const ProcessResult result =
      run_process({SONARD_PROGRAM, "selftest", "--engine", "gpu", "--gpu-device", "no such card"});
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("gpu.device: no device 'no such card' with OpenGL 4.5 (found 0: "));
}

TEST(SelfTest, UsesTheCpuWhereThereIsNoGl) {
  for (const char* engine : {"auto", "cpu"}) {
    const ProcessResult result = selftest(no_gl, engine);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, ContainsRegex("from its closed form: cpu, Embree [34]."));
  }
}

TEST(SelfTest, KnowsNoOtherEngine) {
  EXPECT_EQ(selftest("A=", "gl").exit_code, 64);
}

/// One head on loopback, with the shipped world.
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

  /// `sonard run` in its own network namespace; gets SIGTERM when it is ready. The log is in `out`.
  ProcessResult run(const std::vector<std::string>& environment,
                    const std::vector<std::string>& options = {}) const {
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
    command.insert(command.end(), options.begin(), options.end());
    return run_process(command);
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

TEST(Run, ServesFromTheCpuWhereThereIsNoGl) {
  const ServedConfig config("auto");
  const ProcessResult result = config.run_without_gl();
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_THAT(
      result.out,
      ContainsRegex("engine auto: cpu takes [0-9.]+ ms per ping .*gpu is not available: no OpenGL 4.5 "
                    "through EGL"));
  EXPECT_THAT(result.out, ContainsRegex("sonard ready heads=1 .*engine=\"cpu, Embree [34]"));
}

TEST(Run, MeasuresTheEnginesAtTheFirstStartOnlyAndNeverASoftwareOpengl) {
  const ServedConfig config("auto");
  const TemporaryFolder cache;
  const std::vector<std::string> environment{"XDG_CACHE_HOME=" + cache.path().string()};
  const std::string first = config.run(environment).out;
  if (first.find(software) != std::string::npos) {
    EXPECT_THAT(
        first,
        ContainsRegex("engine auto: cpu is taken \\(cpu, Embree .*is not timed; to use it, set engine: gpu"));
    EXPECT_THAT(first, Not(HasSubstr("ms per ping")));
    EXPECT_THAT(first, HasSubstr("sonard ready heads=1"));
    EXPECT_FALSE(std::filesystem::exists(cache.path() / "sonard/engine_choices"));
    return;
  }
  EXPECT_THAT(first, ContainsRegex("engine auto: cpu takes [0-9.]+ ms per ping .*; (cpu|gpu) is taken"));
  const std::string again = config.run(environment).out;
  EXPECT_THAT(again, ContainsRegex("engine auto: (cpu|gpu) is taken, as an earlier start measured: cpu takes "
                                   "[0-9.]+ ms per ping .* \\(kept in .*/sonard/engine_choices\\)"));
  EXPECT_THAT(again, HasSubstr("sonard ready heads=1"));
}

TEST(Run, EndsWithItsOwnExitCodeWhenTheGpuIsAskedForWithoutGl) {
  const ServedConfig config("gpu");
  const ProcessResult result = config.run_without_gl();
  EXPECT_EQ(result.exit_code, 4) << result.out;
  EXPECT_THAT(result.out, HasSubstr("renderer: no OpenGL 4.5 through EGL"));
}

TEST(Run, LogsJsonFromItsFirstLineToItsLast) {
  const ServedConfig config("cpu");
  const ProcessResult result = config.run({"A="}, {"--log-format", "json"});
  EXPECT_EQ(result.exit_code, 0) << result.out;
  std::istringstream lines(result.out);
  std::string engine;
  for (std::string line; std::getline(lines, line);) {
    const auto object = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(object.is_object()) << line;
    EXPECT_TRUE(object.contains("time") && object.contains("level") && object.contains("message")) << line;
    EXPECT_NE(object.contains("head"), object.contains("area")) << line;
    if (object["keys"].contains("heads")) {
      EXPECT_EQ(object["keys"]["heads"], 1);
      engine = object["keys"]["engine"];
    }
  }
  EXPECT_THAT(engine, StartsWith("cpu, Embree"));
}

TEST(Run, TellsProblemsAsJsonWhereTheLogIs) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "a.yaml") << "wibble: 1\n";
  const ProcessResult result =
      run_process({SONARD_PROGRAM, "run", (folder.path() / "a.yaml").string(), "--log-format", "json"});
  EXPECT_EQ(result.exit_code, 2);
  std::istringstream lines(result.err);
  int wibbles = 0;
  for (std::string line; std::getline(lines, line);) {
    const auto object = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(object.is_object()) << line;
    EXPECT_EQ(object["level"], "error");
    wibbles +=
        object["message"].get<std::string>().find("a.yaml:1:1: wibble: unknown key") != std::string::npos;
  }
  EXPECT_EQ(wibbles, 1);
}

TEST(Check, ShowsTheEngineThatIsAskedFor) {
  const ServedConfig config("gpu");
  const ProcessResult result = run_process({SONARD_PROGRAM, "check", "--no-network", config.path()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("\nengine   gpu\n"));
}

}  // namespace
}  // namespace sonard::test
