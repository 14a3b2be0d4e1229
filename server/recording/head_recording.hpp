// A head's end of the recorder. Without a recorder nothing is done.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "server/clock.hpp"
#include "server/devices/datagram.hpp"
#include "server/recording/events.hpp"

namespace sonard::server {

class Recorder;

/// @param local what our end is where a datagram does not say it
WirePassed passed(std::span<const Datagram> datagrams, bool to_client, const Endpoint& local);

/// Belongs to the I/O thread, as its head does. Nothing here waits.
class HeadRecording {
 public:
  /// @param recorder null: nothing is recorded; otherwise it outlives this
  /// @param head its place in the configuration
  HeadRecording(Recorder* recorder, int head, const Clock& clock)
      : recorder_(recorder), head_(head), clock_(&clock) {}

  bool on() const { return recorder_ != nullptr; }

  /// @param local as passed() has it
  void datagrams(std::span<const Datagram> datagrams, bool to_client, const Endpoint& local) const;
  void piece(const WireEnds& ends, bool to_client, std::span<const std::uint8_t> bytes) const;
  void client_left(const WireEnds& ends) const;
  void gemini_status(const gemini::SharedBytes& datagram) const;
  void gemini_ping(GeminiPingServed ping) const;
  void micron_line(MicronLineSent line) const;
  void posed(const std::shared_ptr<const PosesUsed>& poses) const;

 private:
  template <class What>
  void push(What what) const;

  Recorder* recorder_;
  int head_;
  const Clock* clock_;
};

}  // namespace sonard::server
