#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/vicon/seen_frame.hpp"
#include "drivers/vicon/session.hpp"
#include "wire/vicon/vrpn.hpp"

namespace vantage::drivers::vicon {

/// Trackers of a VRPN server: the times of their reports, and their poses between two reports.
///
/// Trackers that report at the same instants form frames directly. If trackers report at separate
/// instants and rates, the reports of the fastest tracker, the leader, form the frames. The other
/// trackers are "held": their last two reports are extrapolated (forward or backward) to the
/// instant of the frame. A held tracker is absent if its last report is older than 1.5 times its
/// own period. Pure; allocates only for a new tracker.
class VrpnTrackers {
 public:
  explicit VrpnTrackers(bool is_y_up) : is_y_up_(is_y_up) {}

  void clear();
  /// Processes a report. Returns true if this tracker is held: its report does not form a frame.
  bool take(const std::string& name, std::int64_t stamp_us, const wire::vicon::VrpnPose& pose);
  /// Adds the held trackers to the frame with stamp `stamp_us`.
  void add_held(std::int64_t stamp_us, SeenFrame& frame) const;
  /// Returns the report rate of each tracker.
  [[nodiscard]] std::vector<BodyRate> rates() const;

  /// Sets the state of `body` from a received pose.
  static void place(SeenBody& body, const wire::vicon::VrpnPose& pose, bool is_y_up);

  /// µs; maximum stamp difference within a frame. Stamps of different frames are at least 1 ms
  /// apart.
  static constexpr std::int64_t kSameFrame_us = 400;

 private:
  static constexpr std::size_t kSteps = 5;
  struct Report {
    std::int64_t stamp_us = 0;
    wire::vicon::VrpnPose pose;
  };
  struct Tracker {
    std::string name;
    Report last;
    Report before;
    int reports = 0;
    std::array<std::int64_t, kSteps> steps_us{};  ///< µs; newest intervals between reports
    std::size_t steps = 0;                        ///< number of stored intervals
    /// number of consecutive reports at other instants than the leader's
    int apart = 0;
    int together = 0;  ///< number of consecutive reports at the leader's instants
    bool is_held = false;

    /// Returns the median of the newest intervals, µs; 0 if too few are stored.
    [[nodiscard]] std::int64_t period_us() const;
    void note(std::int64_t stamp_us, const wire::vicon::VrpnPose& pose);
  };

  Tracker& tracker_of(const std::string& name);
  void choose_leader(const Tracker& reporter);
  void lead(const Tracker& tracker);

  bool is_y_up_;
  std::vector<Tracker> trackers_;
  std::size_t leader_ = 0;  ///< valid if there are trackers
};

}  // namespace vantage::drivers::vicon
