// SPDX-License-Identifier: Apache-2.0
// What a daemon settles with its operating system: standard descriptors and signals.
#pragma once

#include <chrono>
#include <string_view>

namespace sonard::server {

/// Opens /dev/null as whichever of the descriptors 0, 1 and 2 is closed: a socket or world file that took the
/// number would be written to as a log. Call it before anything is opened.
void open_standard_descriptors();

/// SIGPIPE is ignored for the rest of the process (a peer that goes is an error of the write), and so are
/// SIGUSR1 and SIGUSR2, which mean nothing here; SIGHUP is ignored until catch_signals(). For a daemon that
/// starts: SIGINT and SIGTERM still end it at once.
void ignore_harmless_signals();

/// From here on, for the rest of the process, each SIGINT, SIGTERM and SIGHUP is a byte, its number, to be
/// read without waiting. An order to end that comes within `grace` of the first one is that one once more
/// (`timeout` sends two, a terminal one to each process) and no byte; a later one kills at once, whatever
/// hangs. A second call starts over.
/// @return the descriptor to read from, which belongs to the caller
/// @throws std::system_error
int catch_signals(std::chrono::nanoseconds grace);

/// Whether a SIGINT or SIGTERM has come since catch_signals().
bool ordered_to_end();
/// SIGINT and SIGTERM wait, also for a program that replaces this one, until let_orders_to_end().
void hold_orders_to_end();
void let_orders_to_end();

/// Sends one line of the protocol of sd_notify(3), such as "READY=1", to the service manager that has started
/// this process (NOTIFY_SOCKET); does nothing where there is none.
void tell_service_manager(std::string_view line);

}  // namespace sonard::server
