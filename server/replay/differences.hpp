// What a client asks for and a recording does not have.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/gemini/ping_job.hpp"
#include "server/logs/recording.hpp"

namespace sonard::server {

enum class Difference { range, compression, gain, sound_speed, sixteen_bit, run_lengths, listening_only };
inline constexpr std::size_t difference_count = 7;

std::string_view name_of(Difference kind);

/// How `asked` differs from what is sent in its place, in one phrase ("range 20.00 m asked for, 4.00 m
/// sent"); nullopt: in this it does not. Rounding of the wire and of logs is no difference.
std::optional<std::string> difference(Difference kind, const gemini::PingJob& asked,
                                      const gemini::RecordedPing& sent, const RecordedSettings& recorded);

/// Pings with a difference, by kind. I/O thread.
class DifferenceLog {
 public:
  explicit DifferenceLog(std::string head) : head_(std::move(head)) {}

  /// Logs a kind when it first comes.
  void add(const gemini::PingJob& asked, const gemini::RecordedPing& sent, const RecordedSettings& recorded);
  /// Logs how many pings had which; nothing where none had any.
  void log_totals() const;

 private:
  std::string head_;
  std::array<std::uint64_t, difference_count> pings_{};
};

}  // namespace sonard::server
