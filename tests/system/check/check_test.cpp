// SPDX-License-Identifier: Apache-2.0
// The real program on configurations that are broken in one way each, and on the shipped configurations.
// The first line of most files in tests/data/configs/broken/ is the complaint about them.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <regex>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/pattern.hpp"
#include "tests/support/run_process.hpp"

namespace sonard::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const std::string source_folder = SONARD_SOURCE_DIR;
const std::string broken_folder = source_folder + "/tests/data/configs/broken/";

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    lines.push_back(line);
  }
  return lines;
}

struct Broken {
  std::string file;     ///< in broken_folder
  std::string pattern;  ///< the complaint behind the name of the file; assets are below broken_folder
};

std::ostream& operator<<(std::ostream& out, const Broken& broken) {
  return out << broken.file;
}

/// The files whose first line is the only complaint about them.
std::vector<Broken> broken_configs() {
  std::vector<Broken> all;
  for (const auto& entry : std::filesystem::directory_iterator(broken_folder)) {
    std::ifstream file(entry.path());
    std::string line;
    if (entry.is_regular_file() && std::getline(file, line) &&
        std::regex_search(line, std::regex("^# [0-9]+:"))) {
      const std::string pattern =
          std::regex_replace(line.substr(2), std::regex("assets/"), broken_folder + "assets/");
      all.push_back({entry.path().filename(), pattern});
    }
  }
  std::ranges::sort(all, {}, &Broken::file);
  return all;
}

TEST(BrokenConfigs, AreAllFound) {
  EXPECT_EQ(broken_configs().size(), 18U) << "beside those that need a test of their own";
}

class BrokenConfig : public testing::TestWithParam<Broken> {};

/// Exactly one error message, in one line, that names file, line and key (also in the asset), and exit
/// code 2.
TEST_P(BrokenConfig, IsRefusedWithFileLineAndKey) {
  const std::string file = broken_folder + GetParam().file;
  const ProcessResult result = run_process({SONARD_PROGRAM, "check", file});
  ASSERT_FALSE(result.timed_out);
  EXPECT_EQ(result.exit_code, 2);
  const std::vector<std::string> lines = lines_of(result.err);
  ASSERT_EQ(lines.size(), 1U) << result.err;
  const std::string pattern = file + ":" + GetParam().pattern;
  EXPECT_TRUE(matches(lines[0], pattern)) << lines[0] << "\nis not\n" << pattern;
}

INSTANTIATE_TEST_SUITE_P(all, BrokenConfig, testing::ValuesIn(broken_configs()), [](const auto& test) {
  return test.param.file.substr(0, test.param.file.find('.'));
});

/// A socket on a port that the kernel chose, and the broken configuration that uses this port. The socket is
/// open as long as the object lives.
class HeldPort {
 public:
  /// @param file below broken_folder; the port replaces its "40000"
  HeldPort(int type, const char* address, const std::string& file) : socket_(socket(AF_INET, type, 0)) {
    sockaddr_in name{};
    name.sin_family = AF_INET;
    inet_pton(AF_INET, address, &name.sin_addr);
    socklen_t length = sizeof name;
    auto* const generic = reinterpret_cast<sockaddr*>(&name);
    if (bind(socket_, generic, length) != 0 || (type == SOCK_STREAM && listen(socket_, 1) != 0) ||
        getsockname(socket_, generic, &length) != 0) {
      throw std::system_error(errno, std::generic_category(), address);
    }
    port_ = std::to_string(ntohs(name.sin_port));
    config_ = testing::TempDir() + std::to_string(getpid()) + "_" + file;
    std::stringstream text;
    text << std::ifstream(broken_folder + file).rdbuf();
    const std::string with_port = std::regex_replace(text.str(), std::regex("40000"), port_);
    std::ofstream(config_) << std::regex_replace(with_port, std::regex("assets/"), broken_folder + "assets/");
  }
  ~HeldPort() {
    close(socket_);
    std::filesystem::remove(config_);
  }
  HeldPort(const HeldPort&) = delete;
  HeldPort& operator=(const HeldPort&) = delete;

