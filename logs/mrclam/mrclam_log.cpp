#include "logs/mrclam/mrclam_log.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bus/convert/channels.hpp"
#include "bus/convert/convert.hpp"
#include "core/angle.hpp"
#include "core/check.hpp"
#include "scenario/localizer_spec.hpp"
#include "scenario/reader/localizer_text.hpp"

namespace vantage::logs {
namespace {

constexpr double kMarkerHeightM = 0.3;  // assumed: the data contain no heights

struct Bounds {
  Eigen::Vector2d min_m = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d max_m = Eigen::Vector2d::Constant(-1e9);
  void add(const Eigen::Vector2d& position_m) {
    min_m = min_m.cwiseMin(position_m);
    max_m = max_m.cwiseMax(position_m);
  }
};

/// Writes messages as events with consecutive sequence numbers per channel.
class Writer {
 public:
  Writer(const EventSink& sink, const std::function<bool()>& stop, std::int64_t run_id)
      : sink_(sink), stop_(stop), run_id_(run_id) {}

  /// Returns false if nothing more shall be written.
  template <class Message>
  bool write(const bus::Channel<Message>& channel, Message& message) {
    message.stamp.run_id = run_id_;
    message.stamp.sequence = sequences_[channel.name]++;
    const auto wire = bus::to_wire(message);
    buffer_.resize(static_cast<std::size_t>(wire.getEncodedSize()));
    wire.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
    if (stop_() || !sink_({events_, message.stamp.time, channel.name, buffer_})) {
      return false;
    }
    ++events_;
    return true;
  }
  [[nodiscard]] std::int64_t events() const { return events_; }

