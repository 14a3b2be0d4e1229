// SPDX-License-Identifier: Apache-2.0
// Range bins of a ping, shared among the threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <mutex>

#include "renderer/acoustics/echo_block.hpp"
#include "renderer/acoustics/quantizer.hpp"
#include "renderer/ping.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Distributes blocks of lines over the threads. One `Lines` per thread owns buffers and makes range bins one
/// by one.
/// @param done called with the `Lines` of each thread at the end, by one thread at a time
template <class Lines, class Ping, class Done>
PingSamples receive_bins(const EchoImage& echo, const Ping& ping, const SonarSettings& settings,
                         WorkerPool& workers, const Done& done) {
  PingSamples samples = make_samples(settings);
  const int looks_log2 = settings.range.compression_log2;
  const int lines_per_block = EchoBlock::most_lines >> looks_log2;
  const int blocks = (samples.bins + lines_per_block - 1) / lines_per_block;
  std::atomic<int> next{0};
  std::mutex ending;
  workers.run(std::min(blocks, static_cast<int>(workers.size())), [&](int) {
    EchoBlock block(echo);
    Lines lines(ping, block);
    Quantizer output(settings, samples);
    for (int i = next++; i < blocks; i = next++) {
      const int begin = i * lines_per_block;
      const int end = std::min(begin + lines_per_block, samples.bins);
      block.load(begin << looks_log2, (end - begin) << looks_log2);
      for (int line = begin; line < end; ++line) {
        output.begin();
        for (int bin = line << looks_log2; bin < (line + 1) << looks_log2; ++bin) {
          lines.add_range_bin(bin, output);
        }
        output.end(line);
      }
    }
    const std::lock_guard lock(ending);
    done(lines);
  });
  return samples;
}

}  // namespace sonard::render
