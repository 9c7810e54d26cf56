#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "test/drivers/safety/flight_bench.hpp"

namespace vantage::test {

/// Looks, tick after tick, whether what flight safety asks for is one way that can be flown.
///
/// **States** go up the ladder: who lands, has landed or is killed does not fly on, and who is
/// killed stays so (nobody re-arms here).
///
/// **Set-points**, as seen from above, go no further in a tick than the greatest speed allows, but
/// - v half_window / 2 more: the course looks half its window ahead, where another plan begins, or
/// where the
///   plan goes on otherwise than straight because no other came;
/// - a plan may begin plan_start_tolerance_m away from the course, when it is taken; while it is
///   followed, and the next one comes in time, that gap is smoothed, a sixteenth at a time;
/// - to hold or land it may be asked to begin where its body is believed to be: within kAtBodyM of
///   it (a tenth of a second of prediction and one of lead, at twice the speed, and the braking).
class WayWatch {
 public:
  static constexpr double kAtBodyM = 0.45;

  explicit WayWatch(FlightBench& bench);
  void look(FlightBench& bench);
  /// The first of its kind of each vehicle, in words.
  [[nodiscard]] const std::vector<std::string>& missteps() const { return missteps_; }

 private:
  struct Seen {
    bool is_tracking = false;
    Eigen::Vector2d asked_m = Eigen::Vector2d::Zero();
    models::FlightState state{};
    bool has_jumped = false;
    bool has_gone_back = false;
  };
  static Seen seen(const Vehicle& vehicle);
  [[nodiscard]] double step_max_m(const Vehicle& vehicle, const Seen& before) const;

  drivers::SafetyLimits limits_;
  double corner_m_;
  std::vector<Seen> last_;
  std::vector<std::string> missteps_;
};

}  // namespace vantage::test