 private:
  const EventSink& sink_;
  const std::function<bool()>& stop_;
  std::int64_t run_id_;
  std::map<std::string, std::int64_t> sequences_;
  std::vector<std::uint8_t> buffer_;
  std::int64_t events_ = 0;
};

/// Positions of the next lines of one robot's files.
struct Cursor {
  std::size_t command = 0;
  std::size_t observation = 0;
  std::size_t pose = 0;
};

/// Returns the time of the line at `index`, or Time::max() at the end.
template <class Rows>
Time time_at(const Rows& rows, std::size_t index) {
  return index < rows.size() ? rows[index].time : Time::max();
}

bool write_command(const MrclamData::Robot& robot, Cursor& cursor, Writer& writer) {
  const MrclamData::Command& command = robot.commands[cursor.command++];
  models::OdometryReport odometry;
  odometry.kind = models::OdometryKind::kCommand;
  odometry.stamp.time = command.time;
  odometry.robot = mrclam_robot(robot.subject);
  odometry.motion_body = {command.speed_mps, 0.0, command.turn_radps};
  return writer.write(bus::odometry_channel(odometry.robot), odometry);
}

bool write_frame(const MrclamData::Robot& robot, Cursor& cursor, Writer& writer) {
  const Time time = robot.observations[cursor.observation].time;
  models::SightingReport report;
  report.stamp.time = time;
  report.robot = mrclam_robot(robot.subject);
  for (; time_at(robot.observations, cursor.observation) == time; ++cursor.observation) {
    const MrclamData::Observation& each = robot.observations[cursor.observation];
    report.sightings.push_back({time, each.subject, each.range_m, each.bearing_rad});
  }
  return writer.write(bus::sightings_channel(report.robot), report);
}

/// Writes the poses of all robots at `time` as one frame of motion capture.
bool write_poses(const MrclamData& data, Time time, std::vector<Cursor>& cursors, Writer& writer,
                 std::int64_t& frames) {
  models::MocapFrame frame;
  frame.stamp.time = time;
  frame.arrival = time;
  frame.frame_number = frames++;
  for (std::size_t k = 0; k < data.robots.size(); ++k) {
    const auto& truth = data.robots[k].truth;
    std::size_t& next = cursors[k].pose;
    if (time_at(truth, next) == time) {
      frame.bodies.push_back({mrclam_robot(data.robots[k].subject),
                              lift(truth[next].world_from_body, kMarkerHeightM), false});
    }
    while (time_at(truth, next) == time) {
      ++next;
    }
  }
  return writer.write(bus::kVicon, frame);
}

Time begin_of(const MrclamData& data) {
  Time begin = Time::max();
  for (const MrclamData::Robot& robot : data.robots) {
    begin = std::min({begin, time_at(robot.commands, 0), time_at(robot.observations, 0),
                      time_at(robot.truth, 0)});
  }
  if (begin == Time::max()) {
    throw StartupError("the data set contains no line with a time");
  }
  return begin;
}

}  // namespace

std::string mrclam_robot(int subject) { return fmt::format("R{}", subject); }

std::string mrclam_scenario(const MrclamData& data) {
  constexpr double kMarginM = 1.0;
  Bounds bounds;
  scenario::LocalizerSpec spec;
  for (const MrclamData::Landmark& landmark : data.landmarks) {
    bounds.add(landmark.position_m);
    spec.landmarks.push_back({landmark.subject, landmark.position_m});
  }
  double duration_s = 1.0;
  std::string robots;
  for (const MrclamData::Robot& robot : data.robots) {
    for (const MrclamData::TruePose& pose : robot.truth) {
      bounds.add(pose.world_from_body.position_m());
    }
    if (!robot.commands.empty()) {
      duration_s =
          std::max(duration_s, to_seconds(robot.commands.back().time - robot.commands[0].time));
    }
    const std::string name = mrclam_robot(robot.subject);
    const Pose2 start = robot.truth.empty() ? Pose2{} : robot.truth.front().world_from_body;
    robots += fmt::format(
        "  - {{name: {}, start: {{x_m: {:.4f}, y_m: {:.4f}, yaw_deg: {:.3f}}}, height_m: {}}}\n",
        name, start.x_m, start.y_m, degrees(start.yaw_rad), kMarkerHeightM);
    scenario::LocalizedRobotSpec& one = spec.robots.emplace_back();
    one.name = name;
    one.id = robot.subject;
  }
  bounds.add(Eigen::Vector2d::Zero());
  const auto pair = [](const Eigen::Vector2d& p) {
    return fmt::format("[{}, {}]", std::floor(p.x()), std::floor(p.y()));
  };
  return fmt::format(
             "# Recording of the data set MRCLAM, imported by vantage log import.\n"
             "name: mrclam\n"
             "duration_s: {:.0f}\n"
             "world:\n"
             "  bounds: {{min_m: {}, max_m: {}}}\n"
             "robot_defaults:\n"
             "  primitives: lab\n"
             "  limits: {{speed_max_mps: 1, yaw_rate_max_radps: 3, brake_mps2: 2, radius_m: "
             "0.17}}\n"
             "  sensor: {{kind: range_bearing, range_min_m: 0.5, range_max_m: 9, fov_deg: 66}}\n"
             "robots:\n",
             std::ceil(duration_s), pair(bounds.min_m - Eigen::Vector2d::Constant(kMarginM)),
             pair(bounds.max_m + Eigen::Vector2d::Constant(kMarginM + 1.0))) +
         robots +
         "targets: {count: 1, name_prefix: W}   # a scenario needs one; none was recorded\n" +
         scenario::localizer_text(spec);
}

std::int64_t write_mrclam(const MrclamData& data, const std::string& version, const EventSink& sink,
                          const std::function<bool()>& stop) {
  const Time begin = begin_of(data);
  Writer writer(sink, stop, to_utime(begin));
  models::ScenarioNotice notice;
  notice.stamp.time = begin;
  notice.yaml = mrclam_scenario(data);
  notice.version = version;
  notice.process = "import";
  if (!writer.write(bus::kScenario, notice)) {
    return writer.events();
  }
  std::vector<Cursor> cursors(data.robots.size());
  std::int64_t frames = 0;
  for (;;) {
    // Find the earliest next line. At equal times, commands are written before frames and poses.
    enum class Kind { kCommand, kFrame, kPoses };
    Time time = Time::max();
    Kind kind = Kind::kPoses;
    std::size_t found = 0;
    for (std::size_t k = 0; k < data.robots.size(); ++k) {
      const MrclamData::Robot& robot = data.robots[k];
      for (const auto& [candidate, of_kind] :
           {std::pair{time_at(robot.commands, cursors[k].command), Kind::kCommand},
            std::pair{time_at(robot.observations, cursors[k].observation), Kind::kFrame},
            std::pair{time_at(robot.truth, cursors[k].pose), Kind::kPoses}}) {
        if (candidate < time || (candidate == time && candidate < Time::max() && of_kind < kind)) {
          time = candidate;
          kind = of_kind;
          found = k;
        }
      }
    }
    if (time == Time::max()) {
      return writer.events();
    }
    const bool is_written =
        kind == Kind::kCommand ? write_command(data.robots[found], cursors[found], writer)
        : kind == Kind::kFrame ? write_frame(data.robots[found], cursors[found], writer)
                               : write_poses(data, time, cursors, writer, frames);
    if (!is_written) {
      return writer.events();
    }
  }
}

}  // namespace vantage::logs
