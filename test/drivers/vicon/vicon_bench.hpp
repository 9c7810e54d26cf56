#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/natnet/natnet_session.hpp"
#include "drivers/qualisys/qtm_session.hpp"
#include "drivers/vicon/driver.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/mocap_spec.hpp"
#include "sim/vicon/datastream_peer.hpp"
#include "sim/vicon/natnet_peer.hpp"
#include "sim/vicon/object_stream_server.hpp"
#include "sim/vicon/qtm_peer.hpp"
#include "sim/vicon/vrpn_peer.hpp"

namespace vantage::test {

/// Returns the specification of a mocap server at 100 Hz.
inline scenario::MocapSpec spec_of(scenario::MocapProtocol protocol) {
  scenario::MocapSpec spec;
  spec.protocol = protocol;
  spec.rate_hz = 100.0;
  return spec;
}
inline constexpr Duration kPeriod{10'000};

/// Returns the session row of a protocol of any vendor.
inline const drivers::vicon::SessionRow& any_session_row(scenario::MocapProtocol protocol) {
  return protocol == scenario::MocapProtocol::kNatNet ? drivers::natnet::natnet_row()
         : protocol == scenario::MocapProtocol::kQtm  ? drivers::qualisys::qtm_row()
                                                      : drivers::vicon::session_row(protocol);
}

/// Returns the server side of a connection; nullptr if the protocol has no connection.
inline std::unique_ptr<sim::vicon::Peer> make_peer(const sim::vicon::ServerSettings& settings) {
  if (settings.protocol == scenario::MocapProtocol::kDataStream) {
    return std::make_unique<sim::vicon::DataStreamPeer>(settings);
  }
  if (settings.protocol == scenario::MocapProtocol::kVrpn) {
    return std::make_unique<sim::vicon::VrpnPeer>(settings);
  }
  if (settings.protocol == scenario::MocapProtocol::kNatNet) {
    return std::make_unique<sim::vicon::NatNetPeer>(settings);
  }
  if (settings.protocol == scenario::MocapProtocol::kQtm) {
    return std::make_unique<sim::vicon::QtmPeer>(settings);
  }
  return nullptr;
}

/// A driver and the emulated server that exchange bytes in virtual time, without sockets or clocks.
class ViconBench {
 public:
  using Bytes = wire::vicon::Bytes;

  /// @param chunk_bytes  number of bytes of a TCP stream that arrive together; 0: all
  ViconBench(const scenario::MocapSpec& spec, const sim::vicon::ServerSettings& settings,
             std::size_t chunk_bytes = 0)
      : settings_(settings),
        chunk_bytes_(chunk_bytes),
        object_stream(settings),
        driver(spec, any_session_row(spec.protocol),
               [this](const models::MocapFrame& frame) { frames.push_back(frame); }) {}

  static sim::vicon::ServerSettings settings_for(const scenario::MocapSpec& spec) {
    sim::vicon::ServerSettings settings;
    settings.protocol = spec.protocol;
    settings.rate_hz = spec.rate_hz;
    settings.is_y_up = spec.is_y_up();
    return settings;
  }

  drivers::vicon::Moment now() const { return {epoch + elapsed, elapsed}; }

  /// Advances the time by `time`. Opens links with a new server peer when the driver requests it,
  /// and exchanges bytes.
  void pass(Duration time) {
    const Duration end = elapsed + time;
    do {
      elapsed = std::min(end, elapsed + Duration{1'000});
      driver.on_time(now());
      if (driver.wants_close()) {
        peer.reset();
        driver.on_closed(now(), "closed");
      }
      if (driver.wants_open(now())) {
        driver.on_opening(now());
        if (is_server_up) {
          connect();
        } else {
          driver.on_closed(now(), "connection refused");
        }
      }
      exchange();
    } while (elapsed < end);
  }

  /// Cuts the connection and discards the server's side of it.
  void cut() {
    peer.reset();
    driver.on_closed(now(), "cut");
  }

  /// Publishes a frame; its bytes arrive immediately.
  void publish(const sim::vicon::EmulatedFrame& frame) {
    if (driver.is_datagram()) {
      for (const auto& datagram : object_stream.encode(frame)) {
        driver.receive(now(), datagram);
      }
      return;
    }
    if (peer) {
      peer->now = elapsed + server_clock_offset;
      peer->on_frame(frame);
      exchange();
    }
  }

  /// Exchanges bytes until neither side has bytes to send.
  void exchange() {
    if (peer) {
      peer->now = elapsed + server_clock_offset;
    }
    while (peer && !(peer->outgoing.empty() && driver.outgoing().empty())) {
      const std::vector<std::uint8_t> down = std::exchange(peer->outgoing, {});
      const std::vector<std::uint8_t> up = std::exchange(driver.outgoing(), {});
      in_chunks(down, [this](Bytes bytes) { driver.receive(now(), bytes); });
      in_chunks(up, [this](Bytes bytes) {
        if (peer && !peer->receive(bytes)) {
          peer.reset();
        }
      });
      if (driver.wants_close()) {
        return;
      }
    }
  }

  static constexpr Time kEpoch = from_utime(1'700'000'000'000'000);

 private:
  sim::vicon::ServerSettings settings_;
  std::size_t chunk_bytes_;

 public:
  bool is_server_up = true;
  Time epoch = kEpoch;  ///< time at which `elapsed` is 0
  Duration elapsed{};
  Duration server_clock_offset = std::chrono::hours(7);  ///< server's steady clock minus `elapsed`
  std::vector<models::MocapFrame> frames;
  sim::vicon::ObjectStreamServer object_stream;
  std::unique_ptr<sim::vicon::Peer> peer;
  drivers::vicon::ViconDriver driver;

 private:
  void connect() {
    peer = make_peer(settings_);
    driver.on_opened(now());
  }

  template <class Take>
  void in_chunks(const std::vector<std::uint8_t>& bytes, const Take& take) const {
    const std::size_t chunk = chunk_bytes_ == 0 ? bytes.size() : chunk_bytes_;
    for (std::size_t at = 0; at < bytes.size(); at += chunk) {
      take(Bytes(bytes).subspan(at, std::min(chunk, bytes.size() - at)));
    }
  }
};

/// Returns a frame of `count` bodies on separate circles at `time_s`.
inline sim::vicon::EmulatedFrame circling(int count, double time_s) {
  sim::vicon::EmulatedFrame frame;
  frame.captured = ViconBench::kEpoch + from_seconds(time_s);
  for (int i = 0; i < count; ++i) {
    const double angle = time_s + i;
    const Eigen::Vector3d position(2.0 * i + std::cos(angle), std::sin(angle),
                                   1.0 + 0.2 * std::sin(0.7 * angle));
    const Eigen::Quaterniond rotation(
        Eigen::AngleAxisd(angle, Eigen::Vector3d(0.1, 0.2 * std::sin(angle), 1.0).normalized()));
    frame.bodies.push_back({"BODY" + std::to_string(i), {position, rotation}, false});
  }
  return frame;
}

/// A bench that publishes numbered frames of circling bodies.
struct CirclingBench : ViconBench {
  using ViconBench::ViconBench;

  /// Returns the next frame without publishing it.
  sim::vicon::EmulatedFrame next(int bodies) {
    sim::vicon::EmulatedFrame frame = circling(bodies, to_seconds(elapsed));
    frame.number = ++number;
    frame.latency_s = latency_s;
    return frame;
  }
  void run(int frames_count, int bodies) {
    for (int k = 0; k < frames_count; ++k) {
      publish(next(bodies));
      pass(kPeriod);
    }
  }

  std::uint32_t number = 0;
  double latency_s = sim::vicon::EmulatedFrame{}.latency_s;
};

/// Expects the pose of each body of `frame` within the resolution of single-precision numbers.
inline void expect_poses(const models::MocapFrame& seen, const sim::vicon::EmulatedFrame& frame) {
  for (const auto& body : frame.bodies) {
    const models::MocapBody* found = seen.find(body.name);
    ASSERT_NE(found, nullptr) << body.name;
    EXPECT_FALSE(found->occluded);
    EXPECT_LT((found->world_from_body.translation_m - body.world_from_body.translation_m).norm(),
              1e-6);
    EXPECT_LT(found->world_from_body.rotation.angularDistance(body.world_from_body.rotation), 2e-6);
  }
}

/// Removes the first of `bodies` bodies. Expects that each frame arrives and that no pose appears
/// under another body's name. A body may be occluded if `may_be_occluded`.
inline void expect_own_names_after_removal(CirclingBench& bench, int bodies, bool may_be_occluded) {
  bench.frames.clear();
  for (int k = 0; k < 20; ++k) {
    sim::vicon::EmulatedFrame frame = bench.next(bodies);
    frame.bodies.erase(frame.bodies.begin());
    bench.publish(frame);
    bench.pass(kPeriod);
    ASSERT_FALSE(bench.frames.empty());
    for (const auto& body : frame.bodies) {
      const models::MocapBody* seen = bench.frames.back().find(body.name);
      ASSERT_NE(seen, nullptr) << body.name << " at " << k;
      if (seen->occluded) {
        EXPECT_TRUE(may_be_occluded);
        continue;
      }
      EXPECT_LT((seen->world_from_body.translation_m - body.world_from_body.translation_m).norm(),
                1e-6);
    }
  }
  EXPECT_EQ(bench.frames.size(), 20u) << "the first frame waits for the names and is not lost";
  EXPECT_EQ(bench.driver.frame_counts().poses_swapped, 0);
}

}  // namespace vantage::test
