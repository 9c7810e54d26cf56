#include "trial/replay/log_replay.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <string_view>
#include <utility>

#include "bus/auth/authenticator.hpp"
#include "bus/convert/channels.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "core/check.hpp"
#include "core/saturated_time.hpp"
#include "estimator/app/replay_node.hpp"
#include "localizer/app/replay_node.hpp"
#include "planner/app/replay_node.hpp"

namespace vantage::trial {
namespace {

constexpr const char* kPrefix = "REPLAY_";
constexpr std::int64_t kRunId = 1;
/// Virtual time that the replay continues after the end of the log, so that the node stops waiting
/// for inputs that the log lacks.
constexpr Duration kClosing{5'000'000};
constexpr Duration kClosingStep{100'000};
constexpr std::int64_t kEventsPerReport = 1000;

using Kind = ReplayTarget::Kind;
constexpr std::array<std::pair<std::string_view, Kind>, 3> kKinds{
    {{"planner", Kind::kPlanner},
     {"estimator", Kind::kEstimator},
     {"localizer", Kind::kLocalizer}}};

/// Returns the channels of the node's outputs.
std::vector<std::string> outputs_of(const ReplayTarget& target) {
  switch (target.kind) {
    case Kind::kPlanner:
      return {bus::plan_channel(target.robot).name, bus::team_proposal_channel(target.robot).name};
    case Kind::kEstimator:
      return {bus::belief_channel(target.robot).name, bus::map_channel(target.robot).name,
              bus::mixture_channel(target.robot).name};
    case Kind::kLocalizer:
      return {bus::pose_channel(target.robot).name};
  }
  return {};
}

std::unique_ptr<bus::Node> node_of(const ReplayTarget& target, bus::Bus& bus,
                                   const bus::Clock& clock, const scenario::Scenario& scenario) {
  switch (target.kind) {
    case Kind::kPlanner:
      return std::make_unique<planner::PlannerReplayNode>(bus, clock, scenario, target.robot);
    case Kind::kEstimator:
      return std::make_unique<estimator::EstimatorReplayNode>(bus, clock, scenario, target.robot);
    case Kind::kLocalizer:
      return std::make_unique<localizer::LocalizerReplayNode>(bus, clock, scenario, target.robot);
  }
  return nullptr;
}

}  // namespace

ReplayTarget parse_replay_target(const std::string& text, const scenario::Scenario& scenario) {
  const std::size_t colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  const auto known = std::find_if(kKinds.begin(), kKinds.end(),
                                  [&](const auto& each) { return each.first == kind; });
  require(colon != std::string::npos && known != kKinds.end(),
          "node '" + text + "': must be planner:ROBOT, estimator:ROBOT or localizer:ROBOT");
  const std::string robot = text.substr(colon + 1);
  require(scenario.find_robot(robot) != nullptr, "node '" + text + "': the log has no such robot");
  return {known->second, robot};
}

// Long function: it creates objects in the order in which they depend on each other.
ReplayReport replay_log(const logs::IndexedLog& log, const scenario::Scenario& scenario,
                        const ReplayTarget& target, const std::function<void(double)>& progress) {
  const std::vector<std::string> outputs = outputs_of(target);
  ReplayReport report;
  const Time end = std::min(log.survey().end, kClockTimeMax);
  bus::VirtualClock clock(std::min(log.survey().begin, end));
  bus::InProcessHub hub;
  const auto source = hub.connect();
  const auto receiver = hub.connect();
  // The node also publishes mixtures. A mixture is compared only if the log contains it, because
  // logs of older versions lack mixtures and messages can be lost.
  const std::string compared_if_logged = kPrefix + bus::mixture_channel(target.robot).name;
  for (const std::string& output : outputs) {
    receiver->subscribe(kPrefix + output,
                        [&](std::string_view channel, std::span<const std::uint8_t> message) {
                          if (channel != compared_if_logged || report.outputs.has_logged(message)) {
                            report.outputs.add_replayed(message);
                          }
                        });
  }
  const auto endpoint = hub.connect();
  bus::Bus bus(*endpoint, kRunId, kPrefix);
  const std::unique_ptr<bus::Node> node = node_of(target, bus, clock, scenario);

  const auto settle = [&] {
    while (bus.handle(std::chrono::microseconds(0)) > 0) {
    }
    if (node->next_tick() <= clock.now()) {
      node->tick(clock.now());
    }
    while (receiver->handle(std::chrono::microseconds(0)) > 0) {
    }
  };
  const auto judge = bus::auth::log_authenticator_for(scenario);
  report.lacks_keys = !judge && scenario.security.mode != scenario::SecurityMode::kOff;
  logs::LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    clock.set(std::clamp(event->time, clock.now(), end));
    // The log may also contain forged messages, which the processes refused in flight.
    if (judge && !judge->judge(event->channel, event->data, event->time).may_pass) {
      ++report.refused;
      continue;
    }
    if (std::find(outputs.begin(), outputs.end(), event->channel) != outputs.end()) {
      report.outputs.add_logged(event->data);
    }
    source->publish(std::string(event->channel), event->data);
    ++report.events;
    settle();
    if (progress && report.events % kEventsPerReport == 0) {
      progress(static_cast<double>(event->offset) / static_cast<double>(log.bytes().size()));
    }
  }
  for (Duration passed{}; passed < kClosing; passed += kClosingStep) {
    clock.set(clock.now() + kClosingStep);
    settle();
  }
  if (progress) {
    progress(1.0);
  }
  report.counters = node->counters();
  return report;
}

}  // namespace vantage::trial
