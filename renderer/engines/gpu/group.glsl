// SPDX-License-Identifier: Apache-2.0
// The invocations of a group: their shares of its work, and sums over them.
layout(local_size_x = GROUP) in;

uint lane = gl_LocalInvocationID.x;

uint group_number() {
  return gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
}

// An invocation works on those of n things that lie from its begin to the begin of the next invocation.
uint begin_of_share(uint n, uint of_lane) {
  return min(of_lane * ((n + GROUP - 1U) / GROUP), n);
}

shared uint s_of_lane[GROUP];

// The sum over the invocations before this one, and over all. All invocations must call it.
uint sum_before(uint of_this, out uint of_all) {
  s_of_lane[lane] = of_this;
  barrier();
  uint before = 0U;
  of_all = 0U;
  for (uint k = 0U; k < GROUP; ++k) {
    before += k < lane ? s_of_lane[k] : 0U;
    of_all += s_of_lane[k];
  }
  barrier();
  return before;
}
