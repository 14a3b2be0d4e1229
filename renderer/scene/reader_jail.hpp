// SPDX-License-Identifier: Apache-2.0
// Removes all rights from a process except those for reading third-party files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#ifdef __has_feature
#define SONARD_HAS_FEATURE(name) __has_feature(name)
#else
#define SONARD_HAS_FEATURE(name) 0
#endif

namespace sonard::render {

/// Off with sanitizers, whose own tables use all of the address space.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || \
    SONARD_HAS_FEATURE(address_sanitizer) || SONARD_HAS_FEATURE(thread_sanitizer)
constexpr bool reader_memory_is_limited = false;
#else
constexpr bool reader_memory_is_limited = true;
#endif

/// Remaining rights of a reading process. They limit the damage of a faulty reader library.
struct ReaderJail {
  std::vector<std::filesystem::path> readable{};  ///< files, and folders with all their contents
  unsigned int processor_limit_s = 10;
  std::uint64_t memory_limit_bytes = std::uint64_t{4} << 30U;  ///< beyond what the process already has
};

/// Confines this process until it ends. It may read `readable`, but no other file, and write only to its open
/// descriptors. It can open no socket, and start or signal no other process. Memory, processor time and
/// wall-clock time are limited. Standard input becomes empty.
/// @param kept descriptors that stay open in addition to the standard ones
/// @throws std::system_error if a limit that this kernel supports cannot be set
void enter_reader_jail(const ReaderJail& jail, std::span<const int> kept);

/// The parts of the jail that this kernel lacks, as a sentence for the log; empty if it lacks none.
std::string missing_from_reader_jail();

}  // namespace sonard::render
