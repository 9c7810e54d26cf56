#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {

/// Checks at every tick that the commands of flight safety form one path that can be flown.
///
/// **States** only become more severe: a vehicle that lands, has landed or is killed does not fly
/// again, and a killed vehicle stays killed (nothing re-arms it here).
///
/// **Set-points**, in the horizontal plane, move per tick at most as far as the greatest speed
/// allows, plus:
/// - v half_window / 2, since the course averages the plan over a window: at the start of another
///   plan, or when the assumed straight continuation ends because no successor arrived;
/// - plan_start_tolerance_m when a plan is accepted, since it may begin that far from the course;
///   while plans arrive in time, this gap is smoothed by a sixteenth per tick;
/// - any distance when a hold or landing begins within kAtBodyM of the estimated body position
///   (0.1 s of prediction and 0.1 s of lead at twice the speed, and the braking distance).
class SetpointMonitor {
 public:
  static constexpr double kAtBodyM = 0.45;

  explicit SetpointMonitor(FlightBench& bench);
  void update(FlightBench& bench);
  /// Returns the first violation of each kind for each vehicle, in words.
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
