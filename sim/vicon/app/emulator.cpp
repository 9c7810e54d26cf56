#include "sim/vicon/app/emulator.hpp"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "bus/node/clock.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"
#include "core/process.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "sim/vicon/app/source.hpp"
#include "sim/vicon/socket_server.hpp"

namespace vantage::sim::vicon {
namespace {

struct Arguments {
  ServerSettings settings;
  std::string host = "0.0.0.0";
  int port = 0;
  std::string to = "127.0.0.1";
  int bodies = 3;
  std::vector<std::string> flights;
  bool is_endless = false;
  std::string scenario;
  double latency_s = 0.004;
  double occluded_s = 0.0;
  std::string up;
  std::string natnet_version = "4.1";
  double duration_s = 0.0;
};

constexpr double kOcclusionPeriod_s = 10.0;

void add_options(CLI::App& app, Arguments& arguments) {
  std::map<std::string, scenario::MocapProtocol> protocols;
  for (const scenario::MocapProtocol protocol : scenario::all_mocap_protocols()) {
    protocols.emplace(protocol.name(), protocol);
  }
  const std::map<std::string, OcclusionStyle> styles{{"absent", OcclusionStyle::kAbsent},
                                                     {"zero", OcclusionStyle::kZero},
                                                     {"repeated", OcclusionStyle::kRepeated}};
  app.add_option_function<std::string>(
         "--protocol",
         [&arguments, protocols](const std::string& name) {
           arguments.settings.protocol = protocols.at(name);
         },
         "datastream, object_stream, vrpn, natnet or qtm")
      ->check(CLI::IsMember(protocols));
  app.add_option("--host", arguments.host, "address to listen on");
  app.add_option("--port", arguments.port, "port instead of the protocol's default")
      ->check(CLI::Range(1, 65535));
  app.add_option("--to", arguments.to,
                 "destination of an object stream; may be a broadcast address");
  app.add_option("--rate", arguments.settings.rate_hz, "frame rate, Hz")
      ->check(CLI::Range(1.0, 1000.0));
  app.add_option("--block-bytes", arguments.settings.block_bytes,
                 "datagram size of an object stream, bytes")
      ->check(CLI::IsMember({256, 512, 1024}));
  app.add_option("--up", arguments.up,
                 "upward axis of the published coordinates: z or y (default: y for natnet, else z)")
      ->check(CLI::IsMember({"z", "y"}));
  app.add_option("--natnet-version", arguments.natnet_version,
                 "NatNet version of the emulated server")
      ->check(CLI::IsMember({"3.0", "3.1", "4.0", "4.1", "4.2"}));
  app.add_flag("--multicast", arguments.settings.is_multicast,
               "send the frames of a natnet server to the group 239.255.42.99");
  app.add_option("--latency-s", arguments.latency_s, "latency that the server reports, s")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--occlusion", arguments.settings.occlusion,
                 "how a hidden body is sent: absent, zero or repeated")
      ->transform(CLI::CheckedTransformer(styles));
  app.add_option("--occluded-s", arguments.occluded_s,
                 "s; time for which each body in turn is hidden, in every 10 s")
      ->check(CLI::Range(0.0, kOcclusionPeriod_s));
  auto* bodies =
      app.add_option("--bodies", arguments.bodies, "number of bodies that move on circles")
          ->check(CLI::Range(0, 512));
  auto* flights = app.add_option("--flight", arguments.flights,
                                 "recorded flight (CSV: time_s,x_m,y_m,z_m,qw,qx,qy,qz); may be "
                                 "given several times")
                      ->excludes(bodies);
  app.add_flag("--endless", arguments.is_endless, "restart the flights when they end");
  app.add_option("--scenario", arguments.scenario,
                 "simulate the world of this scenario file, without planners")
      ->excludes(bodies)
      ->excludes(flights);
  app.add_option("--duration-s", arguments.duration_s, "stop after this time, s; 0: never");
  app.footer(
      "Examples:\n"
      "  vantage-vicon-emulator --protocol datastream --bodies 20 --rate 1000\n"
      "  vantage-vicon-emulator --protocol object_stream --to 192.168.1.255 --flight v1_01.csv");
}

std::unique_ptr<Source> make_source(const Arguments& arguments, Time start) {
  if (!arguments.scenario.empty()) {
    return std::make_unique<ScenarioWorld>(scenario::load_scenario(arguments.scenario), start);
  }
  if (!arguments.flights.empty()) {
    return std::make_unique<Flights>(arguments.flights, arguments.is_endless);
  }
  return std::make_unique<CirclingBodies>(arguments.bodies);
}

/// Occludes the bodies in turn, each for `occluded_s` per period.
void occlude(double time_s, double occluded_s, EmulatedFrame& frame) {
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const double shift_s =
        kOcclusionPeriod_s * static_cast<double>(i + 1) / static_cast<double>(frame.bodies.size());
    frame.bodies[i].is_occluded =
        frame.bodies[i].is_occluded || std::fmod(time_s + shift_s, kOcclusionPeriod_s) < occluded_s;
  }
}

