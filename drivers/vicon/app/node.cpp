#include "drivers/vicon/app/node.hpp"

#include <algorithm>
#include <utility>

#include "bus/convert/channels.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"
#include "models/exchange/counts.hpp"

namespace vantage::drivers {
namespace {

constexpr Duration kTickMin{200};
constexpr std::size_t kReportedMax = 32;
constexpr Duration kTickMax = std::chrono::milliseconds(100);

const scenario::MocapSpec& checked(const scenario::MocapSpec& spec) {
  if (spec.device == scenario::DeviceSource::kDirect) {
    throw StartupError(
        "mocap is 'direct': the simulator publishes it itself; set mocap.device to wire or real");
  }
  return spec;
}

}  // namespace

ViconNode::ViconNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                     std::function<void(const std::string&)> report)
    : bus_(bus),
      clock_(clock),
      driver_(
          checked(scenario.mocap),
          [this](models::MocapFrame frame) {
            virtual_bodies_.add_to(frame);
            const Time arrival = frame.arrival;
            bus_.publish(bus::kVicon, std::move(frame));
            latency_.add(clock_.now() - arrival);
          },
          scenario.planner.separation_m),
      link_(driver_, [this] { return moment(); }),
      report_(std::move(report)),
      next_tick_(clock.now()) {
  // Simulated mocap contains the simulated bodies already.
  if (scenario.mocap.device == scenario::DeviceSource::kReal) {
    bus_.subscribe<models::TruthFrame>(
        bus::kTruth, [this](const models::TruthFrame& truth) { virtual_bodies_.on_truth(truth); });
  }
}

vicon::Moment ViconNode::moment() const { return {clock_.now(), Duration{monotonic_ns() / 1'000}}; }

void ViconNode::tick(Time now) {
  link_.step();
  report_status(driver_.status());
  next_tick_ = now + std::clamp(link_.next_wake() - moment().steady, kTickMin, kTickMax);
}

void ViconNode::report_status(const std::string& status) {
  if (status == status_) {
    return;
  }
  status_ = status;
  if (driver_.has_frames()) {
    reported_.clear();
  }
  // Each status is reported only once during repeated attempts.
  if (std::find(reported_.begin(), reported_.end(), status) == reported_.end() &&
      reported_.size() < kReportedMax) {
    reported_.push_back(status);
    report_(status);
  }
}

std::vector<models::NamedCount> ViconNode::counters() const {
  const vicon::LinkCounts& link = driver_.link_counts();
  const vicon::WireCounts& wire = driver_.wire_counts();
  const vicon::FrameCounts& frame = driver_.frame_counts();
  std::vector<models::NamedCount> out =
      models::nonzero({{"vicon.connections_failed", link.connections_failed},
                       {"vicon.connections_lost", link.connections_lost},
                       {"vicon.strangers", link_.strangers()},
                       {"vicon.silences", link.silences},
                       {"vicon.backlogs", link.backlogs},
                       {"vicon.broken_streams", wire.broken_streams},
                       {"vicon.broken_blocks", wire.broken_blocks},
                       {"vicon.frames_before_set", wire.frames_before_set},
                       {"vicon.unnamed_bodies", wire.unnamed_bodies},
                       {"vicon.late_blocks", wire.late_blocks},
                       {"vicon.duplicate_blocks", wire.duplicate_blocks},
                       {"vicon.frames_lost", frame.frames_lost},
                       {"vicon.frames_repeated", frame.frames_repeated},
                       {"vicon.frames_late", frame.frames_late},
                       {"vicon.frames_queued", frame.frames_queued},
                       {"vicon.frames_waited", frame.frames_waited},
                       {"vicon.server_restarts", frame.server_restarts},
                       {"vicon.latencies_refused", frame.latencies_refused},
                       {"vicon.poses_zero", frame.poses_zero},
                       {"vicon.poses_refused", frame.poses_refused},
                       {"vicon.poses_stuck", frame.poses_stuck},
                       {"vicon.poses_outlying", frame.poses_outlying},
                       {"vicon.poses_flipped", frame.poses_flipped},
                       {"vicon.poses_swapped", frame.poses_swapped},
                       {"vicon.poses_unconfirmed", frame.poses_unconfirmed},
                       {"vicon.names_refused", frame.names_refused},
                       {"vicon.names_twice", frame.names_twice},
                       {"vicon.names_taken", virtual_bodies_.names_taken()}});
  models::append_latency(out, "latency.frame_published", latency_);
  return out;
}

}  // namespace vantage::drivers
