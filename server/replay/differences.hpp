// What a client asks for and a recording does not have.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/gemini/ping_job.hpp"
#include "protocol/micron/messages.hpp"
#include "protocol/micron/micron_job.hpp"
#include "server/logs/recording.hpp"

namespace sonard::server {

struct Difference {
  std::string_view kind;  ///< "range", "gain", ...
  std::string text;       ///< one phrase: "range 20.00 m asked for, 4.00 m sent"
};

/// How `asked` differs from what is sent in its place. Rounding of the wire and of logs is no difference.
std::vector<Difference> differences(const gemini::PingJob& asked, const gemini::RecordedPing& sent,
                                    const RecordedSettings& recorded);
std::vector<Difference> differences(const micron::HeadCommand& asked, const micron::MicronJob& sent,
                                    const micron::HeadData& recorded);

/// Pings with a difference, by kind. I/O thread.
class DifferenceLog {
 public:
  explicit DifferenceLog(std::string head) : head_(std::move(head)) {}

  /// Of one ping. Logs a kind when it first comes.
  void add(const std::vector<Difference>& found);
  /// Logs how many pings had which; nothing where none had any.
  void log_totals() const;

 private:
  std::string head_;
  std::vector<std::pair<std::string_view, std::uint64_t>> pings_;  ///< in the order in which kinds came
};

}  // namespace sonard::server
