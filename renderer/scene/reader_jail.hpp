// SPDX-License-Identifier: Apache-2.0
// Takes from a process all rights that reading a foreign file does not need.
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

/// Not in a program with a sanitizer, whose own tables take all of the address space.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || \
    SONARD_HAS_FEATURE(address_sanitizer) || SONARD_HAS_FEATURE(thread_sanitizer)
constexpr bool reader_memory_is_limited = false;
#else
constexpr bool reader_memory_is_limited = true;
#endif

/// What a reading process may still do. A defect of a reader's library can then spend this, and no more.
struct ReaderJail {
  std::vector<std::filesystem::path> readable{};  ///< files, and folders with all that is below them
  unsigned int processor_limit_s = 10;
  std::uint64_t memory_limit_bytes = std::uint64_t{4} << 30U;  ///< beyond what the process already has
};

/// Confines this process until it ends: it may read `readable` and open no other file, write to no file but
/// the descriptors it has, open no socket, and start or signal no other process. Memory, processor time and
/// the time by the clock are limited. Standard input becomes empty.
/// @param kept the descriptors that stay open beside the standard ones
/// @throws std::system_error if a limit that this kernel has cannot be set
void enter_reader_jail(const ReaderJail& jail, std::span<const int> kept);

/// The parts of the jail that this kernel lacks, as a sentence for the log; empty if it lacks none.
std::string missing_from_reader_jail();

}  // namespace sonard::render
