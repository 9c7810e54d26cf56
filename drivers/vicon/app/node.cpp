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
        "mocap.device is 'direct': the simulator publishes VICON; set mocap.device to wire or "
        "real");
  }
  return spec;
}

std::string in_capitals(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return text;
}

}  // namespace

ViconNode::ViconNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                     std::function<void(const std::string&)> report)
    : ViconNode(bus, clock, scenario, vicon::session_row(scenario.mocap.protocol),
                std::move(report)) {}

ViconNode::ViconNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                     const vicon::SessionRow& row, std::function<void(const std::string&)> report)
    : prefix_(row.protocol.driver()),
      name_(in_capitals(prefix_)),
      bus_(bus),
      clock_(clock),
      driver_(
          checked(scenario.mocap), row,
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
      models::nonzero({{"connections_failed", link.connections_failed},
                       {"connections_lost", link.connections_lost},
                       {"strangers", link_.strangers()},
                       {"silences", link.silences},
                       {"backlogs", link.backlogs},
                       {"broken_streams", wire.broken_streams},
                       {"broken_blocks", wire.broken_blocks},
                       {"frames_before_set", wire.frames_before_set},
                       {"unnamed_bodies", wire.unnamed_bodies},
                       {"late_blocks", wire.late_blocks},
                       {"duplicate_blocks", wire.duplicate_blocks},
                       {"frames_lost", frame.frames_lost},
                       {"frames_repeated", frame.frames_repeated},
                       {"frames_late", frame.frames_late},
                       {"frames_queued", frame.frames_queued},
                       {"frames_waited", frame.frames_waited},
                       {"server_restarts", frame.server_restarts},
                       {"latencies_refused", frame.latencies_refused},
                       {"poses_zero", frame.poses_zero},
                       {"poses_refused", frame.poses_refused},
                       {"poses_stuck", frame.poses_stuck},
                       {"poses_outlying", frame.poses_outlying},
                       {"poses_flipped", frame.poses_flipped},
                       {"poses_swapped", frame.poses_swapped},
                       {"poses_unconfirmed", frame.poses_unconfirmed},
                       {"names_refused", frame.names_refused},
                       {"names_twice", frame.names_twice},
                       {"names_taken", virtual_bodies_.names_taken()}});
  for (models::NamedCount& each : out) {
    each.name = prefix_ + "." + each.name;
  }
  models::append_latency(out, "latency.frame_published", latency_);
  return out;
}

}  // namespace vantage::drivers
