// SPDX-License-Identifier: Apache-2.0
#include "server/config/loader.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "renderer/acoustics/water.hpp"
#include "server/config/overlaps.hpp"
#include "server/heads/head_section.hpp"
#include "server/pose/section.hpp"
#include "server/pose/types/types.hpp"
#include "server/recording/section.hpp"
#include "server/web/section.hpp"
#include "server/yaml/yaml_section.hpp"
#include "server/yaml/yaml_trouble.hpp"
#include "server/yaml/yaml_unclosed.hpp"

namespace sonard::server {
namespace {

constexpr std::uintmax_t most_bytes = 4 << 20;  // 1000 times our own files; more takes minutes to parse

std::string read_file(const std::filesystem::path& file) {
  const auto fail = [&](const std::error_code& cause) {
    throw ConfigError(file,
                      {{{}, "", fmt::format("cannot be read: {} (expected a YAML file)", cause.message())}});
  };
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) {
    fail(std::make_error_code(std::errc::is_a_directory));
  }
  if (const std::uintmax_t bytes = std::filesystem::file_size(file, ignored);
      !ignored && bytes > most_bytes) {
    throw ConfigError(file,
                      {{{}, "", fmt::format("is {} bytes long (expected at most {})", bytes, most_bytes)}});
  }
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    fail({errno, std::generic_category()});
  }
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Collects the start of each document of a text.
class DocumentStarts : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override { marks.push_back(mark); }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
  }
  void OnMapEnd() override {}

  std::vector<YAML::Mark> marks;
};

/// The number of documents: 0, 1, or 2 if there are more. (YAML::LoadAll() never ends for a text that begins
/// with a comma.)
/// @throws YAML::Exception
int count_documents(const std::string& text) {
  std::istringstream in(text);
  YAML::Parser parser(in);
  DocumentStarts starts;
  while (starts.marks.size() < 2 && parser.HandleNextDocument(starts)) {
  }
  if (starts.marks.size() == 2 && starts.marks[0].pos == starts.marks[1].pos) {
    throw YAML::ParserException(starts.marks[1], "this character cannot begin a value");
  }
  return static_cast<int>(starts.marks.size());
}

YAML::Node parse_yaml(const std::filesystem::path& file, const std::string& text) {
  try {
    if (const int documents = count_documents(text); documents != 1) {
      throw ConfigError(file,
                        {{{}, "", fmt::format("contains {} YAML documents (expected one)", documents)}});
    }
    YAML::Node document = YAML::Load(text);
    if (const auto endless = find_endless_quote(text)) {
      throw ConfigError(file, {*endless});
    }
    return document;
  } catch (const YAML::Exception& error) {
    throw ConfigError(file, {yaml_trouble(text, position_of(error.mark), error.msg)});
  }
}

void read_log(YamlSection& section, LogConfig& log) {
  section.choice("level", log.level,
                 {{"trace", LogLevel::trace},
                  {"debug", LogLevel::debug},
                  {"info", LogLevel::info},
                  {"warn", LogLevel::warn},
                  {"error", LogLevel::error}},
                 "minimum severity; `--log-level` overrides it");
  section.choice("format", log.format, {{"text", LogFormat::text}, {"json", LogFormat::json}},
                 "`json`: [an object per line](deploy.md#logs-for-programs)");
}

void read_world(YamlSection& section, const std::filesystem::path& folder, WorldConfig& world) {
  section.path("file", world.file, folder, "SDF file of the world ([worlds.md](worlds.md))");
  section.default_is("file", "**required**, unless `empty` is true");
  section.boolean(
      "empty", world.open_water,
      "true: the world may have no surface, as in open water. Images then contain only noise and water "
      "clutter. Without `file`, the world is only water. `world: empty` is short for `world: {empty: true}`");
  if (!world.open_water && !section.describing()) {
    section.require("file", "an SDF world; for open water, empty: true");
  }
  section.choice("missing", world.skips_missing_files, {{"error", false}, {"skip", true}},
                 "missing files: `error` stops, `skip` omits meshes and includes with a warning");
  section.integer("max_triangles", world.max_triangles, 1, 2'000'000'000,
                  "maximum number of triangles, counting each use of a mesh");
  section.text("vehicle_model", world.vehicle_model,
               "model that is the vehicle; its frame is the vehicle frame. Poses of this body in the stream "
               "have no effect");
  section.default_is("vehicle_model",
                     "the model with the sonars of `mount.from_world`; no model if no head has `from_world`");
  section.section("origin", "position of (0, 0, 0) on Earth ([worlds.md](worlds.md#place-on-earth))",
                  [&](YamlSection& inner) {
                    render::GeographicOrigin& origin = world.origin.emplace();
                    inner.require("latitude_deg", "degrees, WGS 84, north is positive");
                    inner.require("longitude_deg", "degrees, WGS 84, east is positive");
                    inner.number("latitude_deg", origin.latitude_deg, Range::from(-90.0, 90.0),
                                 "WGS 84 latitude; north is positive");
                    inner.number("longitude_deg", origin.longitude_deg, Range::from(-180.0, 180.0),
                                 "WGS 84 longitude; east is positive");
                    inner.number("altitude_m", origin.altitude_m, Range::from(-12'000.0, 9'000.0),
                                 "altitude of z = 0 in the datum of the map, or above mean sea level");
                  });
}

