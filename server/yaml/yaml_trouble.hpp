// SPDX-License-Identifier: Apache-2.0
// Why a text is invalid YAML, or a value is not as expected, in terms of the text that the user wrote.
#pragma once

#include <string>
#include <string_view>

#include "server/yaml/config_error.hpp"

namespace sonard::server {

/// The problem in a text that the YAML parser rejected at `at` with the message `complaint`. Names tabs,
/// indents, IPv6 addresses, keys without a colon or without a blank after it, and unclosed quotes and
/// brackets, at their own places; otherwise passes on the parser's message.
ConfigProblem yaml_trouble(std::string_view text, SourcePosition at, const std::string& complaint);

/// Why "world:empty" is one word and no key with a value; empty if the text is not of this form.
std::string missing_blank(std::string_view text);

/// Why "level off" or "level = off" is no key with a value; empty if the text is not of this form.
std::string missing_colon(std::string_view text);

/// "20,5" as "20.5"; empty if the text is no number with a decimal comma.
std::string with_decimal_point(std::string_view text);

/// Whether it is an IPv6 address, also with a port ("[::1]:14600") or a prefix length ("fe80::/64").
bool is_ipv6(std::string_view text);

/// A text of the user in quotes: 'text'. A long text is cut, and its length is appended.
std::string in_quotes(std::string_view text);

}  // namespace sonard::server
