// The rays of benches/trace.rs in Embree 3: prints build ms, million rays a second of each kind on one core, and counts.
#include <embree3/rtcore.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <limits>
#include <vector>

using Clock = std::chrono::steady_clock;

static std::vector<float> read(const char* name) {
  std::ifstream in(name, std::ios::binary | std::ios::ate);
  std::vector<float> numbers(in.tellg() / sizeof(float));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(numbers.data()), numbers.size() * sizeof(float));
  return numbers;
}

static double seconds(Clock::time_point begun) { return std::chrono::duration<double>(Clock::now() - begun).count(); }

template <class Work> static double median(Work work) {
  std::vector<double> times;
  for (int i = 0; i < 5; i++) {
    auto begun = Clock::now();
    work();
    times.push_back(seconds(begun));
  }
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

static RTCScene build(RTCDevice device, const std::vector<float>& cones) {
  size_t count = cones.size() / 8;
  RTCScene scene = rtcNewScene(device);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, cones.data(), 0, 16, count * 2);
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, sizeof(unsigned), count));
  for (size_t i = 0; i < count; i++) indices[i] = unsigned(2 * i);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

int main() {
  RTCDevice device = rtcNewDevice(nullptr);
  auto cones = read("cones");
  double build_ms = 1e3 * median([&] { rtcReleaseScene(build(device, cones)); });
  RTCScene scene = build(device, cones);
  double rates[3];
  size_t counts[3];
  const char* names[3] = {"primary", "shadow", "ambient"};
  for (int kind = 0; kind < 3; kind++) {
    auto rays = read(names[kind]);
    size_t count = rays.size() / 6;
    auto run = [&] {
      size_t met = 0;
      for (size_t i = 0; i < count; i++) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        const float* r = &rays[i * 6];
        RTCRayHit hit;
        hit.ray = RTCRay{r[0], r[1], r[2], 0, r[3], r[4], r[5], 0, std::numeric_limits<float>::infinity(), ~0u, 0, 0};
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        if (kind == 0) {
          rtcIntersect1(scene, &context, &hit);
          met += hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        } else {
          rtcOccluded1(scene, &context, &hit.ray);
          met += hit.ray.tfar < 0;
        }
      }
      counts[kind] = met;
    };
    rates[kind] = double(count) / median(run) / 1e6;
  }
  std::printf("%f %f %f %f %zu %zu %zu\n", build_ms, rates[0], rates[1], rates[2], counts[0], counts[1], counts[2]);
}