  const std::string& port() const { return port_; }
  const std::string& config() const { return config_; }

 private:
  int socket_;
  std::string port_;
  std::string config_;
};

TEST(AddressInUse, IsRefusedForAHead) {
  const HeldPort held(SOCK_DGRAM, "127.91.0.18", "address_in_use.yaml");
  const ProcessResult result = run_process({SONARD_PROGRAM, "check", held.config()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(lines_of(result.err),
              Contains(held.config() + ":11:26: heads[0].network.bind: UDP 127.91.0.18:" + held.port() +
                       " is in use by another program (expected a free port)"));
}

TEST(AddressInUse, IsRefusedForThePoseStream) {
  const HeldPort held(SOCK_STREAM, "127.91.0.19", "pose_port_in_use.yaml");
  const ProcessResult result = run_process({SONARD_PROGRAM, "check", held.config()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(lines_of(result.err),
              Contains(held.config() + ":5:15: poses.tcp.bind: TCP 127.91.0.19:" + held.port() +
                       " is in use by another program (expected a free port)"));
}

TEST(OverlappingHeads, AreRefusedWithWhatTheyShare) {
  const std::string file = broken_folder + "overlapping_heads.yaml";
  const ProcessResult result = run_process({SONARD_PROGRAM, "check", file});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(
      lines_of(result.err),
      testing::UnorderedElementsAre(
          AllOf(StartsWith(file + ":18:26: heads[1].network.bind: UDP 127.91.0.8:52901 overlaps"),
                HasSubstr("heads[0].network.bind")),
          StartsWith(file + ":18:26: heads[1].network.alternate_address: 127.91.0.8 is already used by")));
}

// --- shipped configurations
// ------------------------------------------------------------------------------------------------------

/// Runs the program in its own network namespace, which has the address of a 720i. Daemons on this machine
/// do not disturb it.
ProcessResult check_in_own_network(const std::string& config) {
  const std::string set_up = "ip link set lo up && ip address add 10.61.19.200/24 dev lo && exec \"$@\"";
  std::vector<std::string> command{"unshare", "--net"};
  if (geteuid() != 0) {
    command.emplace_back("--map-root-user");
  }
  for (const std::string& word :
       {std::string("sh"), std::string("-c"), set_up, std::string("sh"), std::string(SONARD_PROGRAM),
        std::string("check"), source_folder + "/configs/" + config}) {
    command.push_back(word);
  }
  return run_process(command);
}

class ShippedConfig : public testing::TestWithParam<const char*> {};

TEST_P(ShippedConfig, IsGoodWithoutAWarning) {
  const ProcessResult result = check_in_own_network(GetParam());
  EXPECT_EQ(result.exit_code, 0) << result.out;
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(lines_of(result.out), Contains(AllOf(StartsWith("world "), HasSubstr(" triangles"))));
  EXPECT_THAT(lines_of(result.out), Contains(StartsWith("head ")));
}

INSTANTIATE_TEST_SUITE_P(All, ShippedConfig,
                         testing::Values("demo.yaml", "gemini-netns.yaml", "ssiv.yaml", "manifold.yaml",
                                         "paper.yaml", "gazebo.yaml", "gemini-and-ping360.yaml",
                                         "oculus-and-ping360.yaml", "bluerov2.yaml"),
                         [](const auto& test) {
                           std::string name = test.param;
                           name.resize(name.find('.'));
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(Check, CanLeaveAddressesAlone) {
  const ProcessResult result =
      run_process({SONARD_PROGRAM, "check", "--no-network", broken_folder + "foreign_address.yaml"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
}

/// A configuration and its world, in their own folder.
class CheckedWorld : public testing::Test {
 protected:
  ~CheckedWorld() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  /// @param models of the world
  /// @param environment "NAME=VALUE"
  ProcessResult check(const std::string& models, const std::string& more = "",
                      const std::vector<std::string>& environment = {}) const {
    write("world.sdf",
          "<sdf version=\"1.9\" xmlns:sonard=\"x\"><world name=\"w\">\n" + models + "</world></sdf>");
    return check_with("{file: world.sdf}", more, environment);
  }
  /// @param world the value of the key
  ProcessResult check_with(const std::string& world, const std::string& more = "",
                           const std::vector<std::string>& environment = {}) const {
    std::vector<std::string> command{"env"};
    command.insert(command.end(), environment.begin(), environment.end());
    for (const std::string& word :
         {std::string("prlimit"), std::string("--as=" SONARD_ADDRESS_SPACE), std::string(SONARD_PROGRAM),
          std::string("check"), std::string("--no-network"),
          write("sonard.yaml", "world: " + world + "\nposes: {initial: {position_m: [0, 0, 0]}}\n" + more +
                                   "heads:\n  - name: bow\n    type: gemini_720i\n    sonar_id: 513\n"
                                   "    network: {alternate_address: 127.0.0.2, netmask: 255.0.0.0}\n")}) {
      command.push_back(word);
    }
    return run_process(command);
  }
  static std::string model(const std::string& name, const std::string& geometry) {
    return "<model name=\"" + name +
           "\"><pose>5 0 0 0 0 0</pose><link name=\"l\"><visual name=\"v\"><geometry>" + geometry +
           "</geometry></visual></link></model>\n";
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("checked_world_" + std::to_string(getpid()));
};

TEST_F(CheckedWorld, IsToldOfWithExtentsScaleMaterialAndCost) {
  write("roof.obj", "v 0 0 0\nv 1000 0 0\nv 0 1000 0\nf 1 2 3\n");
  const ProcessResult result =
      check(model("roof", "<mesh><uri>roof.obj</uri><scale>0.001 0.001 0.001</scale></mesh>"));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("body     roof: 1 x 1 x 0 m at (5.5, 0.5, 0), default, scale 0.001\n"));
  EXPECT_THAT(result.out,
              testing::ContainsRegex("cost     bow: a ping to [0-9]+ m takes about [0-9.e+]+ ms"));
}

/// The hull of a vehicle and a frame in millimetres, and a flat plate beside a mesh that has a scale.
TEST_F(CheckedWorld, WhoseMeshesAreInMillimetresSaysSo) {
  write("hull.obj", "v 0 0 0\nv 2500 0 0\nv 0 600 0\nv 0 0 600\nf 1 2 3\nf 1 2 4\nf 2 3 4\n");
  write("frame.obj", "v 0 0 0\nv 6000 200 0\nv 0 0 2000\nf 1 2 3\n");
  write("plate.obj", "v 0 0 0\nv 3000 0 0\nv 0 3000 20\nf 1 2 3\n");
  const std::string plate_beside_a_bolt =
      "<model name=\"plate\"><link name=\"l\"><visual "
      "name=\"a\"><geometry><mesh><uri>plate.obj</uri></mesh></geometry>"
      "</visual><visual name=\"b\"><geometry><mesh><uri>hull.obj</uri><scale>0.001 0.001 "
      "0.001</scale></mesh></geometry>"
      "</visual></link></model>";
  const ProcessResult result =
      check(model("hull", "<mesh><uri>hull.obj</uri></mesh>") +
            model("frame", "<mesh><uri>frame.obj</uri></mesh>") + plate_beside_a_bolt);
  for (const char* text : {"body 'hull' is 2500 x 600 x 600 m: is its mesh in millimetres?",
                           "body 'frame' is 6000 x 200 x 2000 m: is its mesh in millimetres?",
                           "body 'plate' is 3000 x 3000 x 20 m: is its mesh in millimetres?"}) {
    EXPECT_THAT(result.err, HasSubstr(text));
  }
  EXPECT_THAT(result.out, testing::EndsWith("/sonard.yaml: good, with 4 warnings\n"));
}

TEST_F(CheckedWorld, IsRecordedInLogsThatTheHeadsWrite) {
  write("world.sdf", "<sdf version=\"1.9\"><world name=\"w\">" + model("box", "<box/>") + "</world></sdf>");
  for (const auto& [head, logs] :
       {std::pair{"{name: bow, type: ping360, udp: [{bind: 127.0.0.1:12345}]}", " mcap pcapng"},
        {"{name: bow, type: gemini_720i, sonar_id: 513, network: {alternate_address: 127.0.0.2, netmask: "
         "255.0.0.0}}",
         " glf mcap pcapng"},
        {"{name: bow, type: sonar3d15, network: {address: 127.0.0.2, http_port: 8080}}",
         " mcap pcapng sonar"}}) {
    const ProcessResult result =
        run_process({SONARD_PROGRAM, "check", "--no-network",
                     write("sonard.yaml", std::string("world: {file: world.sdf}\nengine: cpu\n"
                                                      "poses: {initial: {position_m: [0, 0, 0]}}\n"
                                                      "recording: {directory: logs}\nheads:\n  - ") +
                                              head + "\n")});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, testing::ContainsRegex(std::string("records  into [^\n]*logs:") + logs + "\n"));
  }
}

/// Seabeds and pipelines of kilometres are usual, as are meshes far from each other. Shapes without a file
/// are in metres.
TEST_F(CheckedWorld, ThatIsLargeIsNotTakenForMillimetres) {
  write("bed.obj", "v 0 0 0\nv 7000 0 80\nv 0 9000 0\nf 1 2 3\n");
  write("pipe.obj", "v 0 0 0\nv 3000 1 0\nv 0 0 1\nf 1 2 3\n");
  write("mark.obj", "v 0 0 0\nv 1 0 0\nv 0 2 3\nf 1 2 3\n");
  const std::string marks_3_km_apart =
      "<model name=\"marks\"><link name=\"l\"><visual name=\"a\"><geometry><mesh><uri>mark.obj</uri></mesh>"
      "</geometry></visual><visual name=\"b\"><pose>3000 0 1000 0 0 "
      "0</pose><geometry><mesh><uri>mark.obj</uri>"
      "</mesh></geometry></visual></link></model>";
  const ProcessResult result = check(
      model("sea", "<plane><size>3000 3000</size></plane>") +
          model("bed", "<box><size>2500 2500 0.1</size></box>") +
          model("berg", "<box><size>2500 2500 2500</size></box>") +
          model("chart", "<heightmap><uri>" + source_folder +
                             "/tests/data/worlds/grey16.png</uri><size>7000 9000 3000</size></heightmap>") +
          model("survey", "<mesh><uri>bed.obj</uri></mesh>") +
          model("pipeline", "<mesh><uri>pipe.obj</uri></mesh>") + marks_3_km_apart,
      "", {"GZ_SIM_RESOURCE_PATH=" + source_folder + "/tests/data/worlds"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, testing::Not(HasSubstr("millimetres"))) << result.err;
}

TEST_F(CheckedWorld, AsksOfATinyMeshOnlyIfItIsScaled) {
  write("bolt.obj", "v 0 0 0\nv 0.003 0 0\nv 0 0.003 0.001\nf 1 2 3\n");
  const ProcessResult result =
      check(model("bolt", "<mesh><uri>bolt.obj</uri></mesh>") +
            model("twice", "<mesh><uri>bolt.obj</uri><scale>0.001 0.001 0.001</scale></mesh>"));
  EXPECT_THAT(result.err, Not(HasSubstr("body 'bolt'")));
  EXPECT_THAT(result.err, HasSubstr("body 'twice'"));
  EXPECT_THAT(result.err, HasSubstr("is its mesh scaled twice?"));
}

/// A rotated plane has a thickness of some 1e-16 m in floating point.
TEST_F(CheckedWorld, HasSizesToTheMicrometre) {
  const ProcessResult result = check(
      "<model name=\"wall\"><pose>5 0 0 0 1.5707963 0.3</pose><link name=\"l\"><visual name=\"v\"><geometry>"
      "<plane><size>2 4</size><normal>1 0 0</normal></plane></geometry></visual></link></model>" +
      model("plate", "<plane><size>2 4</size><normal>1 1 0</normal></plane>"));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, Not(HasSubstr("e-1")));
}

TEST_F(CheckedWorld, WithoutASurfaceIsOpenWaterOnlyIfToldSo) {
  const std::string marks = "<model name=\"marks\"><frame name=\"f\"/></model>\n";
  const ProcessResult refused = check(marks);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err,
              HasSubstr("world.sdf: the world has no triangles (expected a surface that reflects sound; for "
                        "open water, write `world: empty`, or add `empty: true` beside `file`)"));
  for (const char* world : {"empty", "{empty: true}", "{empty: true, file: world.sdf}"}) {
    const ProcessResult allowed = check_with(world);
    EXPECT_EQ(allowed.exit_code, 0) << allowed.err;
    EXPECT_EQ(allowed.err, "") << world;
    EXPECT_THAT(allowed.out, HasSubstr("0 triangles, images contain only noise and water clutter\n"))
        << world;
    EXPECT_THAT(allowed.out, HasSubstr("cost     bow: a ping to ")) << world;
  }
}

TEST_F(CheckedWorld, FindsModelsByTheEnvironment) {
  write("lib/post/model.sdf", "<sdf version=\"1.6\">" + model("post", "<box/>") + "</sdf>");
  const ProcessResult result = check(
      "<include><uri>post</uri></include><include><uri>file://post</uri><name>p2</name>"
      "</include><include><uri>model://sun</uri></include>\n",
      "", {"GAZEBO_RESOURCE_PATH=" + (folder_ / "lib").string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("w: 2 bodies, 24 triangles"), HasSubstr("left out: lights (1): sun")));
}

TEST_F(CheckedWorld, IsToldOfAsJson) {
  write("world.sdf", "<sdf version=\"1.9\" xmlns:sonard=\"x\"><world name=\"w\">\n" +
                         model("ball", "<sphere><radius>1</radius></sphere>") + "</world></sdf>");
  const std::string config =
      write("sonard.yaml",
            "world: {file: world.sdf}\nposes: {initial: {position_m: [0, 0, 0]}}\nengine: cpu\nheads:\n"
            "  - name: bow\n    type: gemini_720i\n    sonar_id: 513\n"
            "    network: {alternate_address: 127.0.0.2, netmask: 255.0.0.0}\n");
  const ProcessResult result = run_process({SONARD_PROGRAM, "check", "--no-network", "--json", config});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report["configuration"], config);
  EXPECT_EQ(report["good"], true);
  EXPECT_EQ(report["problems"], nlohmann::json::array());
  EXPECT_GT(report["cost_ms"]["bow"].get<double>(), 0.0);
  EXPECT_THAT(report["findings"], Contains(nlohmann::json{{"area", "engine"}, {"text", "cpu"}}));
  std::vector<std::string> areas;
  for (const auto& finding : report["findings"]) {
    areas.push_back(finding["area"]);
  }
  EXPECT_THAT(areas, testing::IsSupersetOf({"world", "body", "poses", "head", "cost"}));
}

TEST_F(CheckedWorld, IsToldOfAsJsonWithThePlacesOfWhatIsWrong) {
  const std::string config =
      write("sonard.yaml",
            "world: {file: gone.sdf}\nposes: {initial: {position_m: [0, 0, 0]}}\nheads:\n  - name: bow\n"
            "    type: gemini_720i\n    sonar_id: 513\n    network: {alternate_address: 127.0.0.2, netmask: "
            "255.0.0.0}\n");
  const ProcessResult missing = run_process({SONARD_PROGRAM, "check", "--no-network", "--json", config});
  EXPECT_EQ(missing.exit_code, 2);
  const auto report = nlohmann::json::parse(missing.out);
  EXPECT_EQ(report["good"], false);
  ASSERT_EQ(report["problems"].size(), 1U);
  const auto& problem = report["problems"][0];
  EXPECT_EQ(problem["file"], config);
  EXPECT_EQ(problem["key"], "world.file");
  EXPECT_EQ(problem["line"], 1);
  EXPECT_EQ(problem["column"], 15);
  EXPECT_THAT(problem["message"].get<std::string>(), HasSubstr("gone.sdf: world file not found"));

  // A file that cannot be loaded at all causes a message of the same form.
  const auto broken = nlohmann::json::parse(
      run_process({SONARD_PROGRAM, "check", "--json", write("broken.yaml", "wibble: 1\n")}).out);
  EXPECT_EQ(broken["good"], false);
  EXPECT_THAT(broken["problems"],
              Contains(testing::ResultOf([](const auto& one) { return one["key"]; }, "wibble")));
  const auto absent =
      nlohmann::json::parse(run_process({SONARD_PROGRAM, "check", "--json", "/nowhere.yaml"}).out);
  EXPECT_EQ(absent["problems"][0]["line"], nullptr);
}

TEST(Help, NamesValuesInWords) {
  for (const char* const command : {"run", "check", "render", "selftest", "replay", "info", "demo"}) {
    const std::string help = run_process({SONARD_PROGRAM, command, "--help"}).out;
    for (const char* const raw : {"ENUM", "FLOAT", "UINT", "INT:", "TEXT:", "->", " in [", "e+0"}) {
      EXPECT_THAT(help, Not(HasSubstr(raw))) << command;
    }
  }
  const auto help_of = [](const char* command) {
    return run_process({SONARD_PROGRAM, command, "--help"}).out;
  };
  EXPECT_THAT(help_of("selftest"), HasSubstr("--engine {auto,gpu,cpu} [auto]"));
  EXPECT_THAT(help_of("render"), AllOf(HasSubstr("--bits {8,16}"), HasSubstr("--gain 0..100"),
                                       HasSubstr("--rate NUMBER"), HasSubstr("--trajectory TEXT REQUIRED")));
  EXPECT_THAT(help_of("check"), HasSubstr("--json "));
}

TEST_F(CheckedWorld, IsToldOfWithAllThatIsWrong) {
  const ProcessResult result = check(
      model("a", "<mesh><uri>gone.obj</uri></mesh>") + model("b", "<sphere><radius>x</radius></sphere>") +
      "<include><uri>model://nowhere</uri></include>\n" +
      model("c", "<cylinder><radius>1</radius><longness>2</longness></cylinder>"));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(lines_of(result.err), testing::UnorderedElementsAre(
                                        HasSubstr("world.sdf:2: a::l::v: 'gone.obj' not found"),
                                        HasSubstr("world.sdf:3: b::l::v: radius 'x'"),
                                        HasSubstr("world.sdf:4: include 'model://nowhere' not found"),
                                        HasSubstr("world.sdf:5: unknown element <longness> in <cylinder>")));
  EXPECT_THAT(result.out, HasSubstr("3 problems"));
}

TEST_F(CheckedWorld, ThatIncludesItselfEndsAtOnceAndInLittleMemory) {
  write("a.sdf", "<sdf version=\"1.9\"><model name=\"a\"><include><uri>b.sdf</uri></include></model></sdf>");
  write("b.sdf", "<sdf version=\"1.9\"><model name=\"b\"><include><uri>a.sdf</uri></include></model></sdf>");
  const ProcessResult result =
      check("<include><uri>world.sdf</uri></include><include><uri>a.sdf</uri></include>");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("'world.sdf' includes itself: world.sdf -> world.sdf"),
                                HasSubstr("'a.sdf' includes itself: a.sdf -> b.sdf -> a.sdf")));
}

TEST_F(CheckedWorld, WhoseIncludesMultiplyEndsAtOnceAndInLittleMemory) {
  for (int level = 1; level <= 9; ++level) {
    std::string text = "<sdf version=\"1.9\"><model name=\"m\">";
    for (int i = 0; i < 12; ++i) {
      text += "<include><name>i" + std::to_string(i) + "</name><uri>m" + std::to_string(level + 1) +
              ".sdf</uri></include>";
    }
    write("m" + std::to_string(level) + ".sdf", text + "</model></sdf>");
  }
  write("m10.sdf", "<sdf version=\"1.9\">" + model("m", "<sphere/>") + "</sdf>");
  const ProcessResult result = check("<include><uri>m1.sdf</uri></include>");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("more than 1000000 elements, includes among them"));
}

TEST_F(CheckedWorld, SaysWhereOnEarthItIs) {
  const ProcessResult result = check(
      "<spherical_coordinates><surface_model>EARTH_WGS84</surface_model><latitude_deg>53.5</latitude_deg>"
      "<longitude_deg>-9.25</longitude_deg><elevation>2</elevation></spherical_coordinates>\n" +
      model("wall", "<box><size>1 4 4</size></box>"));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("origin   latitude 53.5000000, longitude -9.2500000, altitude 2.00 m\n"));
}

TEST_F(CheckedWorld, TriesWhereItWillWrite) {
  const std::string world = model("a", "<sphere/>");
  EXPECT_THAT(check(world, "recording: {directory: /proc/logs, mcap: true}\n").err,
              HasSubstr("recording.directory: cannot write into /proc: "));
  EXPECT_THAT(check(world, "recording: {directory: " + write("file", "") + "/logs, mcap: true}\n").err,
              HasSubstr("file is not a folder (expected a folder, or a path that does not exist yet)"));
  EXPECT_EQ(check(world, "recording: {directory: new/logs, mcap: true}\n").exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "new")) << "nothing is left behind";
}

