// SPDX-License-Identifier: Apache-2.0
#include "server/web/section.hpp"

#include "server/yaml/network_section.hpp"

namespace sonard::server {

WebConfig read_web(YamlSection& section) {
  WebConfig web;
  section.introduce(
      "A page in the browser shows the images of each head, the world, the poses and current problems "
      "([page.md](page.md)). Monitors read `/health`, `/ready`, `/metrics` and `/api/status`.");
  read_socket(section, web.bind, web.allow, endpoint_form,
              "HTTP address of the page; the demo uses 127.0.0.1:8014",
              "address blocks that may open the page");
  section.text("token", web.token,
               "clients that send this token may also change state, for example start or stop the recording; "
               "browsers on this machine need no token");
  section.default_is("token", "no token: only browsers on this machine may change state");
  constexpr TextForm origins{"an origin such as https://example.org", "origins", R"("type": "string")"};
  section.parsed_list("origins", web.origins, &any_text, origins,
                      "other sites whose pages may connect from a browser");
  section.integer("max_viewers", web.max_viewers, 1, 1000,
                  "maximum number of WebSockets at a time; monitors always connect");
  section.integer("max_viewers_per_peer", web.max_viewers_per_peer, 1, 1000,
                  "maximum number of WebSockets (one per tab) from one address or proxy");
  return web;
}

}  // namespace sonard::server
