// SPDX-License-Identifier: Apache-2.0
// Embree 3 (Debian 12, Ubuntu 22.04) or 4 (Debian 13, Ubuntu 24.04) under one interface.
#pragma once

#if SONARD_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace sonard::render::embree {

#if SONARD_EMBREE >= 4

/// How rays are traced. Make a new one for each call.
struct Query {
  RTCIntersectArguments arguments;

  Query() { rtcInitIntersectArguments(&arguments); }
  /// For rays that lie close together. @param filter drops hits; may be null
  void coherent(RTCFilterFunctionN filter) {
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    if (filter != nullptr) {
      arguments.flags =
          static_cast<RTCRayQueryFlags>(arguments.flags | RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER);
      arguments.filter = filter;
    }
  }
};

/// Flag of a scene whose queries have a filter.
inline constexpr RTCSceneFlags filter_of_query = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;

inline void intersect(const int* valid, RTCScene scene, Query& query, RTCRayHit16& rays) {
  rtcIntersect16(valid, scene, &rays, &query.arguments);
}
inline void intersect(const int* valid, RTCScene scene, Query& query, RTCRayHit8& rays) {
  rtcIntersect8(valid, scene, &rays, &query.arguments);
}
inline void intersect(const int* valid, RTCScene scene, Query& query, RTCRayHit4& rays) {
  rtcIntersect4(valid, scene, &rays, &query.arguments);
}
inline void intersect(RTCScene scene, RTCRayHit& ray) {
  rtcIntersect1(scene, &ray, nullptr);
}
inline void occluded(RTCScene scene, RTCRay& ray) {
  rtcOccluded1(scene, &ray, nullptr);
}

#else

/// How rays are traced. Make a new one for each call.
struct Query {
  RTCIntersectContext context;

  Query() { rtcInitIntersectContext(&context); }
  /// For rays that lie close together. @param filter drops hits; may be null
  void coherent(RTCFilterFunctionN filter) {
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    context.filter = filter;
  }
};

/// Flag of a scene whose queries have a filter.
inline constexpr RTCSceneFlags filter_of_query = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

inline void intersect(const int* valid, RTCScene scene, Query& query, RTCRayHit16& rays) {
  rtcIntersect16(valid, scene, &query.context, &rays);
}
inline void intersect(const int* valid, RTCScene scene, Query& query, RTCRayHit8& rays) {
  rtcIntersect8(valid, scene, &query.context, &rays);
}
inline void intersect(const int* valid, RTCScene scene, Query& query, RTCRayHit4& rays) {
  rtcIntersect4(valid, scene, &query.context, &rays);
}
inline void intersect(RTCScene scene, RTCRayHit& ray) {
  Query query;
  rtcIntersect1(scene, &query.context, &ray);
}
inline void occluded(RTCScene scene, RTCRay& ray) {
  Query query;
  rtcOccluded1(scene, &query.context, &ray);
}

#endif

}  // namespace sonard::render::embree
