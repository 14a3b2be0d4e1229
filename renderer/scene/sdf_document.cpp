// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/sdf_document.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <map>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml2.h>

#include "common/text/lower_case.hpp"
#include "common/text/printable.hpp"
#include "renderer/scene/fuel_cache.hpp"
#include "renderer/scene/grouped_warnings.hpp"
#include "renderer/scene/local_file.hpp"
#include "renderer/scene/sdf_elements.hpp"
#include "renderer/scene/sdf_frames.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {
namespace {

namespace fs = std::filesystem;

// Ten thousand models of a hundred elements; they take about 300 MB while the world is read.
constexpr std::size_t most_elements = 1'000'000;
constexpr std::uintmax_t most_bytes = 256U << 20U;  // of one file

/// Compares major and minor separately: "1.10" is newer than "1.9".
std::pair<int, int> version_of(std::string_view text) {
  std::pair<int, int> version{0, 0};
  const std::size_t dot = text.find('.');
  std::from_chars(text.data(), text.data() + std::min(dot, text.size()), version.first);
  if (dot != std::string_view::npos) {
    std::from_chars(text.data() + dot + 1, text.data() + text.size(), version.second);
  }
  return version;
}

/// Returns the name with the prefix "sonard:" if the file binds its prefix to our namespace, as XML allows.
/// @param default_namespace whether `name` belongs to an element, to which xmlns="..." applies
std::string with_own_prefix(const char* name, const tinyxml2::XMLElement& element, bool default_namespace) {
  const std::string_view given = name;
  const std::size_t colon = given.find(':');
  if (colon == std::string_view::npos) {
    const char* const bound = default_namespace ? element.Attribute("xmlns") : nullptr;
    return bound != nullptr && is_own_namespace(bound) ? fmt::format("sonard:{}", given) : std::string(given);
  }
  const std::string declaration = fmt::format("xmlns:{}", given.substr(0, colon));
  for (const tinyxml2::XMLNode* node = &element; node != nullptr; node = node->Parent()) {
    const auto* const around = node->ToElement();
    const char* const bound = around == nullptr ? nullptr : around->Attribute(declaration.c_str());
    if (bound != nullptr) {
      return is_own_namespace(bound) ? fmt::format("sonard:{}", given.substr(colon + 1)) : std::string(given);
    }
  }
  return std::string(given);
}

/// In SDF, a line break is the same as a blank.
std::string one_line(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
  return printable(text);
}

/// The model name in a URI: "post" of "model://post/model.sdf".
std::string model_name_in(std::string_view uri) {
  if (const auto fuel = parse_fuel_uri(uri)) {
    return fuel->name;
  }
  if (uri.ends_with(".sdf")) {
    uri = uri.substr(0, uri.find_last_of('/'));
  }
  while (uri.ends_with('/')) {
    uri.remove_suffix(1);
  }
  return std::string(uri.substr(uri.find_last_of('/') + 1));
}

/// Whether the name of a model is one of a light or a sky.
bool is_light(std::string_view model_name) {
  constexpr std::array<std::string_view, 12> lights{
      "sun", "sunlight", "sun_light",         "moon",        "light",      "lights",
      "sky", "skybox",   "directional_light", "point_light", "spot_light", "ambient_light"};
  std::string name = lower_case(model_name);
  std::ranges::replace_if(
      name, [](char c) { return c == ' ' || c == '-'; }, '_');
  return std::ranges::find(lights, name) != lights.end();
}

/// Reads each file once, and copies it for each include.
class SdfReader {
 public:
  SdfReader(UriResolver& resolver, MissingFiles missing, std::vector<std::string>& warnings,
            WorldProblems& problems)
      : resolver_(resolver), missing_(missing), warnings_(warnings), problems_(problems) {}

  std::unique_ptr<SdfElement> read(const fs::path& world_file) {
    const Document& document = open(world_file);
    around_.push_back(world_file);
    auto root = copy(*document.root, document.file, nullptr);
    const std::vector<std::string> grouped = grouped_.lines();
    warnings_.insert(warnings_.end(), grouped.begin(), grouped.end());
    return root;
  }

 private:
  struct Document {
    std::unique_ptr<tinyxml2::XMLDocument> xml;
    const tinyxml2::XMLElement* root = nullptr;
    std::shared_ptr<const fs::path> file;
  };

