// SPDX-License-Identifier: Apache-2.0
// The model of the echoes.
#pragma once

namespace sonard::render {

enum class Model {
  paper,     ///< Cerqueira et al. 2017: mean of sigmoid(rho cos phi), multiplicative speckle
  physical,  ///< sonar equation per solid angle, Rayleigh speckle, additive noise, TVG
};

}  // namespace sonard::render
