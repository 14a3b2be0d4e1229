// SPDX-License-Identifier: Apache-2.0
// State that all connections of the page share.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include "renderer/scene/world.hpp"
#include "server/clock/clock.hpp"
#include "server/devices/ping_viewer.hpp"
#include "server/program_log/reasons.hpp"
#include "server/web/connections.hpp"
#include "server/web/shared_text.hpp"
#include "server/web/status.hpp"
#include "server/web/web_config.hpp"

namespace sonard::server {

/// The page's access to the daemon. Called on the page's thread.
struct WebSources {
  /// Passes the status to a function, later, on the page's thread.
  std::function<void(std::function<void(DaemonStatus)>)> ask_status;
  std::function<void(bool on)> turn_recording;  ///< empty: nothing is recorded
  DaemonIdentity identity;
  const render::World& world;  ///< must outlive the page
};

using Pings = std::vector<std::shared_ptr<const ShownPing>>;

/// Adds a ping to the pings of the same head. A fan replaces the one before. Lines of a scanning head stay
/// for a turn of its finest steps, if they have the size of the new one.
void keep_newest(Pings& pings, const std::shared_ptr<const ShownPing>& ping);

class HeadPicture;

/// A connection that shows pings.
class Viewer {
 public:
  Viewer() = default;
  virtual ~Viewer() = default;
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  virtual void show(const std::shared_ptr<const ShownPing>& ping) = 0;
  /// A picture of a head was drawn after a call of Site::picture_of().
  virtual void show_picture(int /*head*/, const Text& /*picture*/) {}
  /// Time at which the current message began to wait; nullopt: no message waits.
  virtual std::optional<TimePoint> waits_since() const = 0;
  virtual void close() = 0;
};

using HttpRequest = boost::beast::http::request<boost::beast::http::string_body>;
using HttpResponse = boost::beast::http::response<boost::beast::http::string_body>;

/// {"error": text}
HttpResponse error_response(const HttpRequest& request, boost::beast::http::status status,
                            const std::string& text);

/// Belongs to the page's thread.
class Site {
 public:
  Site(WebConfig config, WebSources sources, Draw draw);
  ~Site();
  Site(const Site&) = delete;
  Site& operator=(const Site&) = delete;

  const WebConfig& config() const { return config_; }
  const WebSources& sources() const { return sources_; }

  /// Answers a request other than a WebSocket's.
  void answer(const HttpRequest& request, const Endpoint& peer,
              const std::function<void(HttpResponse)>& send);
  /// Why a request is refused for any target; nullopt: it is served.
  std::optional<std::string> refusal(const HttpRequest& request) const;
  /// The status, no older than a quarter of a second.
  void with_status(std::function<void(const DaemonStatus&)> take);
  /// Text of the status as JSON, no older than a quarter of a second.
  void with_status_text(std::function<void(std::shared_ptr<const std::string>)> take);

  // ---- Connections

  Connections& connections() { return connections_; }
  /// Logs a refusal: the 1st, 2nd, 4th, ... time for each reason.
  void log_refusal(const Endpoint& peer, const std::string& why);
  void add(const std::shared_ptr<Viewer>& viewer);
  /// Keeps the ping and passes it to all viewers.
  void show(const std::shared_ptr<const ShownPing>& ping);
  /// First pings for a new viewer of a head: the newest ping, or the last lines of a scanning head, all of
  /// one size, oldest first. Empty: no ping was sent yet.
  const Pings& last_pings(int head) const;
  /// Counts bytes that begin to wait for viewers, or (negative) that no longer wait. If more than
  /// most_waiting_bytes wait, closes the viewer whose message has waited longest.
  void count_waiting(std::ptrdiff_t bytes);
  /// Closes all viewers, and drops all waiting requests.
  void close();

  /// Interval between two pings of one head to one viewer: the more viewers, the longer.
  std::chrono::milliseconds interval() const;
  /// Passes live_frame() of these pings to a function, at once or later; null: it cannot be made. The frame
  /// of a fan is made once for all viewers that request the same size.
  void with_frame(const Pings& pings, int max_rows, std::function<void(Text)> take);
  /// The newest picture of a head for Foxglove; null: not drawn yet. If a newer one is due, it is drawn once
  /// for all viewers and passed to them by Viewer::show_picture().
  Text picture_of(int head, const std::string& name);
  TimePoint now() const { return clock_.now(); }

  static constexpr std::size_t most_waiting_bytes = 64 << 20;

 private:
  void took_status(DaemonStatus status);
  std::chrono::duration<double> uptime() const { return now() - started_; }
  HttpResponse change_recording(const HttpRequest& request, const Endpoint& peer);
  bool answer_world(const HttpRequest& request, std::string_view path,
                    const std::function<void(HttpResponse)>& send);
  void close_the_slowest();

  const WebConfig config_;
  const WebSources sources_;
  const Draw draw_;
  SteadyClock clock_;
  const TimePoint started_;
  Connections connections_;
  Reasons refusals_;
  std::size_t waiting_bytes_ = 0;
  std::vector<std::weak_ptr<Viewer>> viewers_;
  std::map<int, Pings> last_pings_;                       ///< by head
  std::map<int, std::shared_ptr<HeadPicture>> pictures_;  ///< by head; only requested ones

  std::optional<DaemonStatus> status_;  ///< newest
  TimePoint status_at_{};
  std::vector<std::function<void(const DaemonStatus&)>> waiting_;  ///< for the requested status

  struct Frame {
    std::shared_ptr<const ShownPing> ping;
    int max_rows = 0;
    TimePoint made{};
    std::shared_ptr<SharedText> bytes;
  };
  std::vector<Frame> frames_;  ///< of the newest pings

  std::map<std::string, std::shared_ptr<SharedText>, std::less<>> world_;  ///< by path; only requested ones
};

}  // namespace sonard::server
