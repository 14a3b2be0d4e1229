// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping1d/type.hpp"

#include <memory>

#include <boost/asio/io_context.hpp>

#include "protocol/ping1d/device.hpp"
#include "protocol/ping1d/recorded_form.hpp"
#include "protocol/ping1d/scan.hpp"
#include "server/devices/ping/type.hpp"
#include "server/devices/ping1d/config.hpp"
#include "server/devices/ping1d/section.hpp"
#include "server/devices/ping1d/settings.hpp"
#include "server/devices/ping1d/survey.hpp"
#include "server/net/several_transports.hpp"

namespace sonard::server {
namespace {

class ConnectedPing1d final : public ConnectedDevice {
 public:
  ConnectedPing1d(const Ping1dConfig& config, boost::asio::io_context& io, const Clock& clock)
      : device_(config.device, clock.now()),
        transport_(open_transports(config, config.device.serial_channel >= 0, io, clock)) {}

  Device& device() override { return device_; }
  Transport& transport() override { return transport_; }

 private:
  ping1d::Device device_;
  SeveralTransports transport_;
};

class Ping1dType final : public PingType<Ping1dConfig> {
 public:
  std::string_view name() const override { return "ping1d"; }
  std::string_view title() const override { return "Ping1D"; }
  std::vector<std::string_view> models() const override { return {"ping2"}; }
  bool turns() const override { return false; }
  std::vector<Counter> counters() const override { return ping1d::Device({}, {}).counts(); }

  std::unique_ptr<ConnectedDevice> connect(const HeadConfig& head, boost::asio::io_context& io,
                                           const Clock& clock) const override {
    return std::make_unique<ConnectedPing1d>(settings(head), io, clock);
  }

  PingJob usual_job(const HeadConfig& head) const override {
    return ping1d::make_job(ping1d::usual_scan, settings(head).device);
  }

  render::SonarSettings sonar_settings(const PingJob& job, const HeadConfig& head) const override {
    return ping1d_sonar_settings(job, head);
  }

  std::unique_ptr<Survey> survey(const HeadConfig& head, const SurveyOptions& options) const override {
    return survey_of_ping1d(head, options);
  }

 protected:
  render::SonarSettings acoustics() const override { return ping1d_acoustics(Ping1dModel::ping1d); }
  Ping1dConfig read_device(YamlSection& section, const HeadContext& context,
                           HeadConfig& head) const override {
    return read_ping1d_head(section, context, head);
  }
  bool is_ping(std::span<const std::uint8_t> wire) const override {
    return ping1d::recorded_form(wire).has_value();
  }
  int least_id() const override { return 0; }
  std::uint16_t usual_port() const override { return ping1d_bridge_port; }
};

}  // namespace

const DeviceType& ping1d_type() {
  static const Ping1dType type;
  return type;
}

}  // namespace sonard::server
