#pragma once

#include <cmath>

#include "models/sensor/law.hpp"

// A sensor kind that is not in the library, as a user would write it: the signal strength of a
// radio beacon, which falls with the square of its distance.

namespace vantage::test {

inline constexpr double kDecibelsPerNeper = 8.685889638065035;  // 20 / ln 10
inline constexpr double kStrengthSigma_db = 0.8;

inline const models::SensorLaw& signal_strength_law() {
  using models::SensorModel;
  using models::SightLine;
  using models::Viewpoint;
  static constexpr models::SensorLaw kLaw{
      .name = "signal_strength",
      .measurement_dim = [](int /*position_dim*/) { return 1; },
      .can_measure = [](const SensorModel& /*sensor*/, const Viewpoint& /*from*/,
                        const SightLine& to) { return to.range_m >= models::kLeastRange_m; },
      .observe = [](const SensorModel& /*sensor*/, const Viewpoint& /*from*/, const SightLine& to,
                    int /*position_dim*/) -> models::MeasurementVector {
        return Eigen::Matrix<double, 1, 1>(-kDecibelsPerNeper * std::log(to.range_m));
      },
      .jacobian = [](const SensorModel& /*sensor*/, const Viewpoint& /*from*/, const SightLine& to,
                     int position_dim) -> models::MeasurementJacobian {
        return -kDecibelsPerNeper / (to.range_m * to.range_m) *
               to.offset_world_m.head(position_dim).transpose();
      },
      .variances = [](const SensorModel& /*sensor*/, const Viewpoint& /*from*/,
                      const SightLine& /*to*/, int /*position_dim*/) -> models::MeasurementVector {
        return Eigen::Matrix<double, 1, 1>(kStrengthSigma_db * kStrengthSigma_db);
      },
      .information_bound =
          [](const SensorModel& /*sensor*/, const models::ReachedDistances& reached) {
            const double per_sigma = kDecibelsPerNeper / (kStrengthSigma_db * reached.range_near_m);
            return per_sigma * per_sigma;  // +∞ at the beacon
          },
  };
  return kLaw;
}

/// Returns the handle of the sensor kind.
inline models::SensorKind signal_strength() { return models::SensorKind(signal_strength_law()); }

}  // namespace vantage::test
