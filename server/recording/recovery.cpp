// SPDX-License-Identifier: Apache-2.0
#include "server/recording/recovery.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "protocol/glf/dat_index.hpp"
#include "protocol/glf/log_view.hpp"
#include "protocol/mcap/data_section.hpp"
#include "protocol/mcap/recovery.hpp"
#include "protocol/pcapng/blocks.hpp"
#include "server/logs/damage_text.hpp"
#include "server/logs/mapped_file.hpp"
#include "server/recording/append_file.hpp"
#include "server/recording/log_names.hpp"

namespace sonard::server {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t most_interfaces = 256;  // a higher number in a packet is damage

/// Repair of a file that was cut, in place; or the parts of a new file instead of a damaged one.
struct Mending {
  std::uint64_t keep_size = 0;
  std::vector<std::uint8_t> end{};    ///< appended after keep_size; may repeat whole records that were there
  std::uint64_t lost_size = 0;        ///< bytes of a partly written record, which are lost
  bool damaged = false;               ///< more than a partly written record is unreadable
  std::vector<RebuiltPart> parts{};   ///< if damaged
  std::vector<std::string> losses{};  ///< if damaged: one phrase each
};

/// All bytes up to `end` that are not damaged.
std::vector<RebuiltPart> undamaged_parts(const std::vector<Damage>& damaged, std::uint64_t end) {
  std::vector<RebuiltPart> parts;
  std::uint64_t begin = 0;
  for (const Damage& damage : damaged) {
    parts.push_back({.offset = begin, .size = damage.offset - begin});
    begin = damage.offset + damage.size;
  }
  parts.push_back({.offset = begin, .size = end - begin});
  std::erase_if(parts, [](const RebuiltPart& part) { return part.size == 0; });
  return parts;
}

fs::path free_damaged_path(const fs::path& path) {
  fs::path damaged = path.string() + ".damaged";
  std::error_code ignored;
  for (int number = 2; fs::exists(damaged, ignored); ++number) {
    damaged = path.string() + ".damaged-" + std::to_string(number);
  }
  return damaged;
}

std::error_code write_parts(const fs::path& from, const fs::path& to, const std::vector<RebuiltPart>& parts) {
  const MappedFile damaged(from);
  std::error_code error;
  AppendFile file = AppendFile::create(to, error);
  for (const RebuiltPart& part : parts) {
    if (!error) {
      error = file.append(part.made);
    }
    if (!error) {
      error = file.append(damaged.bytes().subspan(static_cast<std::size_t>(part.offset),
                                                  static_cast<std::size_t>(part.size)));
    }
  }
  if (!error) {
    file.sync();
  }
  return error;
}

/// Renames the file, and writes its whole records into a new one with its name.
void rebuild(const fs::path& path, const Mending& mending) {
  const fs::path damaged = free_damaged_path(path);
  std::error_code error;
  fs::rename(path, damaged, error);
  if (!error && !mending.parts.empty()) {
    error = write_parts(damaged, path, mending.parts);
  }
  if (error) {
    spdlog::error("recording: cannot recover {}: {}", path.string(), error.message());
    return;
  }
  spdlog::warn("recording: {} is damaged: {}; kept unchanged as {}", path.string(),
               mending.parts.empty() ? "no record can be read" : "its whole records are in a new file",
               damaged.string());
  for (const std::string& loss : mending.losses) {
    spdlog::warn("recording: {}: {}", path.string(), loss);
  }
}

void tell_recovered(const fs::path& path, std::uint64_t lost_size) {
  if (lost_size == 0) {
    spdlog::info("recording: recovered {}: nothing is lost", path.string());
  } else {
    spdlog::info(
        "recording: recovered {}: all whole records are kept; {} bytes of an incomplete record are lost",
        path.string(), lost_size);
  }
}

void mend(const fs::path& path, const Mending& mending) {
  if (mending.damaged) {
    rebuild(path, mending);
    return;
  }
  std::error_code error;
  AppendFile file = AppendFile::open(path, error);
  if (!error) {
    error = file.truncate(mending.keep_size);
  }
  if (!error) {
    error = file.append(mending.end);
  }
  if (error) {
    spdlog::error("recording: cannot recover {}: {}", path.string(), error.message());
    return;
  }
  file.sync();
  tell_recovered(path, mending.lost_size);
}

std::string lost_messages(const mcap::DamagedChunk& part) {
  std::uint64_t messages = 0;
  for (const auto& [channel, count] : part.lost_messages) {
    messages += count;
  }
  if (part.holds == mcap::Holds::no_message) {
    return "no message is lost";
  }
  return messages > 0 ? fmt::format("{} message{} lost", messages, messages == 1 ? " is" : "s are")
         : part.holds == mcap::Holds::unknown ? "messages may be lost"
                                              : "its messages are lost";
}

/// @return nullopt if records follow no damaged part, so that the file is at most cut
std::optional<Mending> rebuilding_of_mcap(std::span<const std::uint8_t> file) {
  const auto section = mcap::scan_data_section(file, OnDamage::skip);
  if (section && section->damaged.empty() && !section->error) {
    return std::nullopt;
  }
  const auto front = mcap::scan_data_section(file);
  auto rebuilt = mcap::rebuild(file);
  if (!rebuilt || rebuilt->summary.chunks.empty()) {
    return !front || front->error ? std::optional(Mending{.damaged = true}) : std::nullopt;
  }
  const auto is_last = [&](const Damage& part) { return part.offset + part.size == file.size(); };
  if (front && !front->error && std::ranges::all_of(rebuilt->damaged, is_last)) {
    return std::nullopt;
  }
  Mending mending{.damaged = true, .parts = std::move(rebuilt->parts)};
  add_damage(mending.losses, rebuilt->damaged, lost_messages);
  return mending;
}

std::optional<Mending> mending_of_mcap(std::span<const std::uint8_t> file) {
  if (mcap::begins_as_mcap(file) && mcap::read_summary(file)) {
    return std::nullopt;
  }
  if (auto rebuilding = rebuilding_of_mcap(file)) {
    return rebuilding;
  }
  auto recovery = mcap::recover(file);
  if (!recovery) {
    return Mending{.damaged = true};
  }
  return Mending{
      .keep_size = recovery->keep_size, .end = std::move(recovery->end), .lost_size = recovery->lost_size};
}

// Every block ends with its length, so the last length shows whether the file ends with a whole block.
bool ends_with_a_block(std::span<const std::uint8_t> file) {
  if (file.size() < 12) {
    return false;
  }
  std::uint64_t length = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    length |= std::uint64_t{file[file.size() - 4 + i]} << (8 * i);
  }
  if (length > file.size()) {
    return false;
  }
  const auto block = pcapng::block_at(file, file.size() - static_cast<std::size_t>(length));
  return block && *block && (*block)->end() == file.size() &&
         ((*block)->type == static_cast<std::uint32_t>(pcapng::BlockType::enhanced_packet) ||
          (*block)->type == static_cast<std::uint32_t>(pcapng::BlockType::interface_description));
}

