#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace vantage::test {

/// What an autopilot did while a fixed sequence was played to it: what it was told, what it said,
/// and where its body truly was. Seconds since power-up; local frame of the autopilot, z down.
struct Recording {
  struct Event {
    double time_s = 0.0;
    std::string kind;  ///< mark, mode, armed, flags, landed, ack, text
    std::string what;
  };
  struct Moment {
    double time_s = 0.0;
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
    double yaw_rad = 0.0;
  };

  std::vector<std::string> provenance;
  std::vector<Event> events;
  std::vector<Moment> path;  ///< 10 Hz, from the first mark in the air

  void note(double time_s, const std::string& kind, const std::string& what);

  // What tests ask of it. `after_s` 0: from the beginning.
  /// When it was told so.
  [[nodiscard]] double mark(std::string_view what) const;
  /// The first event of its kind that begins with `what`, not before `after_s`.
  [[nodiscard]] std::optional<Event> first(std::string_view kind, std::string_view what,
                                           double after_s = 0.0) const;
  /// Of a kind, in order, without repetitions one after the other, of [after_s, before_s).
  [[nodiscard]] std::vector<std::string> order(std::string_view kind, double after_s = 0.0,
                                               double before_s = 1e9) const;
  /// The moments of [after_s, before_s).
  [[nodiscard]] std::vector<Moment> between(double after_s, double before_s) const;
  /// Between two samples, or the nearest one.
  [[nodiscard]] Moment at(double time_s) const;
};

/// Lines of commas, those of provenance first and behind a #.
std::ostream& operator<<(std::ostream& out, const Recording& recording);
/// @throws std::runtime_error for what is no recording.
Recording read_recording(std::istream& in);

}  // namespace vantage::test
