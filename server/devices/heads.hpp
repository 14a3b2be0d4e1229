// From a head's configuration to the head: the one place that knows every type of head.
#pragma once

#include <memory>

#include "renderer/sonar_settings.hpp"
#include "server/config/config.hpp"
#include "server/devices/head.hpp"

namespace sonard::server {

/// @param stream number of this head among the users of the renderer
/// @throws SocketError naming the address or path
std::unique_ptr<Head> make_head(const AnyHeadConfig& config, int stream, const HeadServices& services);

/// One beam at a time, which takes a small part of the time of a fan to render.
bool is_scanning(const AnyHeadConfig& config);

/// Renderer settings of a ping as many clients ask for it: 20 m of a Gemini, 10 m of a Micron.
render::SonarSettings usual_settings(const AnyHeadConfig& config);

/// Cuts the head's fan into pixels as it will be for any ping; the range of a ping changes nothing of it.
/// @throws render::RequestError when that cannot be done
void check_sampling_of(const AnyHeadConfig& config);

}  // namespace sonard::server