/// The readable blocks before and after damage; only the blocks before it if an interface may be among the
/// damaged ones, because packets name interfaces by their number.
Mending rebuilding_of_pcapng(std::span<const std::uint8_t> file, std::uint64_t front_size) {
  bool has_packet = false;
  bool adds_interface = false;
  const auto damaged = pcapng::for_each_block(file, [&](const pcapng::Block& block) {
    const bool is_packet = block.type == static_cast<std::uint32_t>(pcapng::BlockType::enhanced_packet);
    has_packet = has_packet || (is_packet && block.offset < front_size);
    adds_interface = adds_interface || (!is_packet && block.offset >= front_size);
  });
  const bool takes_all = damaged && has_packet && !adds_interface;
  Mending mending{.damaged = true};
  if (takes_all) {
    mending.parts = undamaged_parts(*damaged, file.size());
    add_damage(mending.losses, *damaged, [](const Damage&) { return "its packets are lost"; });
  } else {
    mending.parts.push_back({.offset = 0, .size = front_size});
    mending.losses.push_back(fmt::format("the last {} bytes are lost", file.size() - front_size));
  }
  return mending;
}

/// A new section header and new descriptions of the lost interfaces, then all readable blocks. Interfaces are
/// described before all packets, so the lost ones were the first.
Mending rebuilding_of_pcapng_start(std::span<const std::uint8_t> file) {
  std::uint32_t described = 0;
  std::uint32_t used = 0;
  const auto damaged = pcapng::for_each_block(file, [&](const pcapng::Block& block) {
    if (block.type == static_cast<std::uint32_t>(pcapng::BlockType::interface_description)) {
      ++described;
    } else if (block.type == static_cast<std::uint32_t>(pcapng::BlockType::enhanced_packet)) {
      const auto packet = pcapng::read_packet(block);
      used = packet && packet->interface < most_interfaces ? std::max(used, packet->interface + 1) : used;
    }
  });
  if (!damaged || used == 0) {
    return {.damaged = true};
  }
  pcapng::Writer writer("sonard " SONARD_VERSION);
  for (std::uint32_t lost = described; lost < used; ++lost) {
    writer.add_interface("lost");
  }
  Mending mending{.damaged = true, .parts = undamaged_parts(*damaged, file.size())};
  mending.parts.insert(mending.parts.begin(), RebuiltPart{.made = writer.take()});
  add_damage(mending.losses, *damaged, [&](const Damage& part) {
    return part.offset > 0     ? "its packets are lost"
           : used <= described ? "no packet is lost"
                               : "names of interfaces are lost";
  });
  return mending;
}

