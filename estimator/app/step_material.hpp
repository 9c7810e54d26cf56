#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "estimator/distributed_filter.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::estimator {

/// A message and the name under which others may refer to it.
template <class Content>
struct Heard {
  models::InputRef ref;
  std::shared_ptr<const Content> content;
};

/// Where the mocap system saw the own body.
struct OwnPose {
  Time time{};
  models::Viewpoint viewpoint;
};

/// Everything that one step uses. Live and replayed steps are made from it by the same function,
/// which is why they are the same.
struct StepMaterial {
  std::vector<Heard<models::DetectionSet>> looks;
  std::optional<Heard<OwnPose>> pose;  ///< when no look of this step says where the robot is
  std::vector<Heard<models::RobotBelief>> beliefs;
};

/// The name of a message that arrived on `channel`.
models::InputRef name_of(const std::string& channel, const models::Stamp& stamp);

/// The pose of `robot` in `frame`; nullopt when it is missing or occluded.
std::optional<OwnPose> own_pose(const models::MocapFrame& frame, const std::string& robot,
                                std::size_t hint = 0);

/// True when one of `looks` is of `robot` and of the interval (t − τ, t], so that its viewpoint
/// serves for t.
bool has_viewpoint(const std::vector<Heard<models::DetectionSet>>& looks, const std::string& robot,
                   Time t, Duration step);

/// Advances `filter` to `t` and returns BELIEF_R complete but for its stamp's run id and sequence:
/// inputs are named in order of use, looks, pose, beliefs.
models::RobotBelief make_step(DistributedFilter& filter, Time t, std::int64_t step,
                              const StepMaterial& material);

/// MIXTURE_R of the step that `made` is of, but for the same; nullopt where there is nothing to
/// say.
std::optional<models::BeliefMixture> mixture_of(const DistributedFilter& filter,
                                                const models::RobotBelief& made);

}  // namespace vantage::estimator
