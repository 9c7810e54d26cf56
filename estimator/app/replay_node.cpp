#include "estimator/app/replay_node.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

#include "bus/convert/channels.hpp"
#include "models/exchange/counts.hpp"

namespace vantage::estimator {

namespace {

constexpr std::size_t kMeasurementsKeptPerRobot = 1024;
constexpr std::size_t kFramesKept = 2048;
constexpr std::size_t kBeliefsKeptPerTeammate = 64;
constexpr double kTolerance = 1e-9;

/// Returns a non-owning pointer to a message in a store; the store outlives the step.
template <class Content>
std::shared_ptr<const Content> borrowed(const Content* content) {
  return {std::shared_ptr<const Content>{}, content};
}

template <class A, class B>
bool close(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b, double tolerance) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         ((a - b).array().abs() <= tolerance * (1.0 + b.array().abs())).all();
}

// True if an observation belongs to a step before the last rebase of the filter.
bool reaches_behind(const StepMaterial& material, const std::optional<Time>& rebased_to) {
  return rebased_to &&
         std::any_of(material.measurements.begin(), material.measurements.end(),
                     [&](const auto& look) { return look.content->stamp.time <= *rebased_to; });
}

}  // namespace

bool same_content(const models::RobotBelief& a, const models::RobotBelief& b, double tolerance) {
  return a.stamp.time == b.stamp.time && a.degree == b.degree && a.grid == b.grid &&
         a.last_seen_utime == b.last_seen_utime &&
         std::equal(a.targets.begin(), a.targets.end(), b.targets.begin(), b.targets.end(),
                    [&](const models::TargetBelief& x, const models::TargetBelief& y) {
                      return x.target_id == y.target_id && x.last_seen == y.last_seen &&
                             close(x.information.vector, y.information.vector, tolerance) &&
                             close(x.information.matrix, y.information.matrix, tolerance);
                    });
}

EstimatorReplayNode::EstimatorReplayNode(bus::Bus& bus, const bus::Clock& clock,
                                         const scenario::Scenario& scenario,
                                         const std::string& robot)
    : bus_(bus),
      spec_(filter_spec(scenario, robot)),
      filter_(spec_),
      robot_(robot),
      measurements_(kMeasurementsKeptPerRobot),
      frames_(kFramesKept),
      beliefs_(kBeliefsKeptPerTeammate),
      next_tick_(clock.now() + bus::kReplayTick) {
  for (const scenario::RobotSpec& each : scenario.robots) {
    bus_.subscribe_named<models::RobotMeasurement>(
        bus::measurement_channel(each.name), [this](const std::string& channel, const auto& look) {
          measurements_.add(channel, look);
          work();
        });
  }
  bus_.subscribe_named<models::MocapFrame>(bus::kVicon,
                                           [this](const std::string& channel, const auto& frame) {
                                             frames_.add(channel, frame);
                                             work();
                                           });
  for (const scenario::RobotSpec& teammate : scenario.robots) {
    if (teammate.name != robot_) {
      bus_.subscribe_named<models::RobotBelief>(
          bus::belief_channel(teammate.name),
          [this](const std::string& channel, const auto& belief) {
            beliefs_.add(channel, belief);
            work();
          });
      bus_.subscribe_named<models::CompactBelief>(
          bus::compact_belief_channel(teammate.name),
          [this](const std::string& channel, const auto& belief) {
            if (const auto parts = models::expand(belief)) {
              beliefs_.add(channel, *parts);
              work();
            }
          });
    }
  }
  bus_.subscribe<models::RobotBelief>(bus::belief_channel(robot_), [this](const auto& belief) {
    logged_.add(belief);
    work();
  });
  if (scenario.planner.objective == scenario::PlanObjective::kMapping) {
    map_.emplace(bus, scenario, robot);
  }
}

std::string EstimatorReplayNode::name() const { return "REPLAY_ESTIMATOR_" + robot_; }

void EstimatorReplayNode::tick(Time now) {
  next_tick_ = now + bus::kReplayTick;
  logged_.tick();
  work();
  if (map_) {
    map_->tick();
  }
}

void EstimatorReplayNode::work() {
  logged_.work([this](const models::RobotBelief& logged, bool is_last_chance) {
    std::int64_t missing = 0;
    const StepMaterial material = gather(logged, missing);
    if (missing > 0 && !is_last_chance) {
      return false;
    }
    recompute(logged, material, missing);
    return true;
  });
}

StepMaterial EstimatorReplayNode::gather(const models::RobotBelief& logged,
                                         std::int64_t& missing) const {
  StepMaterial material;
  for (const models::InputRef& ref : logged.inputs) {
    if (const auto* look = measurements_.find(ref)) {
      material.measurements.push_back({ref, borrowed(look)});
    } else if (const auto* belief = beliefs_.find(ref)) {
      material.beliefs.push_back({ref, borrowed(belief)});
    } else if (const auto* frame = frames_.find(ref)) {
      if (const auto pose = own_pose(*frame, robot_)) {
        material.pose = NamedMessage<OwnPose>{ref, std::make_shared<const OwnPose>(*pose)};
      }
    } else {
      ++missing;
    }
  }
  return material;
}

void EstimatorReplayNode::recompute(const models::RobotBelief& logged, const StepMaterial& material,
                                    std::int64_t missing) {
  const bool first = logged.step == 0;
  const bool next =
      last_done_ && last_done_->run_id == logged.stamp.run_id && logged.step == last_step_ + 1;
  last_done_ = logged.stamp;
  last_step_ = logged.step;
  inputs_missing_ += missing;
  if (missing > 0 || !(first || next) || reaches_behind(material, rebased_to_)) {
    ++steps_rebased_;
    filter_.rebase(logged);
    rebased_to_ = logged.stamp.time;
    return;
  }
  if (first) {
    filter_ = DistributedFilter(spec_);
    rebased_to_.reset();
  }
  const models::RobotBelief made = make_step(filter_, logged.stamp.time, logged.step, material);
  ++steps_redone_;
  differences_ += same_content(made, logged, kTolerance) ? 0 : 1;
  if (const auto mixture = mixture_of(filter_, made)) {
    bus_.publish(bus::mixture_channel(robot_), *mixture);
  }
  bus_.publish(bus::belief_channel(robot_), made);
}

std::vector<models::NamedCount> EstimatorReplayNode::counters() const {
  std::vector<models::NamedCount> all = filter_.counters().named();
  models::append_nonzero(all, {{"steps_rebased", steps_rebased_},
                               {"inputs_missing", inputs_missing_},
                               {"differences", differences_}});
  if (map_) {
    const std::vector<models::NamedCount> of_map = map_->counters();
    all.insert(all.end(), of_map.begin(), of_map.end());
  }
  return all;
}

}  // namespace vantage::estimator