std::optional<Mending> mending_of_pcapng(std::span<const std::uint8_t> file) {
  if (!pcapng::begins_with_section(file)) {
    return rebuilding_of_pcapng_start(file);
  }
  if (ends_with_a_block(file)) {
    return std::nullopt;
  }
  const auto recovery = pcapng::recover(file);
  if (!recovery) {
    return Mending{.damaged = true};
  }
  if (recovery->keep_size == file.size()) {
    return std::nullopt;
  }
  // Damaged if block_at() returns an error, not just the end: the bytes are not a block.
  if (!pcapng::block_at(file, recovery->keep_size)) {
    return rebuilding_of_pcapng(file, recovery->keep_size);
  }
  return Mending{.keep_size = recovery->keep_size, .lost_size = file.size() - recovery->keep_size};
}

// True if the .glf of a .dat is complete and only the removal of the .dat is missing.
bool is_packed(const fs::path& dat, const glf::DatIndex& index) {
  const MappedFile archive(glf_path(dat.parent_path(), stem_of_dat(dat)));
  const auto packed = glf::LogView::open(archive.bytes());
  return !archive.bytes().empty() && packed && packed->index().closed &&
         packed->index().whole_size == index.whole_size;
}

bool begins_like_a_record(const fs::path& dat) {
  const MappedFile file(dat);
  return !file.bytes().empty() && file.bytes().front() == '*';
}

/// All whole records of a damaged .dat.
Mending rebuilding_of_dat(const glf::DatIndex& index) {
  Mending mending{.damaged = true};
  if (!index.records.empty()) {
    mending.parts = undamaged_parts(index.damaged, index.whole_size);
  }
  std::vector<Damage> damaged = index.damaged;
  if (index.tail_size > 0 && index.tail_error) {
    damaged.push_back({index.whole_size, index.tail_size, *index.tail_error});
  }
  add_damage(mending.losses, damaged, [](const Damage&) { return "its records are lost"; });
  return mending;
}

/// Returns true if the .dat must be packed. Packing removes a .dat without a whole record.
bool recover_dat(const fs::path& path) {
  glf::DatIndex index;
  {
    const MappedFile file(path);
    index = glf::index_dat(glf::PiecewiseBytes(file.bytes()), OnDamage::skip);
  }
  if (is_packed(path, index)) {
    std::error_code ignored;
    fs::remove(path, ignored);
    spdlog::info("recording: removed {}, which was already packed", path.string());
    return false;
  }
  const bool cut =
      index.damaged.empty() && (!index.tail_error || index.tail_error->reason == WireErrorReason::truncated);
  if (!cut || (index.records.empty() && !begins_like_a_record(path))) {
    rebuild(path, rebuilding_of_dat(index));
  } else {
    tell_recovered(path, index.tail_size);
  }
  std::error_code ignored;
  return fs::exists(path, ignored);
}

void recover_file(const fs::path& path, std::vector<fs::path>& dats) {
  std::error_code ignored;
  const std::string extension = path.extension();
  const bool ours = extension == ".mcap" || extension == ".pcapng" || !stem_of_dat(path).empty();
  if (ours && fs::file_size(path, ignored) == 0) {
    fs::remove(path, ignored);
    spdlog::info("recording: removed {}, which is empty", path.string());
    return;
  }
  if (const MappedFile file(path); ours && file.error()) {  // not damaged: it cannot be read
    spdlog::warn(
        "recording: cannot read {}: {}. The log stays as it is; to recover it, give the user that "
        "runs sonard the right to read and write it",
        path.string(), file.error().message());
    return;
  }
  if (!stem_of_dat(path).empty()) {
    if (recover_dat(path)) {
      dats.push_back(path);
    }
    return;
  }
  std::optional<Mending> mending;
  if (extension == ".mcap") {
    mending = mending_of_mcap(MappedFile(path).bytes());
  } else if (extension == ".pcapng") {
    mending = mending_of_pcapng(MappedFile(path).bytes());
  }
  if (mending) {
    mend(path, *mending);
  }
}

}  // namespace

std::vector<fs::path> recover_logs(const fs::path& directory) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, error)) {
    files.push_back(entry.path());
  }
  std::ranges::sort(files);
  std::vector<fs::path> dats;
  for (const fs::path& path : files) {
    if (path.string().ends_with(".glf.part")) {
      fs::remove(path, error);  // its .dat still exists
    } else if (fs::is_regular_file(path, error)) {
      recover_file(path, dats);
    }
  }
  return dats;
}

}  // namespace sonard::server
