// SPDX-License-Identifier: Apache-2.0
#include "server/web/foxglove_session.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "server/recording/foxglove_messages.hpp"
#include "server/web/assets.hpp"
#include "server/web/base64.hpp"
#include "server/web/foxglove_time.hpp"
#include "server/web/json.hpp"
#include "server/web/little_endian.hpp"

namespace sonard::server {

using nlohmann::json;

namespace {

constexpr std::size_t most_request_bytes = 65'536;
constexpr std::chrono::seconds status_each{1};

json object_schema(json properties) {
  return {{"type", "object"}, {"properties", std::move(properties)}};
}

/// Schemas of foxglove.CompressedImage, FrameTransform and PointCloud, with the fields of
/// docs.foxglove.dev/docs/visualization/message-schemas.
json timestamp_schema() {
  return object_schema({{"sec", {{"type", "integer"}}}, {"nsec", {{"type", "integer"}}}});
}

json image_schema() {
  return object_schema({{"timestamp", timestamp_schema()},
                        {"frame_id", {{"type", "string"}}},
                        {"data", {{"type", "string"}, {"contentEncoding", "base64"}}},
                        {"format", {{"type", "string"}}}});
}

json numbers_schema(std::string_view names) {
  json properties;
  for (const char name : names) {
    properties[std::string(1, name)] = {{"type", "number"}};
  }
  return object_schema(std::move(properties));
}

json transform_schema() {
  return object_schema({{"timestamp", timestamp_schema()},
                        {"parent_frame_id", {{"type", "string"}}},
                        {"child_frame_id", {{"type", "string"}}},
                        {"translation", numbers_schema("xyz")},
                        {"rotation", numbers_schema("xyzw")}});
}

json echoes_schema() {
  const json field = object_schema({{"name", {{"type", "string"}}},
                                    {"offset", {{"type", "integer"}, {"minimum", 0}}},
                                    {"type", {{"type", "integer"}}}});
  return object_schema({{"timestamp", timestamp_schema()},
                        {"frame_id", {{"type", "string"}}},
                        {"pose", object_schema({{"position", numbers_schema("xyz")},
                                                {"orientation", numbers_schema("xyzw")}})},
                        {"point_stride", {{"type", "integer"}, {"minimum", 0}}},
                        {"fields", {{"type", "array"}, {"items", field}}},
                        {"data", {{"type", "string"}, {"contentEncoding", "base64"}}}});
}

std::string status_schema() {
  const Asset* const schema = find_asset("/status.schema.json");
  return schema == nullptr ? "{}" : std::string(schema->bytes);
}

json transform_json(const render::Pose& T_world_head, const std::string& head, json timestamp) {
  const glm::dvec3& p = T_world_head.position_m;
  const glm::dquat& q = T_world_head.orientation;
  return {{"timestamp", std::move(timestamp)},
          {"parent_frame_id", "world"},
          {"child_frame_id", head},
          {"translation", {{"x", p.x}, {"y", p.y}, {"z", p.z}}},
          {"rotation", {{"x", q.x}, {"y", q.y}, {"z", q.z}, {"w", q.w}}}};
}

json echoes_json(const PingRecord& ping, const std::string& head, json timestamp) {
  const foxglove::PointCloud cloud = foxglove_echoes(ping, head, 0);
  json fields = json::array();
  for (const foxglove::PackedElementField& field : cloud.fields()) {
    fields.push_back({{"name", field.name()}, {"offset", field.offset()}, {"type", field.type()}});
  }
  return {{"timestamp", std::move(timestamp)},
          {"frame_id", head},
          {"pose",
           {{"position", {{"x", 0}, {"y", 0}, {"z", 0}}},
            {"orientation", {{"x", 0}, {"y", 0}, {"z", 0}, {"w", 1}}}}},
          {"point_stride", cloud.point_stride()},
          {"fields", std::move(fields)},
          {"data", base64(cloud.data())}};
}

/// @throws std::invalid_argument if the value is not an unsigned 32-bit integer
std::uint32_t id_of(const json& value) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
    throw std::invalid_argument(text_of(value) + " is not an ID");
  }
  return value.get<std::uint32_t>();
}

}  // namespace

FoxgloveSession::FoxgloveSession(Site& site, boost::beast::tcp_stream stream, const Endpoint& peer)
    : WebSocket(site, std::move(stream), peer, most_request_bytes), timer_(executor()) {}

void FoxgloveSession::close() {
  timer_.cancel();
  WebSocket::close();
}

void FoxgloveSession::opened() {
  send_text(text_of({{"op", "serverInfo"},
                     {"name", "sonard"},
                     {"capabilities", json::array()},
                     {"metadata", {{"world", site().sources().identity.world}}},
                     {"sessionId", std::to_string(site().now().count())}}));
  site().with_status([weak = weak<FoxgloveSession>()](const DaemonStatus& status) {
    if (const auto self = weak.lock()) {
      self->advertise(status);
      self->every_second();
    }
  });
}