TEST_F(CheckedWorld, TriesAPseudoTerminal) {
  write("world.sdf", "<sdf version=\"1.9\"><world name=\"w\">" + model("a", "<sphere/>") + "</world></sdf>");
  const auto check_link = [&](const std::string& link) {
    return run_process({SONARD_PROGRAM, "check",
                        write("micron.yaml",
                              "world: {file: world.sdf}\nposes: {initial: {position_m: [0, 0, 0]}}\n"
                              "heads:\n  - name: stern\n    type: micron\n    serial: {pty: [{link: " +
                                  link + "}]}\n")});
  };
  EXPECT_THAT(check_link("/nowhere/tty").err, HasSubstr("heads[0].serial"));
  const std::string good = (folder_ / "tty").string();
  EXPECT_EQ(check_link(good).exit_code, 0);
  EXPECT_FALSE(std::filesystem::is_symlink(good)) << "nothing is left behind";
}

TEST(CommandLine, HasItsOwnExitCodeForWrongUse) {
  EXPECT_EQ(run_process({SONARD_PROGRAM}).exit_code, 64);
  EXPECT_EQ(run_process({SONARD_PROGRAM, "check"}).exit_code, 64);
  EXPECT_EQ(run_process({SONARD_PROGRAM, "serve", "x.yaml"}).exit_code, 64);
  EXPECT_EQ(run_process({SONARD_PROGRAM, "run", "x.yaml", "--log-level", "loud"}).exit_code, 64);
}

