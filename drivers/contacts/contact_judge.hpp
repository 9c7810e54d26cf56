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

/// Detector of contacts and near misses of real bodies from mocap frames, by a CollisionMonitor.
///
/// A robot has the radius of its safety limits, and a target has the radius in the scenario. Any
/// other body has the radius of the largest robot. Bodies without a pose are ignored.
///
/// Only contacts that involve a vehicle in flight count; other contacts are assumed to be caused by
/// people who handle the bodies. A robot counts as in flight from its driver's first status other
/// than `idle` until its next status `idle`, or until kFall after it was killed. Contacts without a
/// real body are reported by the simulator instead. A robot is simulated if its device is not real;
/// a target is simulated if TRUTH contains it. Pure; not thread-safe.
class ContactJudge {
 public:
  static constexpr Duration kFall = std::chrono::seconds(3);
  /// Longest gap between two frames in which the motion of the bodies is assumed to be known.
  static constexpr Duration kGapMax = std::chrono::milliseconds(200);
  static constexpr std::size_t kOthersMax = 32;  ///< maximum number of bodies outside the scenario

  explicit ContactJudge(const scenario::Scenario& scenario);

  void on_status(const models::VehicleStatus& status);
  void on_truth(const models::TruthFrame& truth);
  /// Returns the contacts that began since the previous frame, with times by the local clock
  /// (MocapClock). After a gap, or for a frame of another run, earlier motion is ignored. A frame
  /// captured no later than the last frame of its run is counted and ignored.
  /// @param now  arrival time of the frame
  std::vector<models::CollisionReport> on_frame(const models::MocapFrame& frame, Time now);

  [[nodiscard]] std::vector<models::NamedCount> counters() const;

 private:
  struct Flown {
    bool is_flying = false;
    bool is_killed = false;
    Time killed_at{};
  };
  [[nodiscard]] bool is_simulated(const std::string& body) const;
  [[nodiscard]] bool is_in_flight(const std::string& body, Time now) const;
  [[nodiscard]] bool counts(const models::CollisionReport& contact) const;
  void place(const models::MocapFrame& frame);

  double other_radius_m_ = 0.0;
  std::map<std::string, std::size_t> bodies_;  ///< index of a body in the monitor, by name
  std::size_t named_ = 0;                      ///< number of bodies in the scenario
  std::set<std::string> simulated_;
  std::set<std::string> targets_;
  std::map<std::string, Flown> robots_;
  models::CollisionMonitor monitor_;
  std::vector<Eigen::Vector3d> centres_m_;
  std::vector<models::CollisionReport> new_contacts_;
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
