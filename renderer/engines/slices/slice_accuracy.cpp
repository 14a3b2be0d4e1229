// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/slices/slice_accuracy.hpp"

namespace sonard::render {

SliceAccuracy slice_accuracy(const Sampling& sampling, Model model) {
  SliceAccuracy accuracy;
  accuracy.within_facets = sampling.within_facets;
  // The paper's sigmoid amplifies small changes of incidence.
  accuracy.slices_per_beam = model == Model::paper ? 2 : 1;
  if (sampling.preset == Sampling::Preset::fast) {
    accuracy.most_divisions = 5;
    accuracy.most_divisions_of_lone_echoes = 25;
    accuracy.disagreement = 2.5e-2F;
    accuracy.shift_lines = 0.9F;
    accuracy.sagitta_lines = 3e-3F;
    accuracy.linearity = 0.15F;
    accuracy.change = 0.05F;
    accuracy.mapped_lines = 4.0F;
    accuracy.facet_slopes = 0.5F;
    accuracy.facet_lines = 0.012F;
  } else if (sampling.preset == Sampling::Preset::reference) {
    accuracy.slices_per_beam = 9;
    accuracy.disagreement = 1e-4F;
    accuracy.shift_lines = 0.02F;
    accuracy.sagitta_lines = 5e-5F;
    accuracy.linearity = 0.005F;
    accuracy.change = 0.001F;
    accuracy.facet_slopes = 0.03F;
    accuracy.facet_lines = 0.001F;
  }
  return accuracy;
}

}  // namespace sonard::render
