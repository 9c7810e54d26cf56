// Tests slow and queueing connections from mocap server to driver, from the bytes of the server to
// the reasons in the vehicle's status.

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/vicon/driver.hpp"
#include "sim/vicon/datastream_peer.hpp"
#include "sim/vicon/object_stream_server.hpp"
#include "sim/vicon/vrpn_peer.hpp"
#include "test/drivers/quadrotor/flight_bench.hpp"

namespace vantage::drivers {
namespace {

using models::FlightState;
using scenario::MocapProtocol;
using test::FlightBench;

constexpr Duration kFrame{10'000};
constexpr double kFrameS = 0.01;
constexpr double kServerS = 0.004;  // s; time from capture until the server sends the frame

/// Transmits the frames of a bench through an emulated server, a connection and the mocap driver.
/// The connection preserves the order, so ping replies arrive after earlier frames.
class Line {
 public:
  Line(FlightBench& bench, MocapProtocol protocol)
      : bench_(bench),
        settings_{protocol, 100.0},
        object_stream_(settings_),
        driver_(spec_of(protocol), [this](const models::MocapFrame& frame) { publish(frame); }) {
    bench_.on_capture = [this](const models::MocapFrame& frame) { capture(frame); };
    bench_.on_step = [this](Time) { step(); };
  }

  /// s; greatest difference between the reported and the true latency of a published frame.
  double worst_error_s = 0.0;
  double slow_share = 0.0;  ///< relative excess of the transmission time over the frame period
  Duration queue{};         ///< delay of each frame on this connection
  [[nodiscard]] const vicon::ViconDriver& driver() const { return driver_; }

 private:
  struct Chunk {
    std::vector<std::uint8_t> bytes;
    Time captured{};
    Time due{};
  };
  static scenario::MocapSpec spec_of(MocapProtocol protocol) {
    scenario::MocapSpec spec;
    spec.protocol = protocol;
    return spec;
  }
  [[nodiscard]] vicon::Moment moment() const {
    return {bench_.now, bench_.now - FlightBench::kStart + std::chrono::hours(1)};
  }

  void capture(const models::MocapFrame& frame) {
    sim::vicon::EmulatedFrame sent;
    sent.number = ++number_;
    sent.captured = bench_.now;
    sent.latency_s = kServerS;
    for (const models::MocapBody& body : frame.bodies) {
      sent.bodies.push_back({body.name, body.world_from_body, body.occluded});
    }
    if (driver_.is_datagram()) {
      for (const auto& datagram : object_stream_.encode(sent)) {
        enqueue(datagram, true);
      }
    } else if (peer_) {
      peer_->on_frame(sent);
      enqueue(std::exchange(peer_->outgoing, {}), true);
    }
  }

  void enqueue(std::vector<std::uint8_t> bytes, bool is_frame) {
    const Duration service =
        is_frame && slow_share > 0.0 ? from_seconds(kFrameS * (1.0 + slow_share)) : Duration{};
    last_due_ = std::max(bench_.now + from_seconds(kServerS) + queue, last_due_ + service);
    chunks_.push_back({std::move(bytes), bench_.now, last_due_});
  }

  void step() {
    if (driver_.wants_close()) {
      peer_.reset();
      chunks_.clear();
      queue = {};
      last_due_ = bench_.now;
      driver_.on_closed(moment(), "closed");
    }
    if (driver_.wants_open(moment())) {
      connect();
    }
    while (!chunks_.empty() && chunks_.front().due <= bench_.now) {
      const Chunk chunk = std::move(chunks_.front());
      chunks_.pop_front();
      captured_ = chunk.captured;
      driver_.receive(moment(), chunk.bytes);
    }
    driver_.on_time(moment());
    if (peer_ && !driver_.outgoing().empty()) {
      ASSERT_TRUE(peer_->receive(std::exchange(driver_.outgoing(), {})));
      if (!peer_->outgoing.empty()) {
        enqueue(std::exchange(peer_->outgoing, {}), false);
      }
    }
  }

  void connect() {
    driver_.on_opening(moment());
    if (settings_.protocol == MocapProtocol::kDataStream) {
      peer_ = std::make_unique<sim::vicon::DataStreamPeer>(settings_);
    } else if (settings_.protocol == MocapProtocol::kVrpn) {
      peer_ = std::make_unique<sim::vicon::VrpnPeer>(settings_);
    }
    driver_.on_opened(moment());
    if (peer_ && !peer_->outgoing.empty()) {
      enqueue(std::exchange(peer_->outgoing, {}), false);
    }
  }

  void publish(models::MocapFrame frame) {
    // An object stream does not contain its rate, so the driver must first estimate the rate after
    // a reconnect. Errors during this time are ignored.
    if (!driver_.is_datagram() || driver_.link_counts().backlogs == 0) {
      worst_error_s = std::max(worst_error_s, std::abs(to_seconds(frame.stamp.time - captured_)));
    }
    frame.stamp.run_id = 33;
    frame.stamp.sequence = sequence_++;
    bench_.driver->on_mocap(frame, bench_.now);
  }

  FlightBench& bench_;
  sim::vicon::ServerSettings settings_;
  sim::vicon::ObjectStreamServer object_stream_;
  std::unique_ptr<sim::vicon::Peer> peer_;
  std::deque<Chunk> chunks_;
  Time last_due_{};
  Time captured_{};
  std::uint32_t number_ = 0;
  std::int64_t sequence_ = 0;
  vicon::ViconDriver driver_;
};

struct LineRow {
  const char* name;
  MocapProtocol protocol;
  double slow_share;
  double queue_s;
};

class MocapLine : public ::testing::TestWithParam<LineRow> {};

// An object stream does not contain its rate. The driver therefore cannot detect that a connection
// is slow from the first frame, only that it becomes slow.
const LineRow kLineRows[] = {
    {"DataStreamSlowBy2", MocapProtocol::kDataStream, 0.02, 0.0},
    {"DataStreamSlowBy5", MocapProtocol::kDataStream, 0.05, 0.0},
    {"DataStreamSlowBy10", MocapProtocol::kDataStream, 0.10, 0.0},
    {"DataStreamQueueOf03", MocapProtocol::kDataStream, 0.0, 0.3},
    {"DataStreamQueueOf2", MocapProtocol::kDataStream, 0.0, 2.0},
    {"VrpnSlowBy2", MocapProtocol::kVrpn, 0.02, 0.0},
    {"VrpnSlowBy10", MocapProtocol::kVrpn, 0.10, 0.0},
    {"VrpnQueueOf03", MocapProtocol::kVrpn, 0.0, 0.3},
    {"VrpnQueueOf2", MocapProtocol::kVrpn, 0.0, 2.0},
    {"ObjectStreamSlowBy2", MocapProtocol::kObjectStream, 0.02, 0.0},
    {"ObjectStreamSlowBy10", MocapProtocol::kObjectStream, 0.10, 0.0},
    {"ObjectStreamQueueOf03", MocapProtocol::kObjectStream, 0.0, 0.3},
};
INSTANTIATE_TEST_SUITE_P(Rows, MocapLine, ::testing::ValuesIn(kLineRows),
                         [](const auto& row) { return std::string(row.param.name); });

TEST_P(MocapLine, ReportsItsLatencyAndHoldsTheVehicleWhileFramesAreQueued) {
  const LineRow& row = GetParam();
  FlightBench bench(models::AutopilotDialect::kPx4);
  Line line(bench, row.protocol);
  ASSERT_TRUE(bench.take_off()) << bench.reasons();
  bench.run(3.0);
  ASSERT_FALSE(bench.has_reason("pose late")) << bench.reasons();
  ASSERT_EQ(line.driver().link_counts().backlogs, 0);
  EXPECT_LT(line.worst_error_s, 0.02);
  line.slow_share = row.slow_share;
  line.queue = from_seconds(row.queue_s);
  // The delay must exceed the latency limit of 0.1 s by the allowed error of 0.05 s. Frames that
  // enter a queue arrive only after the queue's delay.
  const double promised_s = row.slow_share > 0.0 ? 0.15 / row.slow_share + 0.1 : row.queue_s + 0.15;
  EXPECT_TRUE(bench.run_until([&] { return bench.has_reason("pose late"); }, promised_s))
      << bench.reasons();
  EXPECT_NE(bench.state(), FlightState::kFollow);
  bench.run(2.0);
  EXPECT_LT(line.worst_error_s, 0.05);
  EXPECT_EQ(line.driver().link_counts().backlogs, 1) << line.driver().status();
  line.slow_share = 0.0;
  bench.run(10.0);
  EXPECT_FALSE(bench.has_reason("pose late")) << bench.reasons();
  EXPECT_LE(line.driver().link_counts().backlogs, 2);
}

}  // namespace
}  // namespace vantage::drivers
