#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/vicon/seen_frame.hpp"
#include "drivers/vicon/session.hpp"
#include "wire/vicon/vrpn.hpp"

namespace vantage::drivers::vicon {

/// When each tracker of a VRPN server reports, and where it is meanwhile.
///
/// Trackers that share their instants make frames as they come. A server may also have trackers
/// that report each at its own instants and rate. Then the fastest leads: its reports make the
/// frames, and the others are held, that is moved on (or back) from their last two reports to the
/// frame's instant, for 1.5 of their own periods; then they are not seen. Pure; allocates for a new
/// tracker alone.
class VrpnTrackers {
 public:
  explicit VrpnTrackers(bool is_y_up) : is_y_up_(is_y_up) {}

  void clear();
  /// Takes a report. True: this tracker is held, its report makes no frame and belongs to none.
  bool take(const std::string& name, std::int64_t stamp_us, const wire::vicon::VrpnPose& pose);
  /// Adds the held ones to the frame of `stamp_us`.
  void add_held(std::int64_t stamp_us, SeenFrame& frame) const;
  /// What each reports by itself.
  [[nodiscard]] std::vector<BodyRate> rates() const;

  /// Turns a pose of the wire into a body's sight.
  static void place(SeenBody& body, const wire::vicon::VrpnPose& pose, bool is_y_up);

  /// Poses of one frame are stamped one after the other; those of two are 1 ms apart at least.
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
    std::array<std::int64_t, kSteps> steps_us{};  ///< between its reports, the newest of them
    std::size_t steps = 0;                        ///< ever
    int apart = 0;                                ///< reports in a row away from the leader's
    int together = 0;                             ///< likewise with it
    bool is_held = false;

    /// Median of the newest steps; 0 while there are too few.
    [[nodiscard]] std::int64_t period_us() const;
    void note(std::int64_t stamp_us, const wire::vicon::VrpnPose& pose);
  };

  Tracker& tracker_of(const std::string& name);
  void choose_leader(const Tracker& reporter);
  void lead(const Tracker& tracker);

  bool is_y_up_;
  std::vector<Tracker> trackers_;
  std::size_t leader_ = 0;  ///< whenever there is any
};

}  // namespace vantage::drivers::vicon
