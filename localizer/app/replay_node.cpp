#include "localizer/app/replay_node.hpp"

#include <memory>

#include "bus/convert/channels.hpp"
#include "models/exchange/counts.hpp"

namespace vantage::localizer {
namespace {

/// Returns a non-owning pointer to a message in a store; the store outlives the step.
template <class Content>
std::shared_ptr<const Content> borrowed(const Content* content) {
  return {std::shared_ptr<const Content>{}, content};
}

}  // namespace

LocalizerReplayNode::LocalizerReplayNode(bus::Bus& bus, const bus::Clock& clock,
                                         const scenario::Scenario& scenario,
                                         const std::string& robot)
    : bus_(bus),
      scenario_(scenario),
      robot_(robot),
      steps_(std::in_place, scenario, robot),
      next_tick_(clock.now() + bus::kReplayTick) {
  keep(bus::odometry_channel(robot), odometry_);
  keep(bus::sightings_channel(robot), sightings_);
  for (const std::string& teammate : steps_->teammates()) {
    keep(bus::pose_channel(teammate), estimates_);
  }
  keep(bus::kVicon, frames_);
  bus_.subscribe<models::PoseEstimate>(bus::pose_channel(robot), [this](const auto& estimate) {
    logged_.add(estimate);
    work();
  });
}

template <class Message>
void LocalizerReplayNode::keep(const bus::Channel<Message>& channel,
                               bus::InputStore<Message>& store) {
  bus_.subscribe_named<Message>(channel,
                                [this, &store](const std::string& name, const Message& message) {
                                  store.add(name, message);
                                  work();
                                });
}

void LocalizerReplayNode::tick(Time now) {
  next_tick_ = now + bus::kReplayTick;
  logged_.tick();
  work();
}

void LocalizerReplayNode::work() {
  logged_.work([this](const models::PoseEstimate& logged, bool is_last_chance) {
    return recompute(logged, is_last_chance);
  });
}

bool LocalizerReplayNode::recompute(const models::PoseEstimate& logged, bool is_last_chance) {
  if (logged.step == 0) {
    steps_.emplace(scenario_, robot_);
    run_id_ = logged.stamp.run_id;
    next_step_ = 0;
  }
  if (!steps_ || logged.step != next_step_ || logged.stamp.run_id != run_id_) {
    steps_.reset();
    ++steps_skipped_;
    return true;
  }
  std::vector<PoseInput> inputs;
  std::int64_t missing = 0;
  for (const models::InputRef& ref : logged.inputs) {
    if (const auto* odometry = odometry_.find(ref)) {
      inputs.push_back({ref, borrowed(odometry)});
    } else if (const auto* report = sightings_.find(ref)) {
      inputs.push_back({ref, borrowed(report)});
    } else if (const auto* estimate = estimates_.find(ref)) {
      inputs.push_back({ref, borrowed(estimate)});
    } else if (const auto* frame = frames_.find(ref)) {
      inputs.push_back({ref, borrowed(frame)});
    } else {
      ++missing;
    }
  }
  if (missing > 0) {
    if (is_last_chance) {
      inputs_missing_ += missing;
      ++steps_skipped_;
      steps_.reset();
    }
    return false;
  }
  bus_.publish(bus::pose_channel(robot_), steps_->step(logged.stamp.time, logged.step, inputs));
  ++next_step_;
  return true;
}

std::vector<models::NamedCount> LocalizerReplayNode::counters() const {
  std::vector<models::NamedCount> all =
      steps_ ? steps_->counters() : std::vector<models::NamedCount>{};
  models::append_nonzero(all,
                         {{"inputs_missing", inputs_missing_}, {"steps_skipped", steps_skipped_}});
  return all;
}

}  // namespace vantage::localizer