render::Water properties(const WaterConfig& water) {
  return {water.temperature_c, water.salinity_ppt, water.depth_m, water.ph};
}

/// Sets the water and the values that heads derive from it.
void read_water(YamlSection& section, HeadContext& context) {
  section.introduce(
      "These keys set the absorption (Francois & Garrison 1982, at the frequency of each head). With "
      "`sound_speed_mps: computed` they also set the true speed of sound (Mackenzie 1981; Medwin 1975 "
      "outside 2 to 30 degrees Celsius or 25 to 40 ppt).");
  WaterConfig& water = context.water;
  section.number("temperature_c", water.temperature_c, Range::from(-4.0, 45.0),
                 "water temperature, degrees Celsius");
  section.number("salinity_ppt", water.salinity_ppt, Range::from(0.0, 50.0),
                 "salinity, parts per thousand; 0 is fresh water");
  section.number("depth_m", water.depth_m, Range::from(0.0, 11'000.0),
                 "water depth for these formulas; it does not follow the vehicle");
  section.number("ph", water.ph, Range::from(5.0, 10.0), "acidity; it has little effect above 100 kHz");
  double absorption_db_per_km = -1.0;
  section.number_or_word(
      "absorption_db_per_km", absorption_db_per_km, Range::from(0.0, 10'000.0), {{"computed", -1.0}},
      "one-way absorption. Outside -2 to 30 degrees Celsius or 30 to 35 ppt, `computed` is an extrapolation");
  context.absorption_db_per_m = absorption_db_per_km < 0.0 ? -1.0 : absorption_db_per_km / 1000.0;
  section.number_or_word(
      "sound_speed_mps", context.water_sound_speed_mps, Range::from(1000.0, 2000.0),
      {{"ping_configuration", 0.0}, {"computed", render::sound_speed_mps(properties(water))}},
      "true speed of sound. `ping_configuration`: the speed that the client assumes (1500 m/s if it sends "
      "none), so its ranges are correct. With other values, ranges are wrong by the ratio of the speeds, as "
      "at sea");
  section.number("sound_speed_gradient_per_s", water.sound_speed_gradient_per_s, Range::from(-10.0, 10.0),
                 "increase of the sound speed with height (m/s per m). 0: straight rays. 0.5 to 1.8 is warm "
                 "water above cold: rays bend down, and the bed appears nearer. With a gradient, sonard "
                 "subdivides facets ([acoustics.md](acoustics.md#refraction))");
}

void read_sampling(YamlSection& section, render::Sampling& sampling, bool& adaptive_quality) {
  section.introduce(
      "sonard divides the fan as finely as this error requires. [accuracy.md](accuracy.md) lists measured "
      "errors, [benchmark.md](benchmark.md) the cost.");
  using Preset = render::Sampling::Preset;
  section.choice("preset", sampling.preset,
                 {{"fast", Preset::fast},
                  {"default", Preset::normal},
                  {"reference", Preset::reference},
                  {"grid", Preset::grid}},
                 "target error: `fast` 5 %, `default` 1.25 %, `reference` as small as possible (for offline "
                 "use); `grid`: a fixed grid of samples");
  section.integer("views", sampling.views, 1, 32,
                  "only with `grid`: number of views across the fan; more if one would exceed 60 degrees");
  section.integer("columns_per_view", sampling.columns_per_view, 8, 4096,
                  "only with `grid`: pixels of one view across the fan");
  section.integer("rows", sampling.rows, 8, 4096, "only with `grid`: pixels over the elevation of the fan");
  section.choice("adaptive_quality", adaptive_quality, {{"off", false}, {"on", true}},
                 "`on`: while a client requests more pings than this machine can render, sonard uses a "
                 "faster preset, and logs each change. Images then depend on the load of the machine. "
                 "Invalid with `grid`; no effect in simulated time (`poses.clock`)");
  if (sampling.preset == Preset::grid && adaptive_quality) {
    section.report("adaptive_quality", "a grid has no faster preset (expected off, or another `preset`)");
  }
  if (sampling.preset != Preset::grid) {
    for (const char* key : {"views", "columns_per_view", "rows"}) {
      if (section.has(key)) {
        section.report(key, "the preset chooses the samples (expected this key only with `preset: grid`)");
      }
    }
  }
}

void read_gpu(YamlSection& section, render::GpuOptions& gpu) {
  section.introduce("They also apply if `auto` selects the GPU ([gpu.md](gpu.md)).");
  section.text("device", gpu.device,
               "EGL device: its number, or a part of its name, in the list of `sonard selftest`. Default: "
               "hardware before software, then the device with the most memory");
  section.integer("memory_mib", gpu.memory_mib, 1, 1'048'576,
                  "video memory for meshes and normal maps in MiB, for each renderer. All fans share one "
                  "renderer, all scanning heads another. If the data of one ping do not fit, the CPU renders "
                  "it ([engines](../renderer/engines/README.md#video-memory))");
  section.number("retry_s", gpu.retry_s, Range::from(0.0, 86'400.0),
                 "time between attempts to use a lost GPU again, each during a ping, which waits for it; 0: "
                 "the CPU renders until the daemon ends");
}

void read_skip(YamlSection& section, render::SkipSwitches& skip) {
  section.introduce("[skipping.md](skipping.md) lists them and their bounds.");
  std::vector<std::string_view> names;
  for (const render::SkipRuleEntry& entry : render::skip_rules) {
    names.push_back(entry.name);
  }
  const std::string expected = fmt::format("one of {}", fmt::join(names, ", "));
  const std::string schema = fmt::format(R"("enum": ["{}"])", fmt::join(names, R"(", ")"));
  std::vector<render::SkipRule> off;
  section.renamed_value("off", "lines_without_echo", "bins_without_echo");
  section.renamed_value("off", "long_lines", "long_bins");
  section.renamed_value("off", "even_lines", "even_bins");
  section.parsed_list("off", off, &render::skip_rule_named, {expected, "rules", schema},
                      "rules that do not apply; sonard does the work that they would skip");
  for (const render::SkipRule rule : off) {
    skip.turn_off(rule);
  }
}

void read_document(YamlSection& root, std::span<const HeadType* const> types, DaemonConfig& config) {
  HeadContext context;
  context.folder = config.file.parent_path();
  root.section("log", "level and format of the log",
               [&](YamlSection& section) { read_log(section, config.log); });
  root.require("world", "a mapping with the world's file, or `empty` for open water");
  const std::string_view word = root.word("world");
  const bool is_open_water = word == "empty";
  if (is_open_water || root.describing()) {
    root.choice("world", config.world.open_water, {{"empty", true}},
                "scene around the vehicle; `empty` is open water");
  }
  if (!is_open_water && !word.empty()) {
    root.report("world", fmt::format("is {} (expected a mapping such as {{file: sea.sdf}}, or empty for "
                                     "open water)",
                                     in_quotes(word)));
  } else if (!is_open_water) {
    root.section("world", "scene around the vehicle; `empty` is open water",
                 [&](YamlSection& section) { read_world(section, context.folder, config.world); });
  }
  root.choice("engine", config.engine,
              {{"auto", render::EngineKind::automatic},
               {"gpu", render::EngineKind::gpu},
               {"cpu", render::EngineKind::cpu}},
              "renderer: `gpu` uses OpenGL 4.5, `cpu` needs none. `auto` renders the first ping of each head "
              "with both, uses the faster one, and logs both times; it selects the CPU if OpenGL runs in "
              "software. If a GPU fails, the CPU continues with the same ping. Images of both agree within "
              "[the error of the preset](accuracy.md)");
  root.section("gpu", "settings of engine `gpu`",
               [&](YamlSection& section) { read_gpu(section, config.gpu); });
  if (config.engine == render::EngineKind::cpu) {
    root.warn_if_given("gpu", "the engine is `cpu`");
  }
  root.retired("backend", "write `engine: gpu` for raster, `engine: cpu` for ray, `engine: auto` for auto");
  root.retired("gpu_binning", "remove it; engine `gpu` always bins on the GPU");
  root.section("skip", "rules that skip unnecessary work",
               [&](YamlSection& section) { read_skip(section, config.skip); });
  root.section("water", "properties of the water",
               [&](YamlSection& section) { read_water(section, context); });
  context.water.sound_speed_mps = render::sound_speed_mps(properties(context.water));
  config.water = context.water;
  root.require("poses", "a mapping with the sources of the vehicle's pose");
  root.section("poses", "sources of the vehicle's pose", [&](YamlSection& section) {
    config.poses = read_poses(section, pose_source_types(), context.folder);
  });
  context.simulated_time = config.poses.clock != PingClock::wall;
  root.section("sampling", "target error of the images", [&](YamlSection& section) {
    read_sampling(section, context.sampling, context.adaptive_quality);
    if (context.simulated_time && context.adaptive_quality) {
      section.warn_if_given("adaptive_quality", "pings follow the stamps of the poses (`poses.clock`)");
    }
  });
  root.section("recording", "logs of the heads' data; without this section, sonard records no logs",
               [&](YamlSection& section) { config.recording = read_recording(section, context.folder); });
  root.section("web", "web page for viewing, and metrics; without this section, there is no page",
               [&](YamlSection& section) { config.web = read_web(section); });
  root.require("heads", "a list of sonar heads");
  root.sections("heads", "sonar heads, one or more",
                [&](YamlSection& section) { config.heads.push_back(read_head(section, context, types)); });
  if (root.is_list("heads") && config.heads.empty()) {
    root.report("heads", "no head is listed (expected at least one)");
  }
}

/// The type of the head that holds a key; empty outside of heads.
std::string head_type_of(const std::string& key, const std::vector<HeadConfig>& heads) {
  constexpr std::string_view front = "heads[";
  std::size_t number = 0;
  if (!key.starts_with(front) ||
      std::from_chars(key.data() + front.size(), key.data() + key.size(), number).ec != std::errc() ||
      number >= heads.size() || heads[number].type == nullptr) {
    return {};
  }
  return std::string(heads[number].type->name());
}

void name_sections(YamlFindings& findings, std::span<const HeadType* const> types,
                   const std::vector<HeadConfig>& heads) {
  if (findings.unknown_keys.empty() && findings.words_for_mappings.empty()) {
    return;
  }
  std::vector<TypeKeys> known;
  known.reserve(types.size());
  for (const HeadType* const type : types) {
    known.push_back({std::string(type->name()), describe_config(*type)});
  }
  for (UnknownKey& key : findings.unknown_keys) {
    key.head_type = head_type_of(findings.problems[key.problem].key, heads);
  }
  name_sections(findings.problems, findings.unknown_keys, known);
  for (WordForMapping& word : findings.words_for_mappings) {
    word.head_type = head_type_of(findings.problems[word.problem].key, heads);
  }
  name_keys(findings.problems, findings.words_for_mappings, known);
}

}  // namespace

std::string read_config(const std::filesystem::path& file) {
  return read_file(file);
}

LoadedConfig load_config(const std::filesystem::path& file, std::span<const HeadType* const> types) {
  return load_config(file, read_file(file), types);
}

LoadedConfig load_config(const std::filesystem::path& file, const std::string& text,
                         std::span<const HeadType* const> types) {
  const YAML::Node document = parse_yaml(file, text);
  YamlFindings findings;
  LoadedConfig loaded;
  loaded.config.file = file;
  {
    YamlSection root(findings, document, "");
    read_document(root, types, loaded.config);
  }
  name_sections(findings, types, loaded.config.heads);
  if (findings.problems.empty()) {
    findings.problems = find_overlaps(loaded.config, findings.positions);
  }
  if (findings.problems_left_out > 0) {
    findings.problems.push_back({findings.problems.back().at, "",
                                 fmt::format("{} more problems are not shown", findings.problems_left_out)});
  }
  if (!findings.problems.empty()) {
    throw ConfigError(file, std::move(findings.problems));
  }
  loaded.positions = std::move(findings.positions);
  for (const ConfigWarning& warning : findings.warnings) {
    loaded.warnings.push_back(loaded.problem_at(warning.key, warning.message));
  }
  return loaded;
}

std::vector<KeyReference> describe_config(const HeadType& type) {
  YamlFindings findings;
  findings.describing = true;
  DaemonConfig config;
  YamlSection root(findings, YAML::Node(YAML::NodeType::Map), "");
  read_document(root, std::array{&type}, config);
  return root.known();
}

std::string LoadedConfig::problem_with(std::string_view key, const std::string& message) const {
  return problem_text(config.file, problem_at(key, message));
}

ConfigProblem LoadedConfig::problem_at(std::string_view key, const std::string& message) const {
  return {nearest_position(positions, key), std::string(key), message};
}

}  // namespace sonard::server
