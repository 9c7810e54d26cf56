// Measures how many frames a driver loses, and their latency, with real sockets of this host:
//   vicon_bench PROTOCOL RATE_HZ BODIES SECONDS
// The emulated server runs in a separate thread. Not part of ctest: it measures and does not test.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <poll.h>

#include "bus/node/clock.hpp"
#include "core/deadline.hpp"
#include "drivers/vicon/driver.hpp"
#include "drivers/vicon/socket_link.hpp"
#include "sim/vicon/app/source.hpp"
#include "sim/vicon/socket_server.hpp"

namespace {

using namespace vantage;  // NOLINT(google-build-using-namespace): a program

constexpr int kPort = 51917;
constexpr double kWarmUp_s = 0.5;

struct Load {
  sim::vicon::ServerSettings settings;
  int bodies = 20;
  std::size_t frames = 0;
};

/// Sends `load.frames` frames on time and stores their send times in `sent_ns`.
void serve(const Load& load, sim::vicon::SocketServer& server, std::vector<std::int64_t>& sent_ns) {
  sim::vicon::CirclingBodies source(load.bodies);
  sim::vicon::EmulatedFrame frame;
  frame.latency_s = 0.0;
  const bus::SystemClock clock;
  const std::int64_t start_ns = monotonic_ns();
  for (std::size_t k = 0; k < load.frames; ++k) {
    const double time_s = static_cast<double>(k) / load.settings.rate_hz;
    const std::int64_t due_ns = start_ns + std::llround(time_s * 1e9);
    for (std::int64_t left_ns = due_ns - monotonic_ns(); left_ns > 0;
         left_ns = due_ns - monotonic_ns()) {
      server.wait(std::chrono::nanoseconds(left_ns));
    }
    source.fill(time_s, frame);
    frame.number = static_cast<std::uint32_t>(k);
    frame.captured = clock.now();
    sent_ns[k] = monotonic_ns();
    server.publish(frame);
  }
  const std::int64_t end_ns = monotonic_ns() + 1'000'000'000;
  while (monotonic_ns() < end_ns) {
    server.wait(std::chrono::milliseconds(10));
  }
}

double at_share(const std::vector<double>& sorted, double share) {
  return sorted.empty()
             ? 0.0
             : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    fmt::print(stderr, "usage: vicon_bench datastream|object_stream|vrpn RATE_HZ BODIES SECONDS\n");
    return 2;
  }
  const std::string name = argv[1];
  scenario::MocapSpec spec;
  spec.port = kPort;
  spec.protocol = name == "vrpn"            ? scenario::MocapProtocol::kVrpn
                  : name == "object_stream" ? scenario::MocapProtocol::kObjectStream
                                            : scenario::MocapProtocol::kDataStream;
  Load load;
  load.settings.protocol = spec.protocol;
  load.settings.rate_hz = std::atof(argv[2]);
  load.settings.block_bytes = 1024;
  load.bodies = std::atoi(argv[3]);
  load.frames = static_cast<std::size_t>(load.settings.rate_hz * std::atof(argv[4]));
  sim::vicon::SocketServer server(load.settings, "127.0.0.1", kPort);

  std::vector<std::int64_t> sent_ns(load.frames, 0);
  std::vector<double> delays_us;
  delays_us.reserve(load.frames);
  std::size_t incomplete = 0;
  std::size_t received = 0;
  const auto warm = static_cast<std::size_t>(kWarmUp_s * load.settings.rate_hz);
  std::size_t next = 0;  // number of the next frame; VRPN frames have no number
  drivers::vicon::ViconDriver driver(spec, [&](const models::MocapFrame& frame) {
    const std::size_t k = spec.protocol == scenario::MocapProtocol::kVrpn
                              ? next++
                              : static_cast<std::size_t>(frame.frame_number);
    if (k < warm || k >= load.frames) {
      return;
    }
    ++received;
    delays_us.push_back(1e-3 * static_cast<double>(monotonic_ns() - sent_ns[k]));
    incomplete += frame.bodies.size() != static_cast<std::size_t>(load.bodies) ||
                          std::any_of(frame.bodies.begin(), frame.bodies.end(),
                                      [](const auto& body) { return body.occluded; })
                      ? 1U
                      : 0U;
  });
  const bus::SystemClock clock;
  drivers::vicon::SocketLink link(driver, [&clock] {
    return drivers::vicon::Moment{clock.now(), Duration{monotonic_ns() / 1'000}};
  });
  // Waits until the connection is open before the first frame is sent.
  while (!driver.is_open() ||
         (server.clients() == 0 && spec.protocol != scenario::MocapProtocol::kObjectStream)) {
    link.step();
    server.wait(std::chrono::milliseconds(1));
  }
  for (int k = 0; k < 20; ++k) {
    link.step();
    server.wait(std::chrono::milliseconds(1));
  }
  std::atomic<bool> is_done = false;
  std::thread thread([&] {
    serve(load, server, sent_ns);
    is_done = true;
  });
  while (!is_done) {
    pollfd polled{link.wake_fd(), POLLIN, 0};
    poll(&polled, 1, 1);
    link.step();
  }
  thread.join();
  std::sort(delays_us.begin(), delays_us.end());
  fmt::print(
      "{} {} Hz {} bodies: sent {} received {} (after a warm-up of {}), lost {}, not whole {}, "
      "server "
      "skipped {}; delay us p50 {:.0f} p99 {:.0f} p99.9 {:.0f} max {:.0f}\n",
      name, load.settings.rate_hz, load.bodies, load.frames - warm, received, warm,
      driver.frame_counts().frames_lost, incomplete, server.frames_skipped(),
      at_share(delays_us, 0.5), at_share(delays_us, 0.99), at_share(delays_us, 0.999),
      delays_us.empty() ? 0.0 : delays_us.back());
  return received == load.frames - warm && incomplete == 0 ? 0 : 1;
}
