// SPDX-License-Identifier: Apache-2.0
// Descriptors, threads or memory have run out: a limit of the process or its machine, and no defect.
#pragma once

#include <exception>
#include <optional>
#include <string>

namespace sonard::server {

/// What has run out, in a sentence that names the limit; nullopt: the error is another one. Any thread.
std::optional<std::string> exhausted(const std::exception& error);

/// Starts so many threads at once and ends them: a library that waits for threads it could not start (Mesa
/// does) hangs without a word. @throws std::system_error, which is exhausted()
void make_sure_of_threads(unsigned count);

/// From here on an exception that nobody catches ends the process with that sentence and exit_exhausted,
/// where something has run out: in a thread of a library, say. Any other aborts, as before.
void end_by_sentence_when_exhausted();

}  // namespace sonard::server