TEST(CommandLine, ExplainsItself) {
  const ProcessResult help = run_process({SONARD_PROGRAM, "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out,
              AllOf(HasSubstr("run"), HasSubstr("check"), HasSubstr("selftest"), HasSubstr("Exit codes:")));
  const ProcessResult version = run_process({SONARD_PROGRAM, "--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out, StartsWith("sonard "));
}

TEST(Run, RefusesABrokenConfigurationLikeCheck) {
  const std::string file = broken_folder + "bad_unit.yaml";
  const ProcessResult result = run_process({SONARD_PROGRAM, "run", file});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr(file + ":15:18: water.temperature_c: '10C' contains a unit"));
}

TEST(Run, NamesTheKeyOfAMissingWorld) {
  const std::string file = broken_folder + "missing_world.yaml";
  const ProcessResult result = run_process({SONARD_PROGRAM, "run", file});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(lines_of(result.err), Contains(StartsWith(file + ":3:9: world.file: ")));
}

TEST(Run, HasItsOwnExitCodeForAnAddressInUse) {
  const HeldPort held(SOCK_DGRAM, "127.91.0.18", "address_in_use.yaml");
  const ProcessResult result = run_process({SONARD_PROGRAM, "run", held.config()});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(lines_of(result.err), Contains(StartsWith(held.config() + ":11:26: heads[0].network.bind: ")));
}

}  // namespace
}  // namespace sonard::test
