#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "estimator/filter/distributed_filter.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::estimator {

/// A received message with the name by which other messages refer to it.
template <class Content>
struct NamedMessage {
  models::InputRef ref;
  std::shared_ptr<const Content> content;
};

/// Pose of the robot as measured by the mocap system.
struct OwnPose {
  Time time{};
  models::Viewpoint viewpoint;
};

/// All inputs of one step. The same function computes live and replayed steps from these inputs, so
/// their results are equal.
struct StepMaterial {
  std::vector<NamedMessage<models::RobotMeasurement>> measurements;
  std::optional<NamedMessage<OwnPose>>
      pose;  ///< pose that is used if the robot made no observation
  std::vector<NamedMessage<models::RobotBelief>> beliefs;
};

/// Returns the name (channel, run, sequence number) of a message received on `channel`.
models::InputRef name_of(const std::string& channel, const models::Stamp& stamp);

/// Returns the pose of `robot` in `frame`; nullopt when it is missing or occluded.
/// @param hint index in `frame` at which the search for the robot begins
std::optional<OwnPose> own_pose(const models::MocapFrame& frame, const std::string& robot,
                                std::size_t hint = 0);

/// True if one of `measurements` was made by `robot` in the interval (t − τ, t], so that its
/// viewpoint can be used at time t.
bool has_viewpoint(const std::vector<NamedMessage<models::RobotMeasurement>>& measurements,
                   const std::string& robot, Time t, Duration step);

/// Advances `filter` to `t` and returns BELIEF_R; only run id and sequence number of its stamp are
/// not set. Inputs are named in order of use: observations, pose, beliefs.
models::RobotBelief make_step(DistributedFilter& filter, Time t, std::int64_t step,
                              const StepMaterial& material);

/// Returns MIXTURE_R of the step with the belief `made`; only run id and sequence number are not
/// set. Returns nullopt if it contains no target.
std::optional<models::BeliefMixture> mixture_of(const DistributedFilter& filter,
                                                const models::RobotBelief& made);

}  // namespace vantage::estimator
