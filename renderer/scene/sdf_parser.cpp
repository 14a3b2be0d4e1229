// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/sdf_parser.hpp"

#include <algorithm>
#include <iostream>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sdf/Console.hh>
#include <sdf/Error.hh>
#include <sdf/Model.hh>
#include <sdf/ParserConfig.hh>
#include <sdf/Types.hh>
#include <sdf/World.hh>

#include "renderer/scene/world.hpp"

namespace sonard::render {
namespace {

namespace fs = std::filesystem;

/// Collects what libsdformat prints: some errors inside included files are reported in no other way.
class ConsoleCapture {
 public:
  ConsoleCapture() : cerr_buffer_(std::cerr.rdbuf(text_.rdbuf())) {
    sdf::Console::Instance()->GetMsgStream().SetStream(&text_);
  }
  ~ConsoleCapture() {
    std::cerr.rdbuf(cerr_buffer_);
    sdf::Console::Instance()->GetMsgStream().SetStream(&std::cerr);
  }
  ConsoleCapture(const ConsoleCapture&) = delete;
  ConsoleCapture& operator=(const ConsoleCapture&) = delete;

  /// Without terminal colours and empty lines.
  std::vector<std::string> lines() const {
    std::vector<std::string> result;
    std::istringstream in(text_.str());
    for (std::string line; std::getline(in, line);) {
      std::string plain;
      for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '\033') {
          i = std::min(line.find('m', i), line.size());
        } else {
          plain += line[i];
        }
      }
      if (!plain.empty()) {
        result.push_back(plain);
      }
    }
    return result;
  }

 private:
  std::ostringstream text_;
  std::streambuf* cerr_buffer_;
};

/// Files named by files inside includes are looked up through the global configuration, whatever
/// configuration the parser was given.
class FindCallbackScope {
 public:
  using Callback = std::function<std::string(const std::string&)>;

  explicit FindCallbackScope(const Callback& callback)
      : before_(sdf::ParserConfig::GlobalConfig().FindFileCallback()) {
    sdf::ParserConfig::GlobalConfig().SetFindCallback(callback);
  }
  ~FindCallbackScope() { sdf::ParserConfig::GlobalConfig().SetFindCallback(before_); }
  FindCallbackScope(const FindCallbackScope&) = delete;
  FindCallbackScope& operator=(const FindCallbackScope&) = delete;

 private:
  Callback before_;
};

/// Answers libsdformat, which asks for a URI without saying which file names it. Any folder seen so far may
/// be right; verify_includes() checks afterwards.
class IncludeFinder {
 public:
  IncludeFinder(const fs::path& world_file, UriResolver& resolver)
      : resolver_(resolver), folders_{world_file.parent_path()} {}

  std::string find(const std::string& uri) {
    std::string failure;
    for (auto folder = folders_.rbegin(); folder != folders_.rend(); ++folder) {
      try {
        fs::path found = resolver_.resolve(uri, *folder);
        const fs::path model_folder = fs::is_directory(found) ? found : found.parent_path();
        // A folder without a manifest is clear enough when it holds a model.sdf.
        if (!fs::exists(model_folder / "model.config") && fs::is_regular_file(model_folder / "model.sdf")) {
          found = found == model_folder ? model_folder / "model.sdf" : found;
        }
        resolver_.add_model_folder(model_folder.parent_path());
        folders_.push_back(model_folder);
        return found.string();
      } catch (const WorldError& error) {
        failure = error.what();
      }
    }
    if (failure_.empty()) {
      failure_ = failure;
    }
    return {};
  }

  /// Why the first URI that was not found was not found.
  const std::string& failure() const { return failure_; }

 private:
  UriResolver& resolver_;
  std::vector<fs::path> folders_;
  std::string failure_;
};

/// The text behind "Error [file.cc:12] " of the first line that libsdformat printed as an error.
std::optional<std::string> first_printed(const std::vector<std::string>& lines, const std::string& label) {
  for (const std::string& line : lines) {
    if (line.starts_with(label + " [")) {
      const std::size_t end = line.find("] ");
      return end == std::string::npos ? line : line.substr(end + 2);
    }
  }
  return std::nullopt;
}

/// "[XML path:file:L4]: text" or "...[XML path:file:L4]: Msg: text" as "file:4: text".
std::string located(const std::string& line, const fs::path& world_file) {
  const std::size_t number = line.find(":L");
  const std::size_t number_end = line.find("]: ", number);
  const std::size_t file = line.rfind(":/", number);
  if (number == std::string::npos || number_end == std::string::npos || file == std::string::npos) {
    return fmt::format("{}: {}", world_file.string(), line);
  }
  std::string text = line.substr(number_end + 3);
  if (text.starts_with("Msg: ")) {
    text.erase(0, 5);
  }
  return fmt::format("{}:{}: {}", line.substr(file + 1, number - file - 1),
                     line.substr(number + 2, number_end - number - 2), text);
}

template <typename Predicate>
sdf::ElementPtr find_last(const sdf::ElementPtr& element, const Predicate& matches) {
  sdf::ElementPtr found = matches(element) ? element : nullptr;
  for (auto child = element->GetFirstElement(); child; child = child->GetNextElement()) {
    if (auto inside = find_last(child, matches)) {
      found = inside;
    }
  }
  return found;
}

