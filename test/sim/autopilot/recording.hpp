#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace vantage::test {

/// The behaviour of an autopilot during a drill: the commands, the messages of the autopilot and
/// the true position of its body. Times are in s since power-up; positions are in the local frame
/// of the autopilot, z down.
struct Recording {
  struct Event {
    double time_s = 0.0;
    std::string kind;  ///< one of mark, mode, armed, flags, landed, ack, text
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
  std::vector<Moment> path;  ///< samples at 10 Hz, from the first mark in the air

  void note(double time_s, const std::string& kind, const std::string& what);

  // Queries for tests; `after_s` 0: from the beginning.
  // Returns the time of the mark `what`, s.
  [[nodiscard]] double mark(std::string_view what) const;
  /// Returns the first event of this kind at or after `after_s` that begins with `what`.
  [[nodiscard]] std::optional<Event> first(std::string_view kind, std::string_view what,
                                           double after_s = 0.0) const;
  /// Returns the events of a kind in [after_s, before_s), in order, without consecutive duplicates.
  [[nodiscard]] std::vector<std::string> order(std::string_view kind, double after_s = 0.0,
                                               double before_s = 1e9) const;
  /// Returns the samples in [after_s, before_s).
  [[nodiscard]] std::vector<Moment> between(double after_s, double before_s) const;
  /// Returns the sample at `time_s`, interpolated between two samples, or the nearest one.
  [[nodiscard]] Moment at(double time_s) const;
};

/// Writes the recording as comma-separated lines. The first lines, which begin with #, describe its
/// origin.
std::ostream& operator<<(std::ostream& out, const Recording& recording);
/// Reads a recording. @throws std::runtime_error if the text is not a recording.
Recording read_recording(std::istream& in);

}  // namespace vantage::test
