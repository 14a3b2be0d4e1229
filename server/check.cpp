// SPDX-License-Identifier: Apache-2.0
#include "server/check.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/asio/io_context.hpp>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "renderer/errors.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/scene/world.hpp"
#include "server/clock/clock.hpp"
#include "server/config/overlaps.hpp"
#include "server/daemon/daemon.hpp"
#include "server/daemon/resolve_mounts.hpp"
#include "server/devices/device_type.hpp"
#include "server/diagnosis/sight.hpp"
#include "server/error/error.hpp"
#include "server/net/udp_endpoint.hpp"
#include "server/pose/pose_input.hpp"
#include "server/recording/glf_device.hpp"
#include "server/trial_pings.hpp"
#include "server/try_bind.hpp"

namespace sonard::server {
namespace {

namespace asio = boost::asio;

constexpr std::uintmax_t least_space = 1'000'000'000;  // bytes; a multibeam head writes about 5 MB/s

class Check {
 public:
  explicit Check(const LoadedConfig& loaded) : loaded_(loaded), config_(loaded.config) {
    report_.warnings = loaded.warnings;
  }

  CheckReport run(bool try_addresses) {
    check_world();
    check_poses();
    check_recording();
    for (std::size_t i = 0; i < config_.heads.size(); ++i) {
      check_head(i);
    }
    if (try_addresses) {
      check_addresses();
    }
    report_.config = std::move(config_);
    return std::move(report_);
  }

 private:
  void problem(const std::string& key, const std::string& message) {
    report_.problems.push_back(loaded_.problem_at(key, message));
  }
  void warning(const std::string& key, const std::string& message) {
    report_.warnings.push_back(loaded_.problem_at(key, message));
  }

  void check_world();
  void check_poses();
  void check_recording();
  void check_head(std::size_t index);
  void check_addresses();
  void list_bodies(const render::World& world);
  std::optional<FirstPose> start() const;
  void check_start(const render::World& world);
  void report_cost(const HeadConfig& head, double ms, std::size_t triangles);
  void try_folder(const std::filesystem::path& folder, const std::string& key);
  void try_connecting(std::size_t head);

