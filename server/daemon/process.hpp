// SPDX-License-Identifier: Apache-2.0
// The daemon and its operating system: standard descriptors and signals.
#pragma once

#include <chrono>
#include <string_view>

namespace sonard::server {

/// Opens /dev/null on each of the descriptors 0, 1 and 2 that is closed. Otherwise a socket or world file
/// could get the number, and log lines would be written to it. Call it before anything is opened.
void open_standard_descriptors();

/// Ignores SIGPIPE for the rest of the process (a lost peer is a write error), and SIGUSR1 and SIGUSR2, which
/// have no meaning here. Ignores SIGHUP until catch_signals(). For the start of a daemon: SIGINT and SIGTERM
/// still end it at once.
void ignore_harmless_signals();

/// From now on, each SIGINT, SIGTERM and SIGHUP becomes one byte, its number, on a non-blocking descriptor. A
/// SIGINT or SIGTERM within `grace` of the first one is ignored as a duplicate (`timeout` sends two, a
/// terminal one to each process). A later one kills the process at once. A second call starts over.
/// @return the descriptor to read from, owned by the caller
/// @throws std::system_error
int catch_signals(std::chrono::nanoseconds grace);

/// True if a SIGINT or SIGTERM has arrived since catch_signals().
bool ordered_to_end();
/// Blocks SIGINT and SIGTERM until let_orders_to_end(), also for a program that replaces this one.
void hold_orders_to_end();
void let_orders_to_end();

/// Sends one line of the sd_notify(3) protocol, such as "READY=1", to the service manager (NOTIFY_SOCKET).
/// Does nothing if there is no service manager.
void tell_service_manager(std::string_view line);

}  // namespace sonard::server