int serve(const Arguments& arguments) {
  const bus::SystemClock clock;
  const Time start = clock.now();
  const std::unique_ptr<Source> source = make_source(arguments, start);
  const bool is_sender = arguments.settings.protocol.is_datagram();
  const int port = arguments.port > 0 ? arguments.port : arguments.settings.protocol.default_port();
  SocketServer server(arguments.settings, is_sender ? arguments.to : arguments.host, port);
  std::fprintf(stderr, "vantage-vicon-emulator: %s %s port %d, %g Hz\n",
               arguments.settings.protocol.name(), is_sender ? "to" : "at", server.port(),
               arguments.settings.rate_hz);
  const std::int64_t start_ns = monotonic_ns();
  EmulatedFrame frame;
  frame.latency_s = arguments.latency_s;
  std::int64_t sent = 0;
  for (std::int64_t k = 0; !stop_requested(); ++k) {
    const double time_s = static_cast<double>(k) / arguments.settings.rate_hz;
    // A real server delivers a frame after its latency. Here due_ns is the time of delivery, and
    // the capture time is earlier by the latency.
    const std::int64_t due_ns = start_ns + std::llround(time_s * 1e9);
    for (std::int64_t left_ns = due_ns - monotonic_ns(); left_ns > 0 && !stop_requested();
         left_ns = due_ns - monotonic_ns()) {
      server.wait(std::chrono::nanoseconds(std::min<std::int64_t>(left_ns, 50'000'000)));
    }
    server.wait(std::chrono::nanoseconds(0));
    frame.number = static_cast<std::uint32_t>(k);
    frame.captured = clock.now() - from_seconds(arguments.latency_s);
    if ((arguments.duration_s > 0.0 && time_s >= arguments.duration_s) ||
        !source->fill(time_s, frame)) {
      break;
    }
    occlude(time_s, arguments.occluded_s, frame);
    server.publish(frame);
    ++sent;
  }
  std::fprintf(stderr,
               "vantage-vicon-emulator: %lld frames, %lld skipped for clients that did not read\n",
               static_cast<long long>(sent), static_cast<long long>(server.frames_skipped()));
  return 0;
}

}  // namespace

int run_emulator(int argc, char** argv) {
  CLI::App app{"Emulates a motion-capture server, to test drivers.", "vantage-vicon-emulator"};
  Arguments arguments;
  add_options(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  arguments.settings.is_y_up =
      arguments.up.empty() ? arguments.settings.protocol.is_y_up() : arguments.up == "y";
  arguments.settings.natnet_version = {
      static_cast<std::uint8_t>(arguments.natnet_version[0] - '0'),
      static_cast<std::uint8_t>(arguments.natnet_version[2] - '0')};
  return serve(arguments);
}

}  // namespace vantage::sim::vicon
