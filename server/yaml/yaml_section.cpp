// SPDX-License-Identifier: Apache-2.0
#include "server/yaml/yaml_section.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/text/edit_distance.hpp"
#include "server/net/interfaces.hpp"
#include "server/yaml/yaml_trouble.hpp"

namespace sonard::server {
namespace {

constexpr std::size_t most_problems = 1000;     // per file: more than there are keys
constexpr std::size_t longest_known_key = 100;  // thrice the longest known key

constexpr std::string_view plain_tag = "?";  // yaml-cpp's tag of scalars without quotes

/// "a: {b: off}" for the key "a.b" with this value; empty if the key is no path.
std::string nested_mappings(std::string_view path, const YAML::Node& value) {
  constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz_0123456789.";
  if (path.size() > longest_known_key || path.find('.') == std::string_view::npos || path.starts_with('.') ||
      path.ends_with('.') || path.find("..") != std::string_view::npos ||
      path.find_first_not_of(letters) != std::string_view::npos) {
    return {};
  }
  std::string text;
  for (const char c : path) {
    text += c == '.' ? std::string(": {") : std::string(1, c);
  }
  text += ": " + (value.IsScalar() && value.Scalar().size() <= longest_known_key ? value.Scalar() : "...");
  return text + std::string(static_cast<std::size_t>(std::ranges::count(path, '.')), '}');
}

/// The unit that the ending of a key means; empty if it has no unit.
std::string_view unit_of(std::string_view key) {
  // Longer endings precede their own endings.
  constexpr std::array<std::pair<std::string_view, std::string_view>, 12> units{{{"_db_per_km", "dB/km"},
                                                                                 {"_position_m", "m"},
                                                                                 {"_mps", "m/s"},
                                                                                 {"_ppt", "ppt"},
                                                                                 {"_deg", "degrees"},
                                                                                 {"_ms", "ms"},
                                                                                 {"_us", "microseconds"},
                                                                                 {"_db", "dB"},
                                                                                 {"_hz", "Hz"},
                                                                                 {"_c", "degrees Celsius"},
                                                                                 {"_m", "m"},
                                                                                 {"_s", "s"}}};
  for (const auto& [ending, unit] : units) {
    if (key.ends_with(ending)) {
      return unit;
    }
  }
  return {};
}

/// The key without its path and index.
std::string_view last_key(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  path = dot == std::string_view::npos ? path : path.substr(dot + 1);
  return path.substr(0, path.find('['));
}

std::string describe(const YAML::Node& node) {
  switch (node.Type()) {
    case YAML::NodeType::Scalar:
      return in_quotes(node.Scalar());
    case YAML::NodeType::Sequence:
      return "a list";
    case YAML::NodeType::Map:
      return "a mapping";
    default:
      return "empty";
  }
}

std::string ipv6_text(std::string_view value, std::string_view expected) {
  return fmt::format("{} is an IPv6 address; IPv6 is not supported (expected {})", in_quotes(value),
                     expected);
}

/// The interface of this machine that `value` names, alone or before a port.
std::optional<OwnAddress> interface_named(std::string_view value) {
  const auto own = parse_own_address(value.substr(0, value.find(':')));
  const bool named = own && !own->interface.empty() && own->trouble.empty();
  return named ? own : std::nullopt;
}

std::string interface_text(std::string_view value, std::string_view expected, const OwnAddress& own) {
  return fmt::format(
      "{} names an interface; only `alternate_address`, `address` and `netmask` under `network` can "
      "(expected {}; {} has {})",
      in_quotes(value), expected, own.interface, address_text(own.address));
}

/// A node as text; an IPv6 address in brackets, which YAML reads as a list, gets its own text.
std::string describe_with_ipv6(const YAML::Node& node) {
  const bool address =
      node.IsSequence() && node.size() == 1 && node[0].IsScalar() && is_ipv6(node[0].Scalar());
  return address
             ? "a list, because YAML reads the brackets of an IPv6 address as a list; IPv6 is not supported"
             : describe(node);
}

/// Whether a text is a number and more text: "10C", "5 ms", "-3.5deg".
bool is_number_with_unit(std::string_view text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stop != end;
}

/// In lower case, without the characters that separate words: "Fixed-Seed" as "fixedseed".
std::string letters_of(std::string_view word) {
  std::string letters;
  for (const char c : word) {
    if (c != '_' && c != '-' && c != ' ' && c != '.') {
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return letters;
}

/// The word of a choice that was probably meant; empty if no word is close. A close word differs by a few
/// letters, or one contains the other (a maker's name and a model's).
std::string_view closest_word(std::string_view given, const std::vector<std::string_view>& words) {
  constexpr std::size_t shortest_part = 4;
  const std::string name = letters_of(given.substr(0, longest_known_key));
  std::string_view best;
  std::size_t best_distance = std::numeric_limits<std::size_t>::max();
  for (const std::string_view word : words) {
    const std::string candidate = letters_of(word);
    const bool part =
        std::min(name.size(), candidate.size()) >= shortest_part &&
        (name.find(candidate) != std::string::npos || candidate.find(name) != std::string::npos);
    const std::size_t distance = part ? 1 : edit_distance(name, candidate);
    const std::size_t limit = std::max<std::size_t>(1, (std::min(name.size(), candidate.size()) + 1) / 3);
    if (distance <= limit && distance < best_distance) {
      best = word;
      best_distance = distance;
    }
  }
  return best;
}

/// The known key that was probably meant; empty if no key is close.
std::string_view closest(std::string_view name, const std::vector<KeyReference>& known) {
  std::string_view best;
  std::size_t best_distance = std::numeric_limits<std::size_t>::max();
  for (const KeyReference& key : known) {
    const std::string_view candidate = key.name;
    // "delay" for "delay_ms": the unit was forgotten.
    const bool unit_missing = candidate.starts_with(name) && candidate.substr(name.size()).starts_with('_');
    const std::size_t distance = unit_missing ? 1 : edit_distance(name, candidate);
    const std::size_t limit = std::max<std::size_t>(1, (std::min(name.size(), candidate.size()) + 1) / 3);
    if (distance <= limit && distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string range_text(const Range& range) {
  return fmt::format("{}{} to {}", range.above_min ? "above " : "", range.min, range.max);
}

std::string range_schema(const Range& range) {
  return fmt::format(R"("type": "number", "{}": {}, "maximum": {})",
                     range.above_min ? "exclusiveMinimum" : "minimum", range.min, range.max);
}

/// Rounded, because the number may have been converted between units.
std::string number_text(double value) {
  return fmt::format("{:g}", value);
}

std::string quoted_words(const std::vector<std::string_view>& words, char quote) {
  std::string text;
  for (const std::string_view word : words) {
    text += fmt::format("{}{}{}{}", text.empty() ? "" : ", ", quote, word, quote);
  }
  return text;
}

/// Whether a plain text has a stray quote, as `sea.sdf"`: YAML keeps a quote that does not begin a value.
bool ends_with_stray_quote(const YAML::Node& node) {
  if (!node.IsScalar() || node.Tag() != plain_tag || node.Scalar().empty()) {
    return false;
  }
  const char last = node.Scalar().back();
  return (last == '"' || last == '\'') && std::ranges::count(node.Scalar(), last) == 1;
}

/// Place of a node; `otherwise` for an empty value, which the parser places at the next key of the file.
SourcePosition place_of(const YAML::Node& node, const SourcePosition& otherwise) {
  return node.IsNull() && otherwise.line > 0 ? otherwise : position_of(node.Mark());
}

double ns_per_unit(std::string_view key) {
  return key.ends_with("_us") ? 1e3 : key.ends_with("_ms") ? 1e6 : key.ends_with("_s") ? 1e9 : 60e9;
}

}  // namespace

SourcePosition position_of(const YAML::Mark& mark) {
  return mark.is_null() ? SourcePosition{} : SourcePosition{mark.line + 1, mark.column + 1};
}

YamlSection::YamlSection(YamlFindings& findings, const YAML::Node& node, std::string path,
                         SourcePosition key_at)
    : findings_(findings), path_(std::move(path)), at_(place_of(node, key_at)) {
  if (!node.IsMap()) {
    const std::string one_word = node.IsScalar() ? missing_blank(node.Scalar()) : std::string();
    const std::optional<std::size_t> added = problem(
        at_, path_,
        one_word.empty() ? fmt::format("is {} (expected a mapping, key: value)", describe(node)) : one_word);
    if (added && node.IsScalar() && one_word.empty() && node.Scalar().size() <= longest_known_key) {
      findings_.words_for_mappings.push_back({*added, node.Scalar()});
    }
    is_map_ = false;
    return;
  }
  for (const auto& pair : node) {
    const SourcePosition name_at = position_of(pair.first.Mark());
    if (!pair.first.IsScalar()) {
      problem(name_at, path_, fmt::format("{} is used as a key (expected a word)", describe(pair.first)));
      continue;
    }
    const std::string& name = pair.first.Scalar();
    std::string one_word = missing_blank(name);
    one_word = one_word.empty() ? missing_colon(name) : one_word;
    if (!one_word.empty() && pair.second.IsNull()) {
      problem(name_at, path_, one_word);
      continue;
    }
    // yaml-cpp keeps every occurrence and looks up the first one.
    if (const Entry* first = peek(name)) {
      problem(name_at, path_of(name),
              fmt::format("duplicate key (expected once; first given on line {})", first->key_at.line));
      continue;
    }
    entry_of_.emplace(name, entries_.size());
    entries_.push_back({name, name_at, place_of(pair.second, name_at), pair.second});
    if (ends_with_stray_quote(pair.second)) {
      problem(entries_.back().value_at, path_of(name),
              fmt::format(
                  "{} ends with a quote but does not begin with one (expected no quote, or one on each side)",
                  describe(pair.second)));
    }
  }
}

YamlSection::~YamlSection() {
  for (const Entry& entry : entries_) {
    if (!entry.read) {
      report_unknown(entry);
    }
  }
}

void YamlSection::ignore_rest() {
  for (Entry& entry : entries_) {
    entry.read = true;
  }
}

bool YamlSection::has(std::string_view key) const {
  return peek(key) != nullptr;
}

bool YamlSection::is_list(std::string_view key) const {
  const Entry* entry = peek(key);
  return entry != nullptr && entry->value.IsSequence();
}

std::string_view YamlSection::word(std::string_view key) const {
  const Entry* entry = peek(key);
  return entry != nullptr && entry->value.IsScalar() ? std::string_view(entry->value.Scalar())
                                                     : std::string_view();
}

void YamlSection::require(std::string_view key, std::string_view expected) {
  known_key(key).required = true;
  if (find(key) == nullptr && is_map_) {
    problem(at_, path_of(key), fmt::format("missing (expected {})", expected));
  }
}

void YamlSection::report(std::string_view key, const std::string& message) {
  problem(place_of_key(key), path_of(key), message);
}

void YamlSection::report_network(std::string_view key, const std::string& message) {
  problem(place_of_key(key), path_of(key), message, /*of_network=*/true);
}

SourcePosition YamlSection::place_of_key(std::string_view key) const {
  const Entry* entry = peek(key);
  return entry != nullptr ? entry->value_at : at_;
}

void YamlSection::warn_of(std::string path, std::string message) {
  ConfigWarning warning{std::move(path), std::move(message)};
  if (!describing() && std::ranges::find(findings_.warnings, warning) == findings_.warnings.end()) {
    findings_.warnings.push_back(std::move(warning));
  }
}

void YamlSection::warn_if_given(std::string_view key, std::string_view why) {
  if (has(key)) {
    warn(key, fmt::format("has no effect: {}", why));
  }
}

void YamlSection::renamed(std::string_view former, std::string_view key) {
  const auto found = entry_of_.find(former);
  if (found == entry_of_.end()) {
    return;
  }
  if (has(key)) {
    report(former, fmt::format("is the former name of '{}', which is given too (expected one of them)", key));
    entries_[found->second].read = true;
    return;
  }
  const std::size_t entry = found->second;
  warn_of(path_of(key), fmt::format("has its former name '{}' here; write '{}'", former, key));
  entry_of_.erase(found);
  entry_of_.emplace(key, entry);
  entries_[entry].name = key;
}

void YamlSection::renamed_value(std::string_view key, std::string_view former, std::string_view value) {
  const auto found = entry_of_.find(key);
  if (found == entry_of_.end()) {
    return;
  }
  YAML::Node& node = entries_[found->second].value;
  const auto is_former = [&](const YAML::Node& item) { return item.IsScalar() && item.Scalar() == former; };
  const bool given =
      node.IsSequence() ? std::any_of(node.begin(), node.end(), is_former) : word(key) == former;
  if (!given) {
    return;
  }
  warn(key, fmt::format("{} '{}', which is a former name; write '{}'", node.IsSequence() ? "has" : "is",
                        former, value));
  if (!node.IsSequence()) {
    node.reset(YAML::Node(std::string(value)));
    return;
  }
  for (YAML::Node item : node) {
    if (is_former(item)) {
      item = std::string(value);
    }
  }
}

std::string YamlSection::path_of(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

void YamlSection::place_default(std::string_view key, std::string_view source) {
  if (const Entry* entry = peek(source); entry != nullptr && !has(key)) {
    findings_.positions.emplace(path_of(key), entry->value_at);
  }
}

void YamlSection::default_is(std::string_view key, std::string_view text, std::string_view json) {
  known_key(key).default_text = text;
  known_key(key).default_json = json;
}

void YamlSection::number(std::string_view key, double& out, const Range& range, std::string_view meaning,
                         double units_per_one) {
  double value = out * units_per_one;
  document(key, range_text(range), range_schema(range), number_text(value), meaning);
  if (const Entry* entry = find(key)) {
    value = number_of(entry->value, entry->value_at, path_of(key), range).value_or(value);
  }
  out = value / units_per_one;
}

void YamlSection::number_or_word(std::string_view key, double& out, const Range& range,
                                 const std::vector<std::pair<std::string_view, double>>& words,
                                 std::string_view meaning) {
  std::vector<std::string_view> names;
  std::string default_json = number_text(out);
  for (const auto& [word, value] : words) {
    names.push_back(word);
    if (value == out) {
      default_json = quoted_words({word}, '"');
    }
  }
  document(
      key, fmt::format("{}, or {}", quoted_words(names, '`'), range_text(range)),
      fmt::format(R"("anyOf": [{{"enum": [{}]}}, {{{}}}])", quoted_words(names, '"'), range_schema(range)),
      default_json, meaning);
  const Entry* entry = find(key);
  if (entry == nullptr) {
    return;
  }
  if (entry->value.IsScalar()) {
    for (const auto& [word, value] : words) {
      if (entry->value.Scalar() == word) {
        out = value;
        return;
      }
    }
  }
  const std::size_t problems_before = findings_.problems.size();
  if (const std::optional<double> value = number_of(entry->value, entry->value_at, path_of(key), range)) {
    out = *value;
  } else if (findings_.problems.size() > problems_before) {
    std::string& message = findings_.problems.back().message;
    message.pop_back();  // the closing parenthesis
    for (const std::string_view word : names) {
      message += fmt::format(", or '{}'", word);
    }
    message += ')';
  }
}

void YamlSection::duration(std::string_view key, std::chrono::nanoseconds& out, const Range& range,
                           std::string_view meaning) {
  double value_ns = static_cast<double>(out.count());
  number(key, value_ns, range, meaning, 1.0 / ns_per_unit(key));
  out = std::chrono::nanoseconds{std::llround(value_ns)};
}

void YamlSection::angle(std::string_view key, double& out_rad, const Range& range_deg,
                        std::string_view meaning) {
  document(key, range_text(range_deg), range_schema(range_deg),
           number_text(out_rad * 180.0 / std::numbers::pi), meaning);
  if (const Entry* entry = find(key)) {
    if (const std::optional<double> degrees =
            number_of(entry->value, entry->value_at, path_of(key), range_deg)) {
      out_rad = *degrees * std::numbers::pi / 180.0;
    }
  }
}

void YamlSection::vector3(std::string_view key, glm::dvec3& out, const Range& range,
                          std::string_view meaning) {
  document(
      key, "three numbers",
      fmt::format(R"("type": "array", "items": {{{}}}, "minItems": 3, "maxItems": 3)", range_schema(range)),
      fmt::format("[{}, {}, {}]", out.x, out.y, out.z), meaning);
  const Entry* entry = find(key);
  if (entry == nullptr) {
    return;
  }
  if (!entry->value.IsSequence() || entry->value.size() != 3) {
    problem(
        entry->value_at, path_of(key),
        fmt::format("is {} (expected a list of three numbers{})",
                    entry->value.IsSequence() ? fmt::format("a list of {}", entry->value.size())
                                              : describe(entry->value),
                    entry->value.size() > 3 ? "; a comma separates numbers, so decimals need a point" : ""));
    return;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const std::string path = fmt::format("{}[{}]", path_of(key), axis);
    if (const std::optional<double> value =
            number_of(entry->value[axis], place_of(entry->value[axis], entry->value_at), path, range)) {
      out[axis] = *value;
    }
  }
}

void YamlSection::boolean(std::string_view key, bool& out, std::string_view meaning) {
  document(key, "boolean", R"("type": "boolean")", out ? "true" : "false", meaning);
  const Entry* entry = find(key);
  if (entry == nullptr) {
    return;
  }
  const YAML::Node& node = entry->value;
  const bool plain = node.IsScalar() && node.Tag() == plain_tag;
  if (plain && (node.Scalar() == "true" || node.Scalar() == "false")) {
    out = node.Scalar() == "true";
  } else {
    problem(entry->value_at, path_of(key), fmt::format("is {} (expected true or false)", describe(node)));
  }
}

void YamlSection::text(std::string_view key, std::string& out, std::string_view meaning) {
  document(key, "text", R"("type": "string")", "", meaning);
  out = plain_text(key, "a text").value_or(out);
}

void YamlSection::path(std::string_view key, std::filesystem::path& out, const std::filesystem::path& folder,
                       std::string_view meaning) {
  document(key, "path", R"("type": "string")", "", meaning);
  if (const std::optional<std::string> value = plain_text(key, "a text")) {
    out = folder / *value;
    std::error_code ignored;
    if ((*value == "~" || value->starts_with("~/")) && !std::filesystem::exists(folder / "~", ignored)) {
      report(key, fmt::format("{} begins with ~, which sonard does not expand (expected an absolute path, or "
                              "one relative to the folder of the configuration)",
                              in_quotes(*value)));
    }
  }
}

void YamlSection::section(std::string_view key, std::string_view meaning,
                          const std::function<void(YamlSection&)>& read) {
  document(key, "mapping", "", "", meaning);
  if (const Entry* entry = find(key); entry != nullptr || findings_.describing) {
    read_inner(key, entry == nullptr ? YAML::Node(YAML::NodeType::Map) : entry->value, path_of(key),
               entry == nullptr ? at_ : entry->value_at, read);
  }
}

void YamlSection::sections(std::string_view key, std::string_view meaning,
                           const std::function<void(YamlSection&)>& read) {
  document(key, "list of mappings", "", "", meaning);
  known_key(key).is_list = true;
  if (findings_.describing) {
    read_inner(key, YAML::Node(YAML::NodeType::Map), path_of(key), at_, read);
  }
  const Entry* entry = find(key);
  if (entry == nullptr) {
    return;
  }
  if (!entry->value.IsSequence()) {
    problem(entry->value_at, path_of(key),
            fmt::format("is {} (expected a list, each item starting with '-')", describe(entry->value)));
    return;
  }
  for (std::size_t i = 0; i < entry->value.size(); ++i) {
    const YAML::Node item = entry->value[i];
    const std::string path = fmt::format("{}[{}]", path_of(key), i);
    const SourcePosition at = place_of(item, entry->value_at);
    findings_.positions.emplace(path, at);
    read_inner(key, item, path, at, read);
  }
}

void YamlSection::read_inner(std::string_view key, const YAML::Node& node, std::string path,
                             SourcePosition key_at, const std::function<void(YamlSection&)>& read) {
  YamlSection inner(findings_, node, std::move(path), key_at);
  read(inner);
  known_key(key).introduction = inner.introduction_;
  known_key(key).keys = inner.known_;
}

KeyReference& YamlSection::known_key(std::string_view key) {
  const auto found = std::find_if(known_.begin(), known_.end(),
                                  [key](const KeyReference& known) { return known.name == key; });
  if (found != known_.end()) {
    return *found;
  }
  known_.emplace_back().name = key;
  return known_.back();
}

void YamlSection::document(std::string_view key, std::string_view type, std::string_view schema,
                           std::string_view default_json, std::string_view meaning) {
  KeyReference& known = known_key(key);
  if (!known.schema.empty()) {
    known.type += fmt::format(", or {}", type);
    if (!schema.empty()) {  // a mapping has no schema: its keys have
      known.schema = fmt::format(R"("anyOf": [{{{}}}, {{{}}}])", known.schema, schema);
    }
    return;
  }
  known.type = type;
  known.schema = schema;
  known.default_json = default_json;
  known.default_text = default_json;
  std::replace(known.default_text.begin(), known.default_text.end(), '"', '`');
  known.meaning = meaning;
}

void YamlSection::document_list(std::string_view key, const TextForm& form, std::string_view meaning,
                                bool may_be_empty) {
  document(key, fmt::format("list of {}", form.type),
           fmt::format(R"("type": "array", {}"items": {{{}}})", may_be_empty ? "" : R"("minItems": 1, )",
                       form.schema),
           may_be_empty ? "[]" : "", meaning);
}

const YamlSection::Entry* YamlSection::find(std::string_view key) {
  known_key(key);
  const auto found = entry_of_.find(key);
  if (found == entry_of_.end()) {
    return nullptr;
  }
  Entry& entry = entries_[found->second];
  entry.read = true;
  findings_.positions.emplace(path_of(key), entry.value_at);
  return &entry;
}

const YamlSection::Entry* YamlSection::peek(std::string_view key) const {
  const auto found = entry_of_.find(key);
  return found == entry_of_.end() ? nullptr : &entries_[found->second];
}

std::optional<std::size_t> YamlSection::problem(const SourcePosition& at, std::string path,
                                                std::string message, bool of_network) {
  // Further problems of a rejected value are not reported.
  if (!findings_.keys_with_problems.insert(path).second) {
    return std::nullopt;
  }
  if (findings_.problems.size() >= most_problems) {
    ++findings_.problems_left_out;
    return std::nullopt;
  }
  findings_.problems.push_back({at, std::move(path), std::move(message), of_network});
  return findings_.problems.size() - 1;
}

void YamlSection::report_bad_value(std::string_view key, std::string_view value, std::string_view expected,
                                   bool is_address) {
  if (is_ipv6(value)) {
    report(key, ipv6_text(value, expected));
  } else if (const auto own = is_address ? interface_named(value) : std::nullopt) {
    report(key, interface_text(value, expected, *own));
  } else {
    report(key, fmt::format("{} is not understood (expected {})", in_quotes(value), expected));
  }
}

void YamlSection::report_unknown(const Entry& entry) {
  for (const auto& [key, what_to_do] : retired_) {
    if (entry.name == key) {
      problem(entry.key_at, path_of(entry.name), fmt::format("is no longer a key: {}", what_to_do));
      return;
    }
  }
  for (const auto& [key, what_to_do] : foreign_) {
    if (entry.name == key) {
      problem(entry.key_at, path_of(entry.name), fmt::format("unknown key ({})", what_to_do));
      return;
    }
  }
  const std::string nested = nested_mappings(entry.name, entry.value);
  const bool too_long = entry.name.size() > longest_known_key;
  const std::string_view meant = too_long ? std::string_view{} : closest(entry.name, known_);
  std::string message = "unknown key";
  if (!nested.empty()) {
    message += fmt::format(": a name with dots stands for nested mappings, {}", nested);
  }
  if (!meant.empty()) {
    message += fmt::format(", did you mean '{}'?", meant);
  }
  std::vector<std::string_view> names;
  for (const KeyReference& key : known_) {
    names.push_back(key.name);
  }
  message +=
      names.empty() ? " (expected no keys)" : fmt::format(" (expected one of {})", fmt::join(names, ", "));
  const std::optional<std::size_t> added =
      problem(entry.key_at, path_of(too_long ? in_quotes(entry.name) : entry.name), std::move(message));
  if (added && meant.empty() && nested.empty()) {
    findings_.unknown_keys.push_back({*added, entry.name, entry.value.IsScalar()});
  }
}

std::optional<double> YamlSection::number_of(const YAML::Node& node, const SourcePosition& at,
                                             const std::string& path, const Range& range) {
  const std::string_view unit = unit_of(last_key(path));
  const std::string expected = fmt::format("a number {}{}{}{}", range.above_min ? "" : "from ",
                                           range_text(range), unit.empty() ? "" : ", in ", unit);
  if (!node.IsScalar() || node.Tag() != plain_tag) {
    const std::string what =
        node.IsScalar() ? fmt::format("a quoted text, {}", describe(node)) : describe(node);
    problem(at, path, fmt::format("is {} (expected {})", what, expected));
    return std::nullopt;
  }
  const std::string& text = node.Scalar();
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (const std::string meant = with_decimal_point(text); !meant.empty()) {
    problem(at, path,
            fmt::format("{} has a decimal comma, write {} (expected {})", in_quotes(text), meant, expected));
    return std::nullopt;
  }
  if (is_number_with_unit(text)) {
    problem(at, path,
            fmt::format("{} contains a unit; the key already states the unit (expected {})", in_quotes(text),
                        expected));
    return std::nullopt;
  }
  if (error != std::errc{} || stop != end || !std::isfinite(value)) {
    problem(at, path, fmt::format("{} is not a finite number (expected {})", in_quotes(text), expected));
    return std::nullopt;
  }
  if (!range.holds(value)) {
    problem(at, path, fmt::format("{} is out of range (expected {})", text, expected));
    return std::nullopt;
  }
  return value;
}

void YamlSection::whole_number(std::string_view key, std::uint64_t& out, std::uint64_t min, std::uint64_t max,
                               std::string_view meaning) {
  document(key, fmt::format("{} to {}", min, max),
           fmt::format(R"("type": "integer", "minimum": {}, "maximum": {})", min, max), std::to_string(out),
           meaning);
  const Entry* entry = find(key);
  if (entry == nullptr) {
    return;
  }
  const YAML::Node& node = entry->value;
  if (node.IsScalar() && node.Tag() == plain_tag) {
    const std::string& text = node.Scalar();
    std::uint64_t value = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error == std::errc{} && stop == end && value >= min && value <= max) {
      out = value;
      return;
    }
  }
  problem(entry->value_at, path_of(key),
          fmt::format("is {} (expected a whole number from {} to {})", describe(node), min, max));
}

std::optional<std::size_t> YamlSection::word_index(std::string_view key,
                                                   const std::vector<std::string_view>& words,
                                                   std::string_view default_word, std::string_view meaning) {
  document(key, quoted_words(words, '`'), fmt::format(R"("enum": [{}])", quoted_words(words, '"')),
           quoted_words({default_word}, '"'), meaning);
  const std::string expected = fmt::format("one of {}", fmt::join(words, ", "));
  const std::optional<std::string> word = plain_text(key, expected);
  if (!word) {
    return std::nullopt;
  }
  const auto found = std::find(words.begin(), words.end(), *word);
  if (found == words.end()) {
    const std::string_view meant = closest_word(*word, words);
    if (meant.empty()) {
      report_bad_value(key, *word, expected, false);
    } else {
      report(key, fmt::format("{} is not understood, did you mean '{}'? (expected {})", in_quotes(*word),
                              meant, expected));
    }
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - words.begin());
}

std::optional<std::string> YamlSection::plain_text(std::string_view key, std::string_view expected) {
  const Entry* entry = find(key);
  if (entry == nullptr) {
    return std::nullopt;
  }
  if (!entry->value.IsScalar() || entry->value.Scalar().empty()) {
    problem(entry->value_at, path_of(key),
            fmt::format("is {} (expected {})", describe_with_ipv6(entry->value), expected));
    return std::nullopt;
  }
  return entry->value.Scalar();
}

bool YamlSection::each_text(std::string_view key, std::string_view expected,
                            const std::function<bool(const std::string&)>& take) {
  const Entry* entry = find(key);
  if (entry == nullptr) {
    return false;
  }
  if (!entry->value.IsSequence()) {
    problem(entry->value_at, path_of(key),
            fmt::format("is {} (expected a list, each item {})", describe(entry->value), expected));
    return false;
  }
  bool complete = true;
  for (std::size_t i = 0; i < entry->value.size(); ++i) {
    const YAML::Node item = entry->value[i];
    if (!item.IsScalar() || !take(item.Scalar())) {
      problem(place_of(item, entry->value_at), fmt::format("{}[{}]", path_of(key), i),
              item.IsScalar() && is_ipv6(item.Scalar())
                  ? ipv6_text(item.Scalar(), expected)
                  : fmt::format("is {} (expected {})", describe(item), expected));
      complete = false;
    }
  }
  return complete;
}

}  // namespace sonard::server
