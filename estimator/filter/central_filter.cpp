#include "estimator/filter/central_filter.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "estimator/posterior/confinement.hpp"
#include "estimator/posterior/missed_detection.hpp"
#include "estimator/tracks/gaussian/track.hpp"

namespace vantage::estimator {
namespace {

const models::Measurement* measurement_of(const models::RobotMeasurement& look,
                                          std::size_t target) {
  const auto found = std::ranges::find_if(look.detections, [&](const models::Detection& of) {
    return of.target_id == static_cast<int>(target);
  });
  return found == look.detections.end() ? nullptr : &found->measurement;
}

}  // namespace

CentralFilter::CentralFilter(const CentralFilterSpec& spec, const models::World& world,
                             std::vector<models::Gaussian> priors)
    : spec_(spec),
      world_(&world),
      A_(spec.model.transition(spec.step_s)),
      W_(spec.model.process_noise(spec.step_s)),
      beliefs_(std::move(priors)),
      is_seen_(beliefs_.size(), 0) {}

void CentralFilter::predict() {
  for (models::Gaussian& belief : beliefs_) {
    belief = models::predict(belief, A_, W_);
    if (spec_.targets_stay_inside) {
      belief = reflect(belief, world_->bounds);
    }
  }
}

void CentralFilter::update(const models::SensorModel& sensor,
                           std::span<const models::RobotMeasurement> looks) {
  for (std::size_t m = 0; m < beliefs_.size(); ++m) {
    const auto reports = [&](const models::RobotMeasurement& look) {
      return measurement_of(look, m) != nullptr;
    };
    is_seen_[m] = 0;
    if (spec_.detection_probability > 0.0) {
      for (const models::RobotMeasurement& look : looks) {
        if (!reports(look)) {
          beliefs_[m] = missed_detection(beliefs_[m], sensor, look.viewpoint, *world_,
                                         spec_.detection_probability);
        }
      }
    } else if (std::ranges::none_of(looks, reports)) {
      continue;  // converting to information form and back would only add rounding
    }
    std::optional<models::Information> information = models::to_information(beliefs_[m]);
    for (const models::RobotMeasurement& look : looks) {
      const models::Measurement* const z = measurement_of(look, m);
      if (information && z != nullptr &&
          measure(*information, sensor, look.viewpoint, *z, 0.0) == Use::kUsed) {
        is_seen_[m] = 1;
      }
    }
    const auto updated = information ? models::to_gaussian(*information) : std::nullopt;
    beliefs_[m] = updated.value_or(beliefs_[m]);
  }
}

}  // namespace vantage::estimator
