// camera_bench: measures CPU and wall time from the bytes of an image to the robot's belief. This
// includes decoding, detection of tags, poses, MEASUREMENT_Q1, and the estimator's step with this
// measurement. The images have 640 x 480 pixels and show all five rovers of the scenario.
//
//   camera_bench config/lab-camera.yaml [IMAGES] [NOISE, grey levels]

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "bus/convert/channels.hpp"
#include "core/cpu_time.hpp"
#include "drivers/camera/app/node.hpp"
#include "drivers/camera/image_file.hpp"
#include "estimator/app/node.hpp"
#include "scenario/reader/camera_yaml.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "sim/camera/renderer.hpp"

namespace {

using namespace vantage;  // NOLINT(google-build-using-namespace): a program

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr int kDifferentImages = 24;

using Bytes = std::vector<std::uint8_t>;

/// Source that decodes one image when it is asked for it.
class EncodedImage : public drivers::camera::ImageSource {
 public:
  std::optional<drivers::camera::CapturedImage> next(Time /*now*/) override {
    if (bytes == nullptr) {
      return std::nullopt;
    }
    auto image = drivers::camera::decode_image(*std::exchange(bytes, nullptr));
    return drivers::camera::CapturedImage{time, std::move(image).value()};
  }
  [[nodiscard]] drivers::camera::SourceCounts counts() const override { return {}; }
  [[nodiscard]] std::string status() const override { return ""; }

  const Bytes* bytes = nullptr;
  Time time{};
};

Bytes pgm_of(const models::GrayImage& image) {
  const std::string header =
      "P5 " + std::to_string(image.width) + " " + std::to_string(image.height) + " 255\n";
  Bytes out(header.begin(), header.end());
  out.insert(out.end(), image.pixels.begin(), image.pixels.end());
  return out;
}

std::vector<Bytes> rendered_images(const scenario::CameraSpec& spec,
                                   const models::CameraModel& camera, const Pose3& world_from_body,
                                   double noise) {
  const sim::TagRenderer renderer(camera);
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<Bytes> out;
  for (int i = 0; i < kDifferentImages; ++i) {
    std::vector<sim::PlacedTag> tags;
    for (const scenario::TagSpec& each : spec.tags) {
      const double forward_m = 0.7 + 0.3 * static_cast<double>(tags.size() % 3) + 0.1 * share(rng);
      const double left_m = (tags.size() < 3 ? 0.25 : -0.25) + 0.1 * (share(rng) - 0.5);
      tags.push_back(
          {sim::tag_pattern(spec.family, each.id).value(), each.size_m,
           world_from_body * Pose3{{forward_m, left_m, -1.35},
                                   Quaternion(Eigen::AngleAxisd(2.0 * kPi * share(rng),
                                                                Eigen::Vector3d::UnitZ()))}});
    }
    sim::ImageQuality quality;
    quality.noise_sigma = noise;
    out.push_back(
        pgm_of(renderer.render(world_from_body * spec.body_from_camera, tags, quality, rng)));
  }
  return out;
}

void print(const char* what, std::vector<double> times_ms) {
  std::sort(times_ms.begin(), times_ms.end());
  const std::size_t count = times_ms.size();
  std::printf("%s: median %.2f ms, p99 %.2f ms, worst %.2f ms\n", what, times_ms[count / 2],
              times_ms[count * 99 / 100], times_ms.back());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: camera_bench config/lab-camera.yaml [IMAGES] [NOISE]\n");
    return 2;
  }
  const int images = argc > 2 ? std::atoi(argv[2]) : 1000;
  const double noise = argc > 3 ? std::atof(argv[3]) : 2.0;
  const scenario::Scenario scenario = scenario::load_scenario(argv[1]);
  const scenario::CameraSpec spec = scenario::camera_of(scenario, "Q1").value();
  const models::CameraModel camera = scenario::calibration_of(spec);
  const Pose3 world_from_body = lift({-1.0, 0.0, 0.0}, 1.5);
  const std::vector<Bytes> encoded = rendered_images(spec, camera, world_from_body, noise);

  bus::VirtualClock clock(kStart);
  bus::InProcessHub hub;
  const auto links = {hub.connect(), hub.connect(), hub.connect()};
  bus::Bus camera_bus(**links.begin(), 1);
  bus::Bus estimator_bus(**(links.begin() + 1), 2);
  bus::Bus mocap_bus(**(links.begin() + 2), 3);
  auto source = std::make_unique<EncodedImage>();
  EncodedImage& next_image = *source;
  drivers::CameraNode node(camera_bus, clock, scenario, spec, camera,
                           drivers::camera::make_tag_detector(spec.family).value(),
                           std::move(source));
  estimator::EstimatorNode estimator(estimator_bus, clock, scenario, "Q1");
  std::int64_t detections = 0;
  std::int64_t beliefs = 0;
  mocap_bus.subscribe<models::RobotMeasurement>(
      bus::measurement_channel("Q1"), [&](const models::RobotMeasurement& each) {
        detections += static_cast<std::int64_t>(each.detections.size());
      });
  mocap_bus.subscribe<models::RobotBelief>(bus::belief_channel("Q1"),
                                           [&](const models::RobotBelief&) { ++beliefs; });
  const auto handle = [](bus::Bus& each) { each.handle(std::chrono::microseconds(0)); };
  std::vector<double> cpu_ms;
  std::vector<double> wall_ms;
  const Duration step = from_seconds(scenario.planner.step_s);
  for (int i = 1; i <= images; ++i) {
    const Time t = kStart + i * step;
    clock.set(t + Duration{5'000});
    models::MocapFrame frame;
    frame.stamp.time = t;
    frame.arrival = clock.now();
    frame.frame_number = i;
    frame.bodies = {{"Q1", world_from_body, false}};
    mocap_bus.publish(bus::kVicon, frame);
    handle(camera_bus);
    handle(estimator_bus);

    next_image.bytes = &encoded[static_cast<std::size_t>(i % kDifferentImages)];
    next_image.time = t;
    const double cpu_before_s = thread_cpu_s();
    const auto before = std::chrono::steady_clock::now();
    node.tick(clock.now());
    handle(estimator_bus);
    clock.set(t + step / 6);
    estimator.tick(clock.now());
    cpu_ms.push_back(1e3 * (thread_cpu_s() - cpu_before_s));
    wall_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before)
            .count());
    handle(mocap_bus);
    handle(camera_bus);
  }
  double load = 0.0;
  static_cast<void>(::getloadavg(&load, 1));
  std::printf("%d images, %lld detections, %lld beliefs; load %.1f\n", images,
              static_cast<long long>(detections), static_cast<long long>(beliefs), load);
  print("CPU time, image to belief", cpu_ms);
  print("wall time, image to belief", wall_ms);
  return 0;
}
