// SPDX-License-Identifier: Apache-2.0
// What the stages from visible segments to the image have in common.
#include "gpu/ping.glsl"

layout(std140, binding = 1) uniform EchoBlock {
  Echo echo;
};
