// SPDX-License-Identifier: Apache-2.0
// Errors of exhausted descriptors, threads or memory: a limit of the process or machine, not a defect.
#pragma once

#include <exception>
#include <optional>
#include <string>

namespace sonard::server {

/// A sentence that names the exhausted resource and its limit; nullopt for other errors. Any thread.
std::optional<std::string> exhausted(const std::exception& error);

/// Starts `count` threads at once and ends them. Mesa hangs without a message if it cannot start its threads.
/// @throws std::system_error, for which exhausted() returns a sentence
void make_sure_of_threads(unsigned count);

/// From now on, an uncaught exception in any thread ends the process: if a resource is exhausted, with that
/// sentence and exit_exhausted. Any other exception aborts.
void end_by_sentence_when_exhausted();

}  // namespace sonard::server
