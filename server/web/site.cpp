// SPDX-License-Identifier: Apache-2.0
#include "server/web/site.hpp"

#include <algorithm>
#include <bit>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/web/access.hpp"
#include "server/web/assets.hpp"
#include "server/web/head_picture.hpp"
#include "server/web/json.hpp"
#include "server/web/live_frame.hpp"
#include "server/web/metrics.hpp"
#include "server/web/world_view.hpp"

namespace sonard::server {

namespace http = boost::beast::http;

namespace {

constexpr std::chrono::milliseconds status_age{250};
constexpr std::chrono::milliseconds least_interval{50};
constexpr std::chrono::milliseconds interval_of_each{15};
constexpr std::size_t most_frames = 8;   // of different heads and sizes at one time
constexpr std::size_t most_lines = 400;  // of a scanning head: one turn of its finest steps

std::string_view as_view(boost::beast::string_view text) {
  return {text.data(), text.size()};
}

HttpResponse response(const HttpRequest& request, http::status status, std::string_view type,
                      std::string body) {
  HttpResponse answer{status, request.version()};
  answer.set(http::field::server, "sonard");
  answer.set(http::field::content_type, boost::beast::string_view(type.data(), type.size()));
  answer.set(http::field::cache_control, "no-store");
  answer.set("X-Content-Type-Options", "nosniff");
  answer.set("Content-Security-Policy",
             "default-src 'self'; img-src 'self' blob: data:; style-src 'self'; frame-ancestors 'none'");
  answer.keep_alive(request.keep_alive());
  answer.body() = std::move(body);
  answer.prepare_payload();
  if (request.method() == http::verb::head) {
    answer.body().clear();  // the Content-Length stays as for GET
  }
  return answer;
}

HttpResponse json_response(const HttpRequest& request, http::status status, const nlohmann::json& json) {
  return response(request, status, "application/json", text_of(json) + "\n");
}

std::string_view path_of(const HttpRequest& request) {
  const std::string_view target = as_view(request.target());
  return target.substr(0, target.find('?'));
}

bool reads(const HttpRequest& request) {
  return request.method() == http::verb::get || request.method() == http::verb::head;
}

}  // namespace

HttpResponse error_response(const HttpRequest& request, http::status status, const std::string& text) {
  return json_response(request, status, {{"error", text}});
}

void keep_newest(Pings& pings, const std::shared_ptr<const ShownPing>& ping) {
  const auto size_of = [](const ShownPing& of) {
    return std::tuple(of.record.settings.beams, of.record.settings.bins, of.record.settings.bin_m);
  };
  if (ping->record.settings.beams > 1 || (!pings.empty() && size_of(*pings.back()) != size_of(*ping))) {
    pings.clear();
  } else if (pings.size() == most_lines) {
    pings.erase(pings.begin());
  }
  pings.push_back(ping);
}

Site::Site(WebConfig config, WebSources sources, Draw draw)
    : config_(std::move(config)),
      sources_(std::move(sources)),
      draw_(std::move(draw)),
      started_(clock_.now()),
      connections_(config_.max_viewers, config_.max_viewers_per_peer) {}

Site::~Site() = default;

// ---- Requests

std::optional<std::string> Site::refusal(const HttpRequest& request) const {
  const std::string_view host = as_view(request[http::field::host]);
  if (!trusted_host(host)) {
    return "The Host header is neither an IP address nor localhost; open the page by its address.";
  }
  const std::string_view origin = as_view(request[http::field::origin]);
  if (!trusted_origin(origin, host, config_)) {
    return fmt::format("Origin {} may not connect; to permit it, add it to web.origins in the configuration.",
                       origin);
  }
  return std::nullopt;
}

void Site::answer(const HttpRequest& request, const Endpoint& peer,
                  const std::function<void(HttpResponse)>& send) {
  const std::string_view path = path_of(request);
  if (const auto why = refusal(request)) {
    send(error_response(request, http::status::forbidden, *why));
  } else if (path == "/api/recording") {
    send(change_recording(request, peer));
  } else if (!reads(request)) {
    send(error_response(request, http::status::method_not_allowed, "Method not allowed; use GET."));
  } else if (path == "/api/status") {
    with_status_text([request, send](const std::shared_ptr<const std::string>& text) {
      send(response(request, http::status::ok, "application/json", *text));
    });
  } else if (path == "/metrics") {
    with_status([this, request, send](const DaemonStatus& status) {
      send(response(request, http::status::ok, "text/plain; version=0.0.4; charset=utf-8",
                    metrics_text(sources_.identity, status, uptime())));
    });
  } else if (path == "/health") {
    // An answer proves that the I/O thread runs; a failing renderer ends the daemon.
    with_status([request, send](const DaemonStatus&) {
      send(json_response(request, http::status::ok, {{"status", "ok"}}));
    });
  } else if (path == "/ready") {
    with_status([request, send](const DaemonStatus& status) {
      const nlohmann::json answer = readiness_json(status);
      const bool ready = answer["ready"].get<bool>();
      send(json_response(request, ready ? http::status::ok : http::status::service_unavailable, answer));
    });
  } else if (answer_world(request, path, send)) {
    return;
  } else if (const Asset* asset = find_asset(path == "/" ? "/index.html" : path)) {
    send(response(request, http::status::ok, asset->type, std::string(asset->bytes)));
  } else {
    send(error_response(request, http::status::not_found, "Not found."));
  }
}

bool Site::answer_world(const HttpRequest& request, std::string_view path,
                        const std::function<void(HttpResponse)>& send) {
  std::function<std::string()> make;
  const render::World& world = sources_.world;
  if (path == "/api/world") {
    make = [&world] { return text_of(world_json(world)); };
  } else if (path == "/api/world/top.png") {
    make = [&world] { return world_png(world, ViewFrom::above); };
  } else if (path == "/api/world/side.png") {
    make = [&world] { return world_png(world, ViewFrom::south); };
  } else {
    return false;
  }
  std::shared_ptr<SharedText>& kept = world_[std::string(path)];
  if (!kept) {
    kept = std::make_shared<SharedText>();
  }
  kept->get(
      draw_, [make] { return std::make_shared<const std::string>(make()); },
      [request, send, type = path.ends_with(".png") ? "image/png" : "application/json"](const Text& made) {
        send(made ? response(request, http::status::ok, type, *made)
                  : error_response(request, http::status::internal_server_error,
                                   "This view of the world cannot be drawn; see the log for the reason."));
      });
  return true;
}

HttpResponse Site::change_recording(const HttpRequest& request, const Endpoint& peer) {
  if (request.method() != http::verb::post) {
    return error_response(request, http::status::method_not_allowed,
                          "Method not allowed; use POST with {\"on\": true} or {\"on\": false}.");
  }
  if (!may_change(peer, as_view(request[http::field::authorization]), config_)) {
    return error_response(
        request, http::status::forbidden,
        "Only clients on this machine, or clients that send the token (web.token), may change this.");
  }
  if (!sources_.turn_recording) {
    return error_response(request, http::status::conflict,
                          "Recording is not configured; add a section `recording` to the configuration.");
  }
  const auto wish = json_of_peer(request.body());
  if (!wish.is_object() || !wish.contains("on") || !wish["on"].is_boolean()) {
    return error_response(request, http::status::bad_request,
                          "Invalid body; expected {\"on\": true} or {\"on\": false}.");
  }
  sources_.turn_recording(wish["on"].get<bool>());
  return json_response(request, http::status::ok, {{"on", wish["on"]}});
}

// ---- Status

void Site::with_status(std::function<void(const DaemonStatus&)> take) {
  if (status_ && now() - status_at_ < status_age) {
    take(*status_);
    return;
  }
  waiting_.push_back(std::move(take));
  if (waiting_.size() == 1) {
    sources_.ask_status([this](DaemonStatus status) { took_status(std::move(status)); });
  }
}

void Site::took_status(DaemonStatus status) {
  status_ = std::move(status);
  status_at_ = now();
  for (const auto& take : std::exchange(waiting_, {})) {
    take(*status_);
  }
}

void Site::with_status_text(std::function<void(std::shared_ptr<const std::string>)> take) {
  with_status([this, take = std::move(take)](const DaemonStatus& status) {
    take(std::make_shared<const std::string>(text_of(status_json(sources_.identity, status, uptime()))));
  });
}

// ---- Connections

void Site::log_refusal(const Endpoint& peer, const std::string& why) {
  if (const std::uint64_t count = refusals_.count(why); std::has_single_bit(count)) {
    spdlog::warn("web: {} refused: {} ({} so far)", endpoint_text(peer), why, count);
  }
}

void Site::add(const std::shared_ptr<Viewer>& viewer) {
  std::erase_if(viewers_, [](const std::weak_ptr<Viewer>& other) { return other.expired(); });
  viewers_.push_back(viewer);
}

void Site::show(const std::shared_ptr<const ShownPing>& ping) {
  keep_newest(last_pings_[ping->head], ping);
  std::erase_if(frames_, [&](const Frame& frame) { return frame.ping->head == ping->head; });
  for (const std::weak_ptr<Viewer>& weak : viewers_) {
    if (const auto viewer = weak.lock()) {
      viewer->show(ping);
    }
  }
}

void Site::count_waiting(std::ptrdiff_t bytes) {
  waiting_bytes_ += static_cast<std::size_t>(bytes);
  if (bytes > 0 && waiting_bytes_ > most_waiting_bytes) {
    close_the_slowest();
  }
}

void Site::close_the_slowest() {
  std::shared_ptr<Viewer> slowest;
  for (const std::weak_ptr<Viewer>& weak : viewers_) {
    auto viewer = weak.lock();
    if (viewer && viewer->waits_since() && (!slowest || viewer->waits_since() < slowest->waits_since())) {
      slowest = std::move(viewer);
    }
  }
  if (slowest) {
    slowest->close();
  }
}

void Site::close() {
  for (const std::weak_ptr<Viewer>& weak : std::exchange(viewers_, {})) {
    if (const auto viewer = weak.lock()) {
      viewer->close();
    }
  }
  waiting_.clear();
  for (const auto& [path, text] : world_) {
    text->close();
  }
}

const Pings& Site::last_pings(int head) const {
  static const Pings none;
  const auto found = last_pings_.find(head);
  return found == last_pings_.end() ? none : found->second;
}

std::chrono::milliseconds Site::interval() const {
  return std::max(least_interval, interval_of_each * static_cast<int>(viewers_.size()));
}

Text Site::picture_of(int head, const std::string& name) {
  const Pings& pings = last_pings(head);
  if (pings.empty()) {
    return nullptr;
  }
  std::shared_ptr<HeadPicture>& picture = pictures_[head];
  if (!picture) {
    picture = std::make_shared<HeadPicture>();
  }
  if (picture->begin(pings.back(), now(), 2 * interval())) {
    draw_([picture, pings, name] { return picture->draw(pings, name); },
          [this, picture, head](const Text& drawn) {
            picture->drawn(drawn);
            for (const std::weak_ptr<Viewer>& weak : viewers_) {
              if (const auto viewer = weak.lock()) {
                viewer->show_picture(head, drawn);
              }
            }
          });
  }
  return picture->text();
}

void Site::with_frame(const Pings& pings, int max_rows, std::function<void(Text)> take) {
  const auto make = [this, pings, max_rows] {
    return std::make_shared<const std::string>(live_frame(pings, max_rows, now()));
  };
  const std::shared_ptr<const ShownPing>& ping = pings.back();
  if (ping->record.settings.beams == 1) {
    draw_(make, std::move(take));
    return;
  }
  // A frame contains the age of its ping, so it is valid only for a short time.
  std::erase_if(frames_, [this](const Frame& frame) { return now() - frame.made > status_age; });
  const auto known = std::ranges::find_if(
      frames_, [&](const Frame& frame) { return frame.ping == ping && frame.max_rows == max_rows; });
  if (known != frames_.end()) {
    known->bytes->get(draw_, make, std::move(take));
    return;
  }
  if (frames_.size() == most_frames) {
    frames_.erase(frames_.begin());
  }
  frames_.push_back({ping, max_rows, now(), std::make_shared<SharedText>()});
  const std::shared_ptr<SharedText> frame = frames_.back().bytes;
  frame->get(draw_, make, std::move(take));
}

}  // namespace sonard::server