  const LoadedConfig& loaded_;
  DaemonConfig config_;
  CheckReport report_;
};

std::set<std::string> material_names(const render::Body& body) {
  std::set<std::string> names;
  for (const render::BodyPart& part : body.parts) {
    names.insert(part.material.name);
  }
  return names;
}

std::string material_names(const render::World& world) {
  std::set<std::string> names;
  for (const render::Body& body : world.bodies) {
    names.merge(material_names(body));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// ", scale 0.001" if a mesh of the body was scaled, else "".
std::string scale_text(const render::Body& body) {
  for (const render::BodyPart& part : body.parts) {
    const glm::dvec3& s = part.scale;
    if (s != glm::dvec3(1.0)) {
      return s.x == s.y && s.y == s.z ? fmt::format(", scale {:.4g}", s.x)
                                      : fmt::format(", scale {:.4g} {:.4g} {:.4g}", s.x, s.y, s.z);
    }
  }
  return "";
}

/// Extents of a body's mesh files along its axes, in metres. The parts of one file share one place.
/// @param wanted selects the parts that count
template <typename Wanted>
std::vector<glm::dvec3> mesh_sizes(const render::Body& body, const Wanted& wanted) {
  render::World meshes;
  for (const render::BodyPart& part : body.parts) {
    if (!part.is_mesh_file || !wanted(part)) {
      continue;
    }
    const auto is_in_its_place = [&](const render::Body& mesh) {
      const render::Pose& T = mesh.parts.front().T_body_part;
      return T.position_m == part.T_body_part.position_m && T.orientation == part.T_body_part.orientation;
    };
    auto mesh = std::ranges::find_if(meshes.bodies, is_in_its_place);
    if (mesh == meshes.bodies.end()) {
      mesh = meshes.bodies.insert(mesh, render::Body{});
    }
    mesh->parts.push_back(part);
  }
  std::vector<glm::dvec3> sizes;
  for (const BodyBox& box : boxes_of(meshes)) {
    sizes.push_back(box.max_m - box.min_m);
  }
  return sizes;
}

bool is_unscaled(const render::BodyPart& part) {
  return part.scale == glm::dvec3(1.0);
}

bool is_made_small(const render::BodyPart& part) {
  return glm::all(glm::lessThan(glm::abs(part.scale), glm::dvec3(0.1)));
}

/// A hint that mesh files have the wrong unit (SDF uses metres); "" if their extents look right. A seabed or
/// a pipeline of kilometres is usual: its height is far less than its length.
std::string unit_hint(const render::Body& body) {
  constexpr double large_m = 2000.0;
  constexpr double small_m = 0.005;
  constexpr double flat = 0.2;
  const bool has_scaled_sibling = std::ranges::any_of(body.parts, is_made_small);
  const auto is_in_millimetres = [&](const glm::dvec3& size) {
    const double longest = std::max({size.x, size.y, size.z});
    return longest > large_m && (size.z > flat * longest || has_scaled_sibling);
  };
  if (std::ranges::any_of(mesh_sizes(body, is_unscaled), is_in_millimetres)) {
    return "is its mesh in millimetres? If so, add <scale>0.001 0.001 0.001</scale>";
  }
  const auto is_tiny = [](const glm::dvec3& size) { return glm::length(size) < small_m; };
  return std::ranges::any_of(mesh_sizes(body, is_made_small), is_tiny) ? "is its mesh scaled twice?" : "";
}

/// Adds lines such as "body     pier: 4.0 x 4.0 x 20.0 m at (10.0, 0.0, -10.0), concrete" for the first
/// bodies.
void Check::list_bodies(const render::World& world) {
  constexpr std::size_t most = 50;
  const std::vector<BodyBox> boxes = boxes_of(world);
  for (std::size_t i = 0; i < std::min(most, world.bodies.size()); ++i) {
    const render::Body& body = world.bodies[i];
    // Rounded to the micrometre: rotated bodies are off in the last digit and would print as 2e-16.
    const auto rounded = [](const glm::dvec3& length_m) { return 1e-6 * glm::round(1e6 * length_m); };
    const glm::dvec3 size = rounded(boxes[i].max_m - boxes[i].min_m);
    const glm::dvec3 middle = rounded(body.T_world_body * (0.5 * (boxes[i].min_m + boxes[i].max_m)));
    if (body.parts.empty()) {
      continue;
    }
    report_.summary.push_back(
        fmt::format("body     {}: {:.4g} x {:.4g} x {:.4g} m at ({:.4g}, {:.4g}, {:.4g}), {}{}", body.name,
                    size.x, size.y, size.z, middle.x, middle.y, middle.z,
                    fmt::join(material_names(body), ", "), scale_text(body)));
    if (const std::string hint = unit_hint(body); !hint.empty()) {
      warning("world.file", fmt::format("body '{}' is {:.4g} x {:.4g} x {:.4g} m: {}", body.name, size.x,
                                        size.y, size.z, hint));
    }
  }
  if (world.bodies.size() > most) {
    report_.summary.push_back(fmt::format("         and {} more bodies", world.bodies.size() - most));
  }
}

/// Start pose of the vehicle and the key that sets it; nullopt if only live poses give it.
std::optional<FirstPose> Check::start() const {
  if (config_.poses.T_world_vehicle_initial) {
    return FirstPose{"poses.initial", *config_.poses.T_world_vehicle_initial};
  }
  for (const std::shared_ptr<const PoseInput>& input : config_.poses.inputs) {
    if (std::optional<FirstPose> first = input->first_pose()) {
      return first;
    }
  }
  return std::nullopt;
}

/// Reports each head's view from the start pose, and the time that a ping takes there.
void Check::check_start(const render::World& world) {
  if (config_.engine == render::EngineKind::gpu) {
    for (const HeadConfig& head : config_.heads) {
      const std::string lost = render::missed_by_grid(usual_settings(head));
      if (!lost.empty()) {
        warning("engine", fmt::format("head '{}': {}", head.name, lost));
      }
    }
  }
  const std::optional<FirstPose> beginning = start();
  TrialPings pings(config_, world);
  for (std::size_t i = 0; i < config_.heads.size(); ++i) {
    report_.summary.push_back(
        fmt::format("looks    {}: {}", config_.heads[i].name,
                    pings.view(i, beginning ? std::optional(beginning->T_world_vehicle) : std::nullopt)));
  }
  if (!beginning) {
    return;
  }
  const auto& [key, T_world_vehicle] = *beginning;
  for (std::size_t i = 0; i < config_.heads.size(); ++i) {
    const bool by_mount = glm::length(config_.heads[i].T_vehicle_sonar.position_m) > longest_arm_m;
    const std::string cause = by_mount ? fmt::format("heads[{}].mount.position_m", i) : key;
    for (const Finding& finding : pings.ping(i, T_world_vehicle)) {
      warning(cause, fmt::format("head '{}': {}", config_.heads[i].name, finding.text));
    }
    report_cost(config_.heads[i], pings.cost_ms(i, T_world_vehicle), world.triangle_count());
  }
}

void Check::report_cost(const HeadConfig& head, double ms, std::size_t triangles) {
  constexpr double slow_ms = 60.0;
  constexpr std::size_t many_triangles = 1'000'000;
  const std::string cost = fmt::format("a ping to {:.4g} m takes about {:.{}f} ms on this machine's CPU",
                                       usual_settings(head).range.max_range_m(), ms, ms < 10.0 ? 1 : 0);
  report_.summary.push_back(fmt::format("cost     {}: {}", head.name, cost));
  report_.cost_ms[head.name] = ms;
  if (ms > slow_ms && triangles > many_triangles) {
    warning("world.file", fmt::format("head '{}': {}, with {} triangles in the world. To make it faster, use "
                                      "a heightmap for the ground (docs/worlds.md) or coarser meshes",
                                      head.name, cost, triangles));
  }
}

void Check::check_world() {
  try {
    report_.world = std::make_shared<const render::World>(read_world(config_.world));
    const render::World& world = *report_.world;
    for (const std::string& line : world.warnings) {
      warning("world.file", line);
    }
    report_.summary.push_back(
        fmt::format("world    {}: {} {}, {} triangles, {}", world.name, world.bodies.size(),
                    world.bodies.size() == 1 ? "body" : "bodies", world.triangle_count(),
                    world.triangle_count() > 0 ? "materials: " + material_names(world)
                                               : "images contain only noise and water clutter"));
    if (world.origin) {
      report_.summary.push_back(fmt::format("origin   latitude {:.7f}, longitude {:.7f}, altitude {:.2f} m",
                                            world.origin->latitude_deg, world.origin->longitude_deg,
                                            world.origin->altitude_m));
    }
    for (const std::string& line : world.maps) {
      report_.summary.push_back("map      " + line);
    }
    list_bodies(world);
    const render::MeshDiagnostics& d = world.diagnostics;
    if (d.degenerate_triangles + d.non_finite_triangles + d.bad_normals + d.bad_texcoords > 0) {
      report_.summary.push_back(
          fmt::format("         repaired: {} degenerate and {} non-finite triangles dropped, {} normals and "
                      "{} texture coordinates",
                      d.degenerate_triangles, d.non_finite_triangles, d.bad_normals, d.bad_texcoords));
    }
    for (const std::string& line : world.left_out) {
      report_.summary.push_back("         left out: " + line);
    }
    for (const render::WorldSonar& sonar : world.sonars) {
      report_.summary.push_back(fmt::format("sonar    {}: {} of the world", sonar.path, sonar.type));
    }
    for (const ConfigProblem& found : resolve_mounts(config_, world)) {
      problem(found.key, found.message);
    }
    try {
      check_start(world);
    } catch (const render::RequestError&) {
      // Bad sampling; check_head() reports it.
    }
    if (!config_.world.vehicle_model.empty()) {
      report_.summary.push_back(fmt::format("vehicle  model {} of the world", config_.world.vehicle_model));
    }
  } catch (const render::WorldError& error) {
    for (const std::string& line : error.warnings) {
      warning("world.file", line);
    }
    problem("world.file", error.what());
    for (const std::string& line : error.more) {
      problem("world.file", line);
    }
  }
}

void Check::check_recording() {
  if (!config_.recording) {
    return;
  }
  const RecordingConfig& recording = *config_.recording;
  try_folder(recording.directory, "recording.directory");
  const bool has_glf = recording.glf && std::ranges::any_of(config_.heads, [](const HeadConfig& head) {
                         return glf_device(*head.type) != nullptr;
                       });
  const bool has_sonar = recording.sonar && std::ranges::any_of(config_.heads, [](const HeadConfig& head) {
                           return dynamic_cast<const PacketLogDevice*>(head.type) != nullptr;
                         });
  report_.summary.push_back(fmt::format("records  into {}:{}{}{}{}", recording.directory.string(),
                                        has_glf ? " glf" : "", recording.mcap ? " mcap" : "",
                                        recording.pcapng ? " pcapng" : "", has_sonar ? " sonar" : ""));
}

/// Writes a temporary file into the folder, or into its nearest existing parent.
void Check::try_folder(const std::filesystem::path& folder, const std::string& key) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::path there = fs::absolute(folder, error);
  while (!fs::exists(there, error) && there.has_relative_path()) {
    there = there.parent_path();
  }
  if (!fs::is_directory(there, error)) {
    problem(key, fmt::format("{} is not a folder (expected a folder, or a path that does not exist yet)",
                             there.string()));
    return;
  }
  std::string name = (there / ".sonard-check-XXXXXX").string();
  const int file = mkstemp(name.data());
  const bool written = file >= 0 && ::write(file, "x", 1) == 1;
  const int why = errno;
  if (file >= 0) {
    ::close(file);
    fs::remove(name, error);
  }
  if (!written) {
    problem(key,
            fmt::format("cannot write into {}: {}", there.string(), std::generic_category().message(why)));
    return;
  }
  const fs::space_info space = fs::space(there, error);
  if (!error && space.available < least_space) {
    warning(key, fmt::format("only {} MB are free in {}: free more space or choose another folder",
                             space.available / 1'000'000, there.string()));
  }
}

void Check::check_poses() {
  const PoseConfig& poses = config_.poses;
  std::vector<std::string> sources;
  if (poses.T_world_vehicle_initial) {
    sources.emplace_back("initial pose");
  }
  for (const std::shared_ptr<const PoseInput>& input : poses.inputs) {
    try {
      sources.push_back(input->summary());
    } catch (const Error& error) {
      problem(error.where, error.what());
    }
  }
  report_.summary.push_back(fmt::format("engine   {}", render::name_of(config_.engine)));
  report_.summary.push_back(fmt::format("poses    {}", fmt::join(sources, ", ")));
}

/// The end of a head's line in the summary.
std::string rest_text(const HeadConfig& head) {
  const render::SonarSettings& acoustics = head.acoustics;
  return fmt::format("mode {}, absorption {:.1f} dB/km{}{}",
                     acoustics.model == render::Model::paper ? "paper" : "physical",
                     1000.0 * acoustics.physical.absorption_db_per_m,
                     head.mount_from_world.empty() ? "" : ", mounted at " + head.mount_from_world,
                     head.hides_vehicle ? ", vehicle hidden" : "");
}

void Check::check_head(std::size_t index) {
  const HeadConfig& head = config_.heads[index];
  report_.summary.push_back(fmt::format("head     {}: {}, {}, {}", head.name, head.type->title(),
                                        head.type->summary(head), rest_text(head)));
  try {
    check_sampling_of(head);
  } catch (const render::RequestError& error) {
    problem("sampling", fmt::format("head '{}': {}", head.name, error.what()));
  }
  if (head.dump_directory) {
    try_folder(*head.dump_directory, fmt::format("heads[{}].dump.directory", index));
  }
}

/// Connects as the daemon does: sockets, pseudo terminals and their links.
void Check::try_connecting(std::size_t head) {
  try {
    asio::io_context io;
    const SteadyClock clock;
    type_of(config_.heads[head]).connect(config_.heads[head], io, clock);
  } catch (const SocketError& error) {
    problem(fmt::format("heads[{}].{}", head, trouble_of(error, type_of(config_.heads[head])).key),
            error.what());
  }
}

void Check::check_addresses() {
  const std::size_t problems_before = report_.problems.size();
  for (const PlannedSocket& socket : planned_sockets(config_)) {
    if (const std::optional<std::string> why = obstacle_to_binding(socket)) {
      problem(socket.key, *why);
    }
  }
  for (std::size_t i = 0; i < config_.heads.size(); ++i) {
    if (report_.problems.size() == problems_before) {
      try_connecting(i);
    }
    for (const ConfigWarning& found : config_.heads[i].type->network_warnings(config_.heads[i])) {
      warning(fmt::format("heads[{}].{}", i, found.key), found.message);
    }
  }
}

}  // namespace

CheckReport check_config(const LoadedConfig& loaded, bool try_addresses) {
  return Check(loaded).run(try_addresses);
}

}  // namespace sonard::server
