#pragma once

#include <span>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "models/exchange/pose_messages.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::localizer {

/// Number of sightings of a frame that are used; further sightings are dropped and counted.
inline constexpr int kFrameSightingsMax = 16;
/// Id of a sighting whose body the sensor did not identify, or that fits no body.
inline constexpr int kNoBodyId = -1;
/// Id of a sighting that fits several bodies about equally well.
inline constexpr int kAmbiguousId = -2;

/// A landmark or teammate that a sighting may show.
struct CandidateBody {
  int id = 0;
  bool is_mate = false;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  /// Cross-covariance of the observer's (x, y, yaw) and the position.
  Eigen::Matrix<double, 3, 2> cross = Eigen::Matrix<double, 3, 2>::Zero();
};

/// One frame of a sensor, and the data needed to assign its sightings.
struct FrameScene {
  const scenario::SightingSpec& sensor;
  const scenario::SightingNoiseSpec& noise;
  std::span<const CandidateBody> bodies;
  std::span<const models::Sighting> sightings;  ///< at most kFrameSightingsMax
};

/// Pose of the observer with its covariance of (x, y, yaw).
struct ObserverView {
  Pose2 world_from_body;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Replaces each kNoBodyId in `ids` (one per sighting) by the id of the body that the sighting
/// shows, or by kAmbiguousId if several bodies fit. A sighting that fits no body keeps kNoBodyId.
///
/// Each of the at most 12 hypotheses assigns one sighting, corrects the observer's pose by it, and
/// then assigns the other sightings to the bodies that fit best. An assignment is used only if all
/// hypotheses that are about as likely as the best one contain it. Does not allocate memory.
void assign_frame(const FrameScene& scene, const ObserverView& observer, std::span<int> ids);

}  // namespace vantage::localizer