/// Where an error without a place is: libsdformat names elements in its messages as "name[NAME]"; of a model
/// without a link it says nothing at all.
std::string guessed_place(const sdf::Error& error, const sdf::ElementPtr& root, const fs::path& world_file) {
  if (!root) {
    return world_file.string();
  }
  sdf::ElementPtr element;
  if (error.Code() == sdf::ErrorCode::MODEL_WITHOUT_LINK) {
    element = find_last(root, [](const sdf::ElementPtr& e) {
      return e->GetName() == "model" && !e->HasElement("link") && !e->HasElement("model");
    });
  } else {
    const std::string message = error.Message();
    const std::size_t begin = message.find("with name[");
    const std::size_t end = message.find(']', begin);
    if (begin != std::string::npos && end != std::string::npos) {
      const std::string name = message.substr(begin + 10, end - begin - 10);
      element = find_last(root, [&](const sdf::ElementPtr& e) {
        return e->HasAttribute("name") && e->Get<std::string>("name") == name;
      });
    }
  }
  return element ? place_of(element) : world_file.string();
}

std::string message_of_xml_error(const fs::path& world_file, const std::string& printed) {
  const std::size_t number = printed.find("Line number=");
  const std::size_t name = printed.find("Error=");
  if (number == std::string::npos || name == std::string::npos) {
    return fmt::format("{}: {}", world_file.string(), printed);
  }
  const std::size_t name_end = printed.find(' ', name);
  return fmt::format("{}:{}: not well-formed XML ({})", world_file.string(),
                     std::max(1, std::stoi("0" + printed.substr(number + 12))),
                     printed.substr(name + 6, name_end - name - 6));
}

std::string message_of(const sdf::Errors& errors, const std::vector<std::string>& printed,
                       const sdf::Root& root, const fs::path& world_file, const IncludeFinder& finder) {
  const sdf::Error& first = errors.front();
  const auto detail = first_printed(printed, "Error");
  if (first.FilePath()) {
    std::string text = first.Message();
    if (first.Code() == sdf::ErrorCode::URI_LOOKUP && !finder.failure().empty()) {
      text = "include " + finder.failure();
    } else if (detail) {
      text += ": " + *detail;
    }
    return fmt::format("{}:{}: {}", *first.FilePath(), first.LineNumber().value_or(1), text);
  }
  if (detail && detail->find("XML_ERROR") != std::string::npos) {
    return message_of_xml_error(world_file, *detail);
  }
  return fmt::format("{}: {}{}", guessed_place(first, root.Element(), world_file), first.Message(),
                     detail ? ": " + *detail : "");
}

/// Compares where each included file came from with where its URI points.
void verify_includes(const sdf::ElementPtr& element, const UriResolver& resolver) {
  for (auto child = element->GetFirstElement(); child; child = child->GetNextElement()) {
    if (const auto include = child->GetIncludeElement()) {
      const auto uri = include->Get<std::string>("uri");
      std::error_code error;
      const fs::path actual = fs::canonical(child->FilePath(), error);
      fs::path expected;
      try {
        expected = resolver.resolve(uri, fs::path(element->FilePath()).parent_path());
      } catch (const WorldError& failure) {
        throw WorldError(fmt::format("{}: include {}", place_of(element), failure.what()));
      }
      if (expected != actual && expected != actual.parent_path()) {
        throw WorldError(fmt::format("{}: include '{}' means {} but was read from {}; rename one of them",
                                     place_of(element), uri, expected.string(), actual.string()));
      }
    }
    verify_includes(child, resolver);
  }
}

}  // namespace

std::string place_of(const sdf::ElementPtr& element) {
  std::string file = element->FilePath();
  for (auto e = element; e; e = e->GetParent()) {
    if (e->LineNumber() && e->FilePath() == file) {
      return fmt::format("{}:{}", file, *e->LineNumber());
    }
  }
  return file;
}

sdf::Root parse_sdf(const fs::path& world_file, UriResolver& resolver, std::vector<std::string>& warnings) {
  IncludeFinder finder(world_file, resolver);
  const auto callback = [&finder](const std::string& uri) { return finder.find(uri); };
  sdf::Root root;
  sdf::Errors errors;
  std::vector<std::string> printed;
  {
    const ConsoleCapture capture;
    const FindCallbackScope scope(callback);
    sdf::ParserConfig config;
    config.SetFindCallback(callback);
    config.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::WARN);
    errors = root.Load(world_file.string(), config);
    printed = capture.lines();
  }
  if (!errors.empty()) {
    throw WorldError(message_of(errors, printed, root, world_file, finder));
  }
  const auto coded = std::find_if(printed.begin(), printed.end(),
                                  [](const std::string& line) { return line.starts_with("Error Code"); });
  if (coded != printed.end()) {
    throw WorldError(located(*coded, world_file) + (finder.failure().empty() ? "" : "; " + finder.failure()));
  }
  if (const auto error = first_printed(printed, "Error")) {
    throw WorldError(fmt::format("{}: {}", world_file.string(), *error));
  }
  for (const std::string& line : printed) {
    if (line.starts_with("Warning [")) {
      const std::string text = *first_printed({line}, "Warning");
      warnings.push_back(located(text.substr(0, text.find(" Copying[")), world_file));
    }
  }
  if (root.WorldCount() > 1 || (root.WorldCount() == 0 && root.Model() == nullptr)) {
    throw WorldError(fmt::format("{}: {} worlds and no model: expected one world or one model",
                                 world_file.string(), root.WorldCount()));
  }
  verify_includes(root.Element(), resolver);
  return root;
}

}  // namespace sonard::render
