#include "localizer/app/node.hpp"

#include <algorithm>
#include <utility>

#include "bus/convert/channels.hpp"
#include "models/exchange/counts.hpp"

namespace vantage::localizer {
namespace {

constexpr std::size_t kInputsWaitingPerRobot = 64;

/// Returns the newest multiple of kIncrement that is not after `time`.
Time grid_at_or_before(Time time) {
  return from_utime(to_utime(time) / kIncrement.count() * kIncrement.count());
}

}  // namespace

LocalizerNode::LocalizerNode(bus::Bus& bus, const bus::Clock& clock,
                             const scenario::Scenario& scenario, const std::string& robot)
    : bus_(bus),
      robot_(robot),
      steps_(scenario, robot),
      next_instant_(grid_at_or_before(clock.now()) + kIncrement) {
  subscribe(bus::odometry_channel(robot), robot);
  subscribe(bus::sightings_channel(robot), robot);
  for (const std::string& teammate : steps_.teammates()) {
    subscribe(bus::pose_channel(teammate), teammate);
  }
  bus_.subscribe_shared<models::MocapFrame>(
      bus::kVicon, [this](const auto& /*name*/, const auto& frame) { on_mocap(frame); });
}

template <class Message>
void LocalizerNode::subscribe(const bus::Channel<Message>& channel, const std::string& sender) {
  bus_.subscribe_shared<Message>(
      channel, [this, sender](const std::string& name, const std::shared_ptr<const Message>& m) {
        if (m->robot != sender) {
          ++misaddressed_;
          return;
        }
        add({models::ref_to(name, m->stamp), m});
      });
}

void LocalizerNode::add(PoseInput input) {
  if (waiting_.size() == kInputsWaitingPerRobot * steps_.spec().robots.size()) {
    waiting_.pop_front();
    ++inputs_overflowed_;
  }
  waiting_.push_back(std::move(input));
}

void LocalizerNode::on_mocap(const std::shared_ptr<const models::MocapFrame>& frame) {
  if (frame->stamp.time <= last_mocap_) {
    ++mocap_out_of_order_;
    return;
  }
  // A frame that is later than the next step is not used: a later step uses a newer frame.
  if (frame->stamp.time > next_instant_) {
    mocap_too_new_ += frame->stamp.time > next_instant_ + PoseSteps::kAheadMax ? 1 : 0;
    return;
  }
  last_mocap_ = frame->stamp.time;
  if (steps_.sees_a_robot(*frame)) {
    mocap_ = frame;
  }
}

void LocalizerNode::tick(Time now) {
  if (now < next_tick()) {
    return;
  }
  const Time t = grid_at_or_before(now - kLag);
  instants_missed_ += (t - next_instant_) / kIncrement;
  next_instant_ = t + kIncrement;
  if (mocap_) {
    add({models::ref_to(bus::kVicon.name, mocap_->stamp), std::move(mocap_)});
    mocap_.reset();
  }
  const std::vector<PoseInput> inputs(waiting_.begin(), waiting_.end());
  waiting_.clear();
  bus_.publish(bus::pose_channel(robot_), steps_.step(t, step_++, inputs));
}

std::vector<models::NamedCount> LocalizerNode::counters() const {
  std::vector<models::NamedCount> all = steps_.counters();
  models::append_nonzero(all, {{"localizer.inputs_overflowed", inputs_overflowed_},
                               {"localizer.misaddressed", misaddressed_},
                               {"localizer.mocap_out_of_order", mocap_out_of_order_},
                               {"localizer.mocap_too_new", mocap_too_new_}});
  return all;
}

}  // namespace vantage::localizer
