#include "bench/embree_rays.hpp"

#include "base/error.hpp"

#ifdef LUCERNA_EMBREE
#if LUCERNA_EMBREE == 3
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>
#endif

namespace lucerna {

#ifdef LUCERNA_EMBREE

bool EmbreeRays::isBuilt() { return true; }

struct EmbreeRays::Handles {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~Handles() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

namespace {

// Embree 3 wants a context with each ray, Embree 4 takes arguments only where they are not the default.
#if LUCERNA_EMBREE == 3
void intersect(RTCScene scene, RTCRayHit& query) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &query);
}
void occluded(RTCScene scene, RTCRay& ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
}
#else
void intersect(RTCScene scene, RTCRayHit& query) { rtcIntersect1(scene, &query, nullptr); }
void occluded(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray, nullptr); }
#endif

}  // namespace

EmbreeRays::EmbreeRays(const Scene& scene, const glm::dvec3& origin) : handles_(std::make_unique<Handles>()) {
  handles_->device = rtcNewDevice(nullptr);
  if (!handles_->device) throw Error(ErrorKind::fault, "Embree cannot create a device");
  handles_->scene = rtcNewScene(handles_->device);
  rtcSetSceneFlags(handles_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(handles_->scene, RTC_BUILD_QUALITY_HIGH);
  RTCGeometry geometry = rtcNewGeometry(handles_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, scene.vertices.size()));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, scene.triangleCount()));
  CHECK(vertices && indices, "Embree cannot create buffers for {} triangles", scene.triangleCount());
  for (const Vertex& vertex : scene.vertices)
    for (int k = 0; k < 3; ++k) *vertices++ = static_cast<float>(static_cast<double>(vertex.position[k]) - origin[k]);
  std::copy(scene.indices.begin(), scene.indices.end(), indices);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(handles_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(handles_->scene);
}

EmbreeRays::~EmbreeRays() = default;

void EmbreeRays::trace(std::span<const PlainRay> rays, std::span<PlainHit> hits, bool anyHit) const {
  CHECK(rays.size() == hits.size(), "{} rays, {} hits", rays.size(), hits.size());
  const auto work = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const PlainRay& r = rays[i];
      RTCRayHit query{};
      query.ray = {r.origin.x, r.origin.y, r.origin.z, r.tMin, r.direction.x, r.direction.y, r.direction.z, 0.0f,
                   r.tMax,     ~0u,        0,          0};
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      if (anyHit) {
        occluded(handles_->scene, query.ray);
        hits[i].triangle = query.ray.tfar < 0.0f ? 0u : PlainHit::kNone;
      } else {
        intersect(handles_->scene, query);
        hits[i] = {query.ray.tfar,
                   query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? PlainHit::kNone : query.hit.primID,
                   {query.hit.u, query.hit.v}};
      }
    }
  };
  std::atomic<std::size_t> next{0};
  const auto share = [&] {
    constexpr std::size_t kChunk = 4096;
    for (std::size_t begin = next.fetch_add(kChunk); begin < rays.size(); begin = next.fetch_add(kChunk))
      work(begin, std::min(begin + kChunk, rays.size()));
  };
  const std::size_t threads = std::max(1u, std::thread::hardware_concurrency());
  std::vector<std::thread> others;
  for (std::size_t t = 1; t < threads; ++t) others.emplace_back(share);
  share();
  for (std::thread& thread : others) thread.join();
}

#else

struct EmbreeRays::Handles {};

bool EmbreeRays::isBuilt() { return false; }
EmbreeRays::EmbreeRays(const Scene&, const glm::dvec3&) {
  throwMissingCapability("built without Embree (Debian: libembree-dev)");
}
EmbreeRays::~EmbreeRays() = default;
void EmbreeRays::trace(std::span<const PlainRay>, std::span<PlainHit>, bool) const {}

#endif

}  // namespace lucerna
