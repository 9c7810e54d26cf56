#include "estimator/app/step_material.hpp"

#include <algorithm>

namespace vantage::estimator {

models::InputRef name_of(const std::string& channel, const models::Stamp& stamp) {
  return {channel, stamp.run_id, stamp.sequence};
}

std::optional<OwnPose> own_pose(const models::MocapFrame& frame, const std::string& robot,
                                std::size_t hint) {
  const models::MocapBody* body = frame.find(robot, hint);
  if (body == nullptr || body->occluded) {
    return std::nullopt;
  }
  return OwnPose{frame.stamp.time,
                 {flatten(body->world_from_body), body->world_from_body.translation_m.z()}};
}

bool has_viewpoint(const std::vector<NamedMessage<models::RobotMeasurement>>& measurements,
                   const std::string& robot, Time t, Duration step) {
  return std::any_of(measurements.begin(), measurements.end(), [&](const auto& look) {
    return look.content->robot == robot && look.content->stamp.time > t - step &&
           look.content->stamp.time <= t;
  });
}

models::RobotBelief make_step(DistributedFilter& filter, Time t, std::int64_t step,
                              const StepMaterial& material) {
  StepInput input;
  input.time = t;
  std::vector<const models::RobotMeasurement*> measurements;
  std::vector<const models::RobotBelief*> beliefs;
  std::vector<models::InputRef> names;
  Time newest = t - from_seconds(filter.spec().step_s);
  for (const auto& look : material.measurements) {
    measurements.push_back(look.content.get());
    names.push_back(look.ref);
    if (look.content->robot == filter.spec().robot && look.content->stamp.time > newest &&
        look.content->stamp.time <= t) {
      newest = look.content->stamp.time;
      input.viewpoint = look.content->viewpoint;
    }
  }
  if (material.pose) {
    names.push_back(material.pose->ref);
    input.viewpoint = material.pose->content->viewpoint;
  }
  for (const auto& belief : material.beliefs) {
    beliefs.push_back(belief.content.get());
    names.push_back(belief.ref);
  }
  input.measurements = measurements;
  input.beliefs = beliefs;
  models::RobotBelief made = filter.step(input);
  made.step = step;
  made.inputs = std::move(names);
  return made;
}

std::optional<models::BeliefMixture> mixture_of(const DistributedFilter& filter,
                                                const models::RobotBelief& made) {
  models::BeliefMixture mixture = filter.mixture();
  mixture.step = made.step;
  return mixture.targets.empty() ? std::nullopt : std::optional(std::move(mixture));
}

}  // namespace vantage::estimator
