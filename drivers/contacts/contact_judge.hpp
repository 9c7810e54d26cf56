#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/contact/collision_monitor.hpp"
#include "models/exchange/messages.hpp"
#include "models/exchange/mocap_clock.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Says which real bodies touch, or come nearer to each other than they may, from what cameras see:
/// a CollisionMonitor over the bodies of mocap frames.
///
/// A robot is as big as its limits say, a target as the scenario says, and any other body as the
/// largest robot: so flight safety takes it to be. A body that is not seen takes no part.
///
/// Counted is what a vehicle in flight has to do with: a contact of bodies that all rest is
/// people's work. A robot rests until its driver first says that it flies, again when it says
/// `idle`, and kFall after it was killed. Contacts between simulated bodies alone are the
/// simulator's to judge: these are the robots whose device is not real, and the targets that TRUTH
/// has named. Pure, one thread.
class ContactJudge {
 public:
  static constexpr Duration kFall = std::chrono::seconds(3);
  /// Over a longer gap between two frames nobody knows how the bodies moved.
  static constexpr Duration kGapMax = std::chrono::milliseconds(200);
  static constexpr std::size_t kOthersMax = 32;  ///< bodies that the scenario does not name

  explicit ContactJudge(const scenario::Scenario& scenario);

  void on_status(const models::VehicleStatus& status);
  void on_truth(const models::TruthFrame& truth);
  /// Returns the contacts that have begun since the frame before, with times by our clock
  /// (MocapClock). A frame of another run, or after a gap, has no motion before it. A frame that
  /// was not captured after the last of its run is counted and left out.
  /// @param now  arrival of the frame
  std::vector<models::ContactReport> on_frame(const models::MocapFrame& frame, Time now);

  [[nodiscard]] std::vector<models::NamedCount> counters() const;

 private:
  struct Flown {
    bool is_flying = false;
    bool is_killed = false;
    Time killed_at{};
  };
  [[nodiscard]] bool is_simulated(const std::string& body) const;
  [[nodiscard]] bool is_in_flight(const std::string& body, Time now) const;
  [[nodiscard]] bool counts(const models::ContactReport& contact) const;
  void place(const models::MocapFrame& frame);

  double other_radius_m_ = 0.0;
  std::map<std::string, std::size_t> bodies_;  ///< their places in the monitor's order
  std::size_t named_ = 0;                      ///< by the scenario
  std::set<std::string> simulated_;
  std::set<std::string> targets_;
  std::map<std::string, Flown> robots_;
  models::CollisionMonitor monitor_;
  std::vector<Eigen::Vector3d> centres_m_;
  std::vector<models::ContactReport> begun_;
  models::MocapClock clock_;
  std::int64_t last_run_ = 0;
  Time last_captured_{};
  bool has_last_ = false;
  std::int64_t gaps_ = 0;
  std::int64_t out_of_order_ = 0;
  std::int64_t clocks_set_ = 0;
  std::int64_t others_left_out_ = 0;
};

}  // namespace vantage::drivers
