#pragma once

#include <string>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"

namespace vantage::sim {

/// Body of a robot in the simulated world, with any kind of control: its true state and its motion.
class Vehicle {
 public:
  virtual ~Vehicle() = default;

  [[nodiscard]] virtual const std::string& name() const = 0;
  /// Returns the radius of the collision sphere around the body's centre.
  [[nodiscard]] virtual double radius_m() const = 0;
  [[nodiscard]] virtual Pose3 world_from_body() const = 0;
  [[nodiscard]] virtual Eigen::Vector3d velocity_world_mps() const = 0;
  /// Steps from `now` by `dt_s` ≤ 0.02 s.
  virtual void step(Time now, double dt_s) = 0;

 protected:
  Vehicle() = default;
  Vehicle(const Vehicle&) = default;
  Vehicle(Vehicle&&) = default;
  Vehicle& operator=(const Vehicle&) = default;
  Vehicle& operator=(Vehicle&&) = default;
};

}  // namespace vantage::sim
