// SPDX-License-Identifier: Apache-2.0
// Why a text is no YAML, and why a value is not what was expected, in the words of the person who wrote it.
#pragma once

#include <string>
#include <string_view>

#include "server/config/config_error.hpp"

namespace sonard::server {

/// What is wrong with a text that the YAML parser gave up on at `at`, where it said `complaint`. Tabs,
/// indents, IPv6 addresses, and quotes and brackets that nothing closes, are named as such, at their own
/// place; all else is what the parser says.
ConfigProblem yaml_trouble(std::string_view text, SourcePosition at, const std::string& complaint);

/// "20,5" as "20.5"; empty for what is no number with a decimal comma.
std::string with_decimal_point(std::string_view text);

/// True for an IPv6 address, also with a port ("[::1]:14600") or a prefix length ("fe80::/64").
bool is_ipv6(std::string_view text);

/// A text of the user in quotes: 'text'; a long one is cut, and its length stands behind it.
std::string in_quotes(std::string_view text);

}  // namespace sonard::server
