// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/paper_receiver.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/acoustics/complex_row.hpp"
#include "renderer/acoustics/receive_bins.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

SONARD_SIMD_CLONES
void speckle_row(const float* __restrict gaussian, float mean, float scale, bool folded, float floor,
                 int beams, float* __restrict value) {
  for (int b = 0; b < beams; ++b) {
    const float n = mean + scale * gaussian[b];
    value[b] = std::max(value[b] * (folded ? std::abs(n) : std::max(0.0F, n)), floor);
  }
}

SONARD_SIMD_CLONES
void clamp_row(float gain, float codes, int beams, float* __restrict value) {
  for (int b = 0; b < beams; ++b) {
    value[b] = std::min(1.0F, value[b] * gain) * codes;
  }
}

/// Makes range bins one by one; one object per thread.
class PaperBins {
 public:
  PaperBins(const PaperReceiverInput& ping, const EchoBlock& block)
      : ping_(ping),
        block_(block),
        beams_(block.beams()),
        random_((beams_ + 1) / 2),
        value_(static_cast<std::size_t>(beams_)) {}

  void add_range_bin(int bin, Quantizer& output) {
    const PaperModel& model = ping_.model;
    if (!(model.speckle_floor > 0) && !(block_.strongest(bin) > 0) &&
        ping_.skip.on(SkipRule::bins_without_echo)) {
      skipped_.add(SkipRule::bins_without_echo);
      return;
    }
    std::copy_n(block_.line(bin), beams_, value_.data());
    if (model.speckle != PaperModel::Speckle::off) {
      random_.draw(ping_.key, bin);
      // Both parts of a complex number are used, each of variance 1/2: the first half of the beams gets the
      // real parts, the second half the imaginary parts.
      speckle_row(random_.real(), static_cast<float>(model.speckle_mean),
                  static_cast<float>(std::sqrt(2.0) * model.speckle_sd),
                  model.speckle == PaperModel::Speckle::folded_gaussian,
                  static_cast<float>(model.speckle_floor), beams_, value_.data());
    }
    clamp_row(static_cast<float>(2 * model.gain), ping_.codes, beams_, value_.data());
    output.add(value_.data());
  }

  const SkipCounts& skipped() const { return skipped_; }

 private:
  const PaperReceiverInput& ping_;
  const EchoBlock& block_;
  int beams_;
  ComplexRow random_;
  AlignedVector<float> value_;
  SkipCounts skipped_;
};

}  // namespace

PingSamples receive_paper(const EchoImage& echo, const PaperReceiverInput& ping,
                          const SonarSettings& settings, WorkerPool& workers, SkipCounts& skipped) {
  return receive_bins<PaperBins>(echo, ping, settings, workers,
                                 [&](const PaperBins& bins) { skipped += bins.skipped(); });
}

}  // namespace sonard::render