  const Document& open(const fs::path& file);
  void check_version(const Document& document);
  std::unique_ptr<SdfElement> copy(const tinyxml2::XMLElement& from,
                                   const std::shared_ptr<const fs::path>& file, const SdfElement* parent);
  void include(const SdfElement& include, SdfElement& into);
  fs::path included_file(const SdfElement& include);
  void warn_of_others(const Document& document, const tinyxml2::XMLElement& used);
  void warn_of_ignored_children(const SdfElement& include);
  void do_without(const SdfElement& include, SdfElement& into, const std::string& why);
  static void override_with(const SdfElement& include, SdfElement& model);
  static void merge(SdfElement& model, SdfElement& into, const SdfElement& include);

  UriResolver& resolver_;
  const MissingFiles missing_;
  std::vector<std::string>& warnings_;
  WorldProblems& problems_;
  GroupedWarnings grouped_;  ///< of includes
  std::map<fs::path, Document> documents_;
  std::vector<fs::path> around_;  ///< files that are being copied, from the world's to the innermost
  std::size_t elements_ = 0;
};

const SdfReader::Document& SdfReader::open(const fs::path& file) {
  if (const auto known = documents_.find(file); known != documents_.end()) {
    return known->second;
  }
  require_readable(file);
  std::error_code ignored;
  if (fs::file_size(file, ignored) > most_bytes) {
    throw WorldError(
        fmt::format("{}: the file is larger than {} MiB, the maximum", file.string(), most_bytes >> 20U));
  }
  Document document{std::make_unique<tinyxml2::XMLDocument>(), nullptr,
                    std::make_shared<const fs::path>(file)};
  if (document.xml->LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS) {
    std::string_view name = document.xml->ErrorName();
    name.remove_prefix(name.starts_with("XML_") ? 4 : 0);
    throw WorldError(fmt::format("{}:{}: not well-formed XML ({})", file.string(),
                                 std::max(1, document.xml->ErrorLineNum()), name));
  }
  document.root = document.xml->RootElement();
  if (document.root == nullptr) {
    throw WorldError(fmt::format("{}: has no element (expected <sdf version=\"1.9\">)", file.string()));
  }
  const std::string root = one_line(document.root->Name());
  if (root != "sdf") {
    throw WorldError(fmt::format("{}:{}: <{}> is not SDF (expected <sdf version=\"1.9\">){}", file.string(),
                                 document.root->GetLineNum(), root,
                                 root == "robot" ? "; convert URDF with `gz sdf -p FILE`" : ""));
  }
  check_version(document);
  return documents_.emplace(file, std::move(document)).first->second;
}

void SdfReader::check_version(const Document& document) {
  const char* const given = document.root->Attribute("version");
  const auto place = [&] {
    return fmt::format("{}:{}", document.file->string(), document.root->GetLineNum());
  };
  if (given == nullptr) {
    warnings_.push_back(fmt::format("{}: <sdf> has no version: it is read as 1.12", place()));
  } else if (version_of(given) < std::pair{1, 3}) {
    throw WorldError(
        fmt::format("{}: SDF version {} is too old (expected 1.3 to 1.12); convert it with Gazebo Classic's "
                    "`gz sdf -c FILE`",
                    place(), one_line(given)));
  } else if (version_of(given) > std::pair{1, 12}) {
    warnings_.push_back(fmt::format("{}: SDF version {} is read as 1.12, the newest supported version",
                                    place(), one_line(given)));
  }
}

std::unique_ptr<SdfElement> SdfReader::copy(const tinyxml2::XMLElement& from,
                                            const std::shared_ptr<const fs::path>& file,
                                            const SdfElement* parent) {
  if (++elements_ > most_elements) {
    throw WorldError(
        fmt::format("{}: more than {} elements, includes among them: check whether includes multiply",
                    around_.front().string(), most_elements));
  }
  auto element = std::make_unique<SdfElement>();
  element->name = one_line(with_own_prefix(from.Name(), from, parent != nullptr));
  element->parent = parent;
  element->file = file;
  element->line = from.GetLineNum();
  for (const auto* given = from.FirstAttribute(); given != nullptr; given = given->Next()) {
    element->attributes.emplace_back(one_line(with_own_prefix(given->Name(), from, false)),
                                     one_line(given->Value()));
  }
  const bool may_include = element->name == "world" || element->name == "model" || element->name == "sdf";
  for (const auto* node = from.FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (const auto* text = node->ToText()) {
      element->text += text->Value();
    } else if (const auto* child = node->ToElement()) {
      auto made = copy(*child, file, element.get());
      if (may_include && made->name == "include") {
        include(*made, *element);
      } else {
        element->children.push_back(std::move(made));
      }
    }
  }
  element->text = trimmed(one_line(std::move(element->text)));
  return element;
}

/// The manifest, as in libsdformat: model.config, or manifest.xml in old models.
fs::path manifest_in(const fs::path& folder) {
  std::error_code error;
  const fs::path old = folder / "manifest.xml";
  return !fs::exists(folder / "model.config", error) && fs::exists(old, error) ? old
                                                                               : folder / "model.config";
}

/// The newest file that the model's manifest names, or model.sdf.
fs::path model_file_in(const fs::path& folder) {
  tinyxml2::XMLDocument manifest;
  fs::path newest = folder / "model.sdf";
  const fs::path manifest_file = manifest_in(folder);
  std::error_code error;
  if (!fs::is_regular_file(manifest_file, error) ||
      manifest.LoadFile(manifest_file.c_str()) != tinyxml2::XML_SUCCESS ||
      manifest.RootElement() == nullptr) {
    return newest;
  }
  std::pair<int, int> newest_version{-1, 0};
  const auto* sdf = manifest.RootElement()->FirstChildElement("sdf");
  for (; sdf != nullptr; sdf = sdf->NextSiblingElement("sdf")) {
    const char* const version = sdf->Attribute("version");
    const std::pair<int, int> its = version_of(version == nullptr ? "" : version);
    if (sdf->GetText() != nullptr && its > newest_version) {
      newest_version = its;
      newest = folder / trimmed(one_line(sdf->GetText()));
    }
  }
  return newest;
}

/// @throws WorldError without a position in the file
fs::path SdfReader::included_file(const SdfElement& include) {
  const SdfElement* const uri = include.child("uri");
  const fs::path found = resolver_.resolve(uri == nullptr ? "" : uri->text, include.folder());
  fs::path file = found;
  std::error_code error;
  if (fs::is_directory(found, error)) {
    require_reachable(manifest_in(found));
    resolver_.check_place(uri->text, fs::weakly_canonical(manifest_in(found)), found);
    file = model_file_in(found);
    if (manifest_in(found).filename() == "manifest.xml") {
      warnings_.push_back(
          fmt::format("{}: manifest.xml is out of date; rename it to model.config", found.string()));
    }
  }
  const fs::path canonical = fs::canonical(file, error);
  if (error || !fs::is_regular_file(canonical, error)) {
    require_reachable(file);
    throw MissingFile(fmt::format("'{}': file {} not found", uri->text, file.string()));
  }
  resolver_.check_place(uri->text, file, found);
  resolver_.check_place(uri->text, canonical, found);
  resolver_.add_model_folder(canonical.parent_path().parent_path());
  if (const auto fuel = parse_fuel_uri(uri->text)) {
    resolver_.name_model(fuel->name, canonical.parent_path());
  }
  if (const auto same = std::ranges::find(around_, canonical); same != around_.end()) {
    const auto from_world = [&](const fs::path& step) {
      return step.lexically_relative(around_.front().parent_path()).string();
    };
    std::vector<std::string> way;
    std::transform(same, around_.end(), std::back_inserter(way), from_world);
    throw WorldError(fmt::format("'{}' includes itself: {} -> {}", uri->text, fmt::join(way, " -> "),
                                 from_world(canonical)));
  }
  return canonical;
}

/// The element that is included: as in libsdformat, a model comes before an actor and a light. nullptr if
/// there is none.
const tinyxml2::XMLElement* content_of(const tinyxml2::XMLElement& sdf) {
  for (const char* const name : {"model", "world", "actor", "light"}) {
    if (const auto* const child = sdf.FirstChildElement(name)) {
      return child;
    }
  }
  return nullptr;
}

/// Warns of elements beside `used` that have, or might have, a surface.
void SdfReader::warn_of_others(const Document& document, const tinyxml2::XMLElement& used) {
  for (const auto* child = document.root->FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    const std::string_view kind = child->Name();
    if (child == &used || (kind != "model" && kind != "world" && kind != "actor")) {
      continue;
    }
    const char* const name = child->Attribute("name");
    warnings_.push_back(fmt::format(
        "{}:{}: {} '{}' is left out, because an include takes one {} from a file; move it to its own file",
        document.file->string(), child->GetLineNum(), kind, one_line(name == nullptr ? "" : name),
        used.Name()));
  }
}

/// Warns of children that have no effect. Elements of other programs ("gz:...") are their own business.
void SdfReader::warn_of_ignored_children(const SdfElement& include) {
  const SdfElement* const name = include.child(include.child("name") == nullptr ? "uri" : "name");
  for (const auto& child : include.children) {
    std::string kind;
    if (child->name == "experimental:params") {
      kind =
          "<experimental:params> of an include is not supported: its changes are not applied; make them in "
          "the file of the model";
    } else if (!is_known_child("include", child->name)) {
      kind = fmt::format("unknown element <{}> in <include>: it is left out", child->name);
    } else {
      continue;
    }
    grouped_.add(kind, child->place(), name == nullptr ? "" : name->text);
  }
}

void SdfReader::include(const SdfElement& include, SdfElement& into) {
  warn_of_ignored_children(include);
  try {
    const SdfElement* const new_name = include.child("name");
    if (new_name != nullptr && new_name->text.empty()) {
      throw WorldError(fmt::format("of '{}': its <name> is empty; write a name, or remove <name>",
                                   include.child("uri") == nullptr ? "" : include.child("uri")->text));
    }
    const fs::path file = included_file(include);
    const Document& document = open(file);
    const auto* const from = content_of(*document.root);
    if (from == nullptr) {
      throw WorldError(fmt::format("{} has no model", file.string()));
    }
    warn_of_others(document, *from);
    around_.push_back(file);
    auto included = copy(*from, document.file, &into);
    around_.pop_back();
    const bool renamed = include.child("name") != nullptr;
    included->inclusion = std::make_shared<const Inclusion>(
        Inclusion{include.place(), renamed ? "give it another <name>" : "give it a <name>"});
    if (SdfElement* const pose = included->child("pose")) {
      pose->inclusion = included->inclusion;
    }
    override_with(include, *included);
    if (included->name == "world" || is_true(include.attribute("merge"))) {
      merge(*included, into, include);
    } else {
      into.children.push_back(std::move(included));
    }
  } catch (const MissingFile& error) {
    do_without(include, into, error.what());
  } catch (const WorldError& error) {
    if (elements_ > most_elements) {
      throw;
    }
    problems_.add(fmt::format("{}: include {}", include.place(), error.what()));
  }
}

/// Puts a light or a frame in place of a missing model.
void SdfReader::do_without(const SdfElement& include, SdfElement& into, const std::string& why) {
  const SdfElement* const uri = include.child("uri");
  const SdfElement* const name = include.child("name");
  const std::string file_name = uri == nullptr ? "" : model_name_in(uri->text);
  const std::string given_name = name == nullptr ? file_name : name->text;
  const bool in_model = into.name == "model";
  if (is_light(file_name)) {
    if (!in_model) {
      into.add_child("light", include).set_attribute("name", given_name);
    }
    return;
  }
  if (missing_ == MissingFiles::skip) {
    grouped_.add(fmt::format("include {}", why), include.place(), given_name);
  } else {
    problems_.add(fmt::format("{}: include {}{}", include.place(), why, how_to_skip));
  }
  if (!in_model && into.name != "world") {
    return;
  }
  SdfElement& stands_for_it = into.add_child("frame", include);
  stands_for_it.is_missing = true;
  if (!is_true(include.attribute("merge"))) {
    stands_for_it.set_attribute("name", given_name);
  }
  for (const auto& child : include.children) {
    if (child->name == "pose" || child->name == "placement_frame") {
      stands_for_it.add_copy(*child);
    }
  }
}

/// Values of the include replace values of the model.
void SdfReader::override_with(const SdfElement& include, SdfElement& model) {
  if (const SdfElement* const name = include.child("name")) {
    model.set_attribute("name", name->text);
  }
  if (const SdfElement* const frame = include.child("placement_frame")) {
    model.set_attribute("placement_frame", frame->text);
  }
  for (const auto& child : include.children) {
    const bool replaces = child->name == "pose";
    const bool has_prefix = child->name.find(':') != std::string::npos;
    if (!replaces && child->name != "plugin" && !has_prefix) {
      continue;
    }
    if (replaces || child->name.starts_with("sonard:")) {
      std::erase_if(model.children, [&](const auto& known) { return known->name == child->name; });
    }
    model.add_copy(*child);
  }
}

/// Makes the frame `frame` the reference of a part that refers to its model's frame.
void place_by(const std::string& frame, SdfElement& part) {
  if (part.child("pose") == nullptr) {
    part.add_child("pose", part);
  }
  SdfElement& pose = *part.child("pose");
  const std::string* const relative = pose.attribute("relative_to");
  const std::string* const attached = part.attribute("attached_to");
  const bool by_default = relative == nullptr || relative->empty();
  const bool to_another = part.name == "joint" || (attached != nullptr && !attached->empty());
  if ((by_default && !to_another) || (!by_default && *relative == "__model__")) {
    pose.set_attribute("relative_to", frame);
  }
  if (attached != nullptr && *attached == "__model__") {
    part.set_attribute("attached_to", frame);
  }
}

/// The model's frame in its placement_frame; identity without a placement_frame.
Pose T_placement(const SdfElement& model) {
  const std::string* const frame = model.attribute("placement_frame");
  if (model.name != "model" || frame == nullptr || frame->empty()) {
    return {};
  }
  return inverse(SdfFrames().of_frame(model, *frame, model));
}

void write_pose(const Pose& T, const std::string& relative_to, SdfElement& element) {
  SdfElement& pose = element.add_child("pose", element);
  pose.set_attribute("relative_to", relative_to);
  pose.set_attribute("rotation_format", "quat_xyzw");
  const glm::dvec3& p = T.position_m;
  const glm::dquat& q = T.orientation;
  pose.text = fmt::format("{} {} {} {} {} {} {}", p.x, p.y, p.z, q.x, q.y, q.z, q.w);
}

/// The parts of a model become parts of the model or world around it. Their poses refer to a frame in place
/// of the model (SDF 1.9, <include merge="true">). Parts of a world become parts of the world around it.
void SdfReader::merge(SdfElement& model, SdfElement& into, const SdfElement& include) {
  const auto inclusion = std::make_shared<const Inclusion>(
      Inclusion{include.place(), fmt::format("rename it at {}, or include without merge", model.place())});
  const std::string frame = "_merged__" + model.given_name() + "__model__";
  const SdfElement* const material = model.child("sonard:material");
  if (model.name == "model") {
    const Pose T_placement_model = T_placement(model);
    const std::string placement = "_merged__" + model.given_name() + "__placement__";
    SdfElement& placed = into.add_child("frame", model);
    placed.set_attribute("name", placement);
    if (const SdfElement* const pose = model.child("pose")) {
      placed.add_copy(*pose).inclusion = pose->inclusion;
    }
    SdfElement& stands_for_it = into.add_child("frame", model);
    stands_for_it.set_attribute("name", frame);
    write_pose(T_placement_model, placement, stands_for_it);
  }
  for (auto& part : model.children) {
    if (part->name == "pose" || part->name == "static" || part.get() == material) {
      continue;
    }
    if (material != nullptr && part->name == "link" && part->child(material->name) == nullptr) {
      part->add_copy(*material);
    }
    part->parent = &into;
    part->inclusion = inclusion;
    const bool has_place =
        part->name == "link" || part->name == "frame" || part->name == "model" || part->name == "joint";
    if (model.name == "model" && has_place) {
      place_by(frame, *part);
    }
    into.children.push_back(std::move(part));
  }
}

}  // namespace

std::unique_ptr<SdfElement> read_sdf(const fs::path& world_file, UriResolver& resolver, MissingFiles missing,
                                     std::vector<std::string>& warnings, WorldProblems& problems) {
  return SdfReader(resolver, missing, warnings, problems).read(world_file);
}

}  // namespace sonard::render
