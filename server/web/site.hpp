// SPDX-License-Identifier: Apache-2.0
// What all connections of the page share.
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
#include "server/config/config.hpp"
#include "server/devices/ping_viewer.hpp"
#include "server/web/status.hpp"

namespace sonard::server {

/// What the page asks of the daemon. Called on the thread of the page.
struct WebSources {
  /// Hands the status to a function, later, on the thread of the page.
  std::function<void(std::function<void(DaemonStatus)>)> ask_status;
  std::function<void(bool on)> turn_recording;  ///< empty: nothing is recorded
  DaemonIdentity identity;
  const render::World& world;  ///< outlives the page
};

using Pings = std::vector<std::shared_ptr<const ShownPing>>;

/// Adds a ping behind those of the same head. A fan replaces the one before; the lines of a scanning head
/// stay for a turn of its finest steps, if they have the size of the new one.
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
  virtual void close() = 0;
};

using HttpRequest = boost::beast::http::request<boost::beast::http::string_body>;
using HttpResponse = boost::beast::http::response<boost::beast::http::string_body>;

/// {"error": text}
HttpResponse error_response(const HttpRequest& request, boost::beast::http::status status,
                            const std::string& text);

/// Belongs to the thread of the page.
class Site {
 public:
  Site(WebConfig config, WebSources sources);
  ~Site();
  Site(const Site&) = delete;
  Site& operator=(const Site&) = delete;

  const WebConfig& config() const { return config_; }
  const WebSources& sources() const { return sources_; }

  /// Answers a request that is no WebSocket's.
  void answer(const HttpRequest& request, const Endpoint& peer, std::function<void(HttpResponse)> send);
  /// Why a request is not served, whatever it asks for; nullopt: it is.
  std::optional<std::string> refusal(const HttpRequest& request) const;
  /// The status, no older than a quarter of a second.
  void with_status(std::function<void(const DaemonStatus&)> take);
  /// Text of the status as JSON, no older than a quarter of a second.
  void with_status_text(std::function<void(std::shared_ptr<const std::string>)> take);

  // ---- Connections

  /// False: there are too many already.
  bool open_connection();
  void close_connection() { --connections_; }
  void add(const std::shared_ptr<Viewer>& viewer);
  /// Keeps the ping, and gives it to all viewers.
  void show(const std::shared_ptr<const ShownPing>& ping);
  /// What a new viewer of a head begins with: the newest ping, or the last lines of a scanning head, all of
  /// one size, the oldest first. Empty: no ping went out yet.
  const Pings& last_pings(int head) const;
  void close_viewers();

  /// Between two pings of one head to one viewer: the more there are, the longer.
  std::chrono::milliseconds interval() const;
  /// live_frame() of one ping; made once for all viewers who want it in one size.
  std::shared_ptr<const std::string> frame_of(const std::shared_ptr<const ShownPing>& ping, int max_rows);
  /// HeadPicture::newest() of a head from which pings have come; drawn once for all viewers.
  std::shared_ptr<const std::string> picture_of(int head, const std::string& name);
  TimePoint now() const { return clock_.now(); }

  static constexpr int most_connections = 128;

 private:
  void took_status(DaemonStatus status);
  std::chrono::duration<double> uptime() const { return now() - started_; }
  HttpResponse change_recording(const HttpRequest& request, const Endpoint& peer);
  std::optional<HttpResponse> world_answer(const HttpRequest& request, std::string_view path);

  const WebConfig config_;
  const WebSources sources_;
  SteadyClock clock_;
  const TimePoint started_;
  int connections_ = 0;
  std::vector<std::weak_ptr<Viewer>> viewers_;
  std::map<int, Pings> last_pings_;                       ///< by head
  std::map<int, std::unique_ptr<HeadPicture>> pictures_;  ///< by head; of those that were asked for

  std::optional<DaemonStatus> status_;  ///< the newest
  TimePoint status_at_{};
  std::vector<std::function<void(const DaemonStatus&)>> waiting_;  ///< for the status that was asked for

  struct Frame {
    std::shared_ptr<const ShownPing> ping;
    int max_rows = 0;
    TimePoint made{};
    std::shared_ptr<const std::string> bytes;
  };
  std::vector<Frame> frames_;  ///< of the newest pings

  std::optional<std::string> world_json_, world_above_, world_south_;  ///< once they were asked for
};

}  // namespace sonard::server
