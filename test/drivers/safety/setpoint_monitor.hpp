#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {

/// Checks at every tick that the commands of flight safety form one feasible path.
///
/// **States** only become more severe: a vehicle that lands, has landed or is killed does not fly
/// again, and a killed vehicle stays killed (the bench does not re-arm it).
///
/// **Set-points**, in the horizontal plane, move per tick at most as far as the maximum speed
/// allows, plus:
/// - v half_window / 2 when another plan begins, or when the predicted straight continuation ends
///   because no next plan arrived: the course averages the plan over a window;
/// - plan_start_tolerance_m when a plan is accepted, because it may begin that far from the course;
///   while plans arrive in time, a sixteenth of this distance per tick;
/// - any distance when a hold or landing begins, if the set-point is then within kAtBodyM of the
///   estimated body position. kAtBodyM is the motion in 0.2 s (prediction and lead of 0.1 s each)
///   at twice the speed, plus the braking distance.
class SetpointMonitor {
 public:
  static constexpr double kAtBodyM = 0.45;

  explicit SetpointMonitor(FlightBench& bench);
  void update(FlightBench& bench);
  /// Returns descriptions of the first violation of each kind for each vehicle.
  [[nodiscard]] const std::vector<std::string>& path_violations() const { return path_violations_; }

 private:
  struct Snapshot {
    bool is_tracking = false;
    Eigen::Vector2d asked_m = Eigen::Vector2d::Zero();
    models::FlightState state{};
    bool has_jumped = false;
    bool has_gone_back = false;
  };
  static Snapshot snapshot_of(const Vehicle& vehicle);
  [[nodiscard]] double step_max_m(const Vehicle& vehicle, const Snapshot& before) const;

  drivers::SafetyLimits limits_;
  double corner_m_;
  std::vector<Snapshot> last_;
  std::vector<std::string> path_violations_;
};

}  // namespace vantage::test