void FoxgloveSession::advertise(const DaemonStatus& status) {
  json list = json::array();
  const auto add = [&](const Channel& channel, const std::string& topic, std::string_view schema_name,
                       const std::string& schema) {
    const auto id = static_cast<std::uint32_t>(channels_.size() + 1);
    channels_.emplace(id, channel);
    list.push_back({{"id", id},
                    {"topic", topic},
                    {"encoding", "json"},
                    {"schemaName", schema_name},
                    {"schemaEncoding", "jsonschema"},
                    {"schema", schema}});
  };
  for (const HeadStatus& head : status.heads) {
    const std::size_t place = heads_.size();
    heads_.push_back(head.name);
    add({place, Kind::image}, fmt::format("/{}/image", head.name), "foxglove.CompressedImage",
        text_of(image_schema()));
    add({place, Kind::transform}, fmt::format("/{}/transform", head.name), "foxglove.FrameTransform",
        text_of(transform_schema()));
    add({place, Kind::echoes}, fmt::format("/{}/echoes", head.name), "foxglove.PointCloud",
        text_of(echoes_schema()));
  }
  add({0, Kind::status}, "/status", "sonard.Status", status_schema());
  send_text(text_of({{"op", "advertise"}, {"channels", std::move(list)}}));
}

// ---- Requests of the other side

void FoxgloveSession::take(const std::string& text) {
  const json message = json_of_peer(text);
  const std::string op = message.is_object() && message.contains("op") && message["op"].is_string()
                             ? message["op"].get<std::string>()
                             : "";
  try {
    if (op == "subscribe") {
      std::set<std::size_t> heads;
      for (const json& wish : message.at("subscriptions")) {
        const auto channel = channels_.find(id_of(wish.at("channelId")));
        if (channel == channels_.end()) {
          complain(fmt::format("Channel {} does not exist.", text_of(wish["channelId"])));
        } else {
          subscriptions_[channel->second] = id_of(wish.at("id"));
          if (channel->second.kind != Kind::status) {
            heads.insert(channel->second.head);
          }
        }
      }
      std::ranges::for_each(heads, [this](std::size_t head) { show_last(head); });
    } else if (op == "unsubscribe") {
      for (const json& id : message.at("subscriptionIds")) {
        std::erase_if(subscriptions_, [&](const auto& known) { return known.second == id_of(id); });
      }
    } else {
      complain("Unknown operation: expected {\"op\": \"subscribe\"} or {\"op\": \"unsubscribe\"}.");
    }
  } catch (const std::exception& error) {
    complain(fmt::format("Invalid message: {}", error.what()));
  }
}

void FoxgloveSession::complain(const std::string& what) {
  send_text(text_of({{"op", "status"}, {"level", 2}, {"message", what}}));
}

// ---- Messages to the other side

void FoxgloveSession::every_second() {
  for (const auto& [channel, id] : subscriptions_) {
    if (channel.kind == Kind::status && has_room()) {
      site().with_status_text(
          [weak = weak<FoxgloveSession>()](const std::shared_ptr<const std::string>& text) {
            if (const auto self = weak.lock()) {
              self->send_on({0, Kind::status}, text);
            }
          });
    }
  }
  timer_.expires_after(status_each);
  timer_.async_wait([weak = weak<FoxgloveSession>()](const boost::system::error_code& error) {
    const auto self = weak.lock();
    if (self && !error) {
      self->every_second();
    }
  });
}

void FoxgloveSession::show(const std::shared_ptr<const ShownPing>& ping) {
  const auto head = static_cast<std::size_t>(ping->head);
  if (head >= heads_.size()) {
    return;  // the channels have not been announced yet
  }
  if (subscriptions_.contains({head, Kind::transform}) && ping->T_world_mount && has_room()) {
    send_on({head, Kind::transform}, std::make_shared<const std::string>(text_of(transform_json(
                                         *ping->T_world_mount, heads_[head], foxglove_time(ping->time)))));
  }
  if (subscriptions_.contains({head, Kind::echoes}) && has_room()) {
    send_on({head, Kind::echoes}, std::make_shared<const std::string>(text_of(
                                      echoes_json(ping->record, heads_[head], foxglove_time(ping->time)))));
  }
  if (subscriptions_.contains({head, Kind::image}) && has_room()) {
    show_picture(ping->head, site().picture_of(ping->head, heads_[head]));
  }
}

void FoxgloveSession::show_picture(int head, const Text& picture) {
  const auto place = static_cast<std::size_t>(head);
  if (picture && subscriptions_.contains({place, Kind::image}) && has_room() &&
      std::exchange(shown_[place], picture) != picture) {
    send_on({place, Kind::image}, picture);
  }
}

/// Shows a new subscriber the newest picture.
void FoxgloveSession::show_last(std::size_t head) {
  shown_.erase(head);
  if (const Pings& pings = site().last_pings(static_cast<int>(head)); !pings.empty()) {
    show(pings.back());
  }
}

/// Sends message data: opcode 1, the subscription, the time, and the message.
void FoxgloveSession::send_on(const Channel& channel, Text json_text) {
  const auto subscription = subscriptions_.find(channel);
  if (subscription == subscriptions_.end()) {
    return;
  }
  std::string head(1, '\1');
  append_number(head, subscription->second);
  append_number(head, static_cast<std::uint64_t>((site().now() + unix_time_offset()).count()));
  send({std::move(head), std::move(json_text), true});
}

}  // namespace sonard::server
