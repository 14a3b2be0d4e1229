// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping360/type.hpp"

#include "protocol/ping360/device.hpp"
#include "protocol/ping360/make_job.hpp"
#include "protocol/ping360/recorded_form.hpp"
#include "protocol/ping360/usual_scan.hpp"
#include "server/devices/ping/type.hpp"
#include "server/devices/ping360/config.hpp"
#include "server/devices/ping360/connected.hpp"
#include "server/devices/ping360/section.hpp"
#include "server/devices/ping360/settings.hpp"
#include "server/devices/ping360/survey.hpp"

namespace sonard::server {
namespace {

class Ping360Type final : public PingType<Ping360Config> {
 public:
  std::string_view name() const override { return "ping360"; }
  std::string_view title() const override { return "Ping360"; }

  std::string summary(const HeadConfig& head) const override {
    const auto& discovery = settings(head).discovery;
    return PingType::summary(head) + (discovery ? ", found as " + address_text(discovery->address) : "");
  }
  std::vector<Counter> counters() const override { return ping360::Device({}, {}).counts(); }

  std::unique_ptr<ConnectedDevice> connect(const HeadConfig& head, boost::asio::io_context& io,
                                           const Clock& clock) const override {
    return connect_ping360(head, io, clock);
  }

  PingJob usual_job(const HeadConfig& head) const override {
    const ping360::DeviceConfig& device = settings(head).device;
    ping360::AutoTransmit scan =
        ping360::usual_scan(10.0, std::nullopt, 1500.0, device.bearing_offset).value();
    scan.gain_setting = 1;
    return ping360::make_job(ping360::form_of(scan, device.bearing_offset), device);
  }

  render::SonarSettings sonar_settings(const PingJob& job, const HeadConfig& head) const override {
    return ping360_sonar_settings(job, head);
  }

  std::unique_ptr<Survey> survey(const HeadConfig& head, const SurveyOptions& options) const override {
    return survey_of_ping360(head, options);
  }

 protected:
  render::SonarSettings acoustics() const override { return ping360_acoustics(); }
  Ping360Config read_device(YamlSection& section, const HeadContext& context,
                            HeadConfig& head) const override {
    return read_ping360_head(section, context, head);
  }
  bool is_ping(std::span<const std::uint8_t> wire) const override {
    return ping360::recorded_form(wire).has_value();
  }
  int least_id() const override { return 1; }
  std::uint16_t usual_port() const override { return ping360_data_port; }
};

}  // namespace

const DeviceType& ping360_type() {
  static const Ping360Type type;
  return type;
}

}  // namespace sonard::server
