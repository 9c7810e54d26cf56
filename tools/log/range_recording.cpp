#include "tools/log/range_recording.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <set>
#include <tuple>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/index.hpp"
#include "logs/file/message_visit.hpp"
#include "tools/log/log_scenario.hpp"

namespace vantage::tools {
namespace {

ColumnSpec time_column() {
  return {Quantity::kTime, {"time", "t", "utime", "timestamp", "time_stamp", "stamp"}};
}
ColumnSpec beacon_column() {
  return {Quantity::kName,
          {"beacon", "beacon_id", "id", "anchor", "anchor_id", "node", "node_id", "tag", "tag_id"}};
}
ColumnSpec length_column(std::vector<std::string_view> names) {
  return {Quantity::kLength, std::move(names)};
}
ColumnSpec x_column() { return length_column({"x", "x_world", "pos_x", "position_x", "px"}); }
ColumnSpec y_column() { return length_column({"y", "y_world", "pos_y", "position_y", "py"}); }

/// One range with the beacon's name, before beacons are numbered.
struct NamedRange {
  double time_s = 0.0;
  std::string beacon;
  double range_m = 0.0;
  Eigen::Vector2d robot_m = Eigen::Vector2d::Zero();

  [[nodiscard]] auto key() const { return std::tie(time_s, beacon, range_m); }
};

/// True if name `a` is sorted before `b`: numeric names by value, then the other names.
bool comes_before(const std::string& a, const std::string& b) {
  const auto number = [](const std::string& word) -> std::optional<double> {
    double out = 0.0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), out);
    return error == std::errc() && stop == word.data() + word.size() ? std::optional(out)
                                                                     : std::nullopt;
  };
  const auto x = number(a);
  const auto y = number(b);
  if (x && y && *x != *y) {
    return *x < *y;
  }
  return x.has_value() != y.has_value() ? x.has_value() : a < b;
}

/// Sorts ranges by time and numbers the beacons. Beacons with too few ranges are left out.
void take(std::vector<NamedRange> named, RangeRecording& recording) {
  recording.too_far = static_cast<std::int64_t>(std::erase_if(named, [](const NamedRange& range) {
    return !estimator::is_within_bound({range.robot_m, range.range_m, 0});
  }));
  std::stable_sort(named.begin(), named.end(),
                   [](const NamedRange& a, const NamedRange& b) { return a.time_s < b.time_s; });
  std::map<std::string, std::int64_t> ranges;
  for (const NamedRange& range : named) {
    ++ranges[range.beacon];
  }
  for (const auto& [beacon, count] : ranges) {
    if (count < estimator::kRangesOfBeaconMin) {
      recording.too_few.push_back(beacon);
      recording.of_too_few += count;
    } else {
      recording.beacons.push_back(beacon);
    }
  }
  std::sort(recording.beacons.begin(), recording.beacons.end(), comes_before);
  std::sort(recording.too_few.begin(), recording.too_few.end(), comes_before);
  std::map<std::string, int> numbers;
  for (const std::string& beacon : recording.beacons) {
    numbers.emplace(beacon, static_cast<int>(numbers.size()));
  }
  for (const NamedRange& range : named) {
    if (const auto number = numbers.find(range.beacon); number != numbers.end()) {
      recording.times_s.push_back(range.time_s);
      recording.ranges.push_back({range.robot_m, range.range_m, number->second});
    }
  }
}

std::vector<NamedRange> without_doubles(Table table, std::int64_t& doubled) {
  std::vector<NamedRange> out;
  for (TableRow& row : table.rows) {
    out.push_back({row.numbers[0], std::move(row.name), row.numbers[1], {}});
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const NamedRange& a, const NamedRange& b) { return a.key() < b.key(); });
  const auto end = std::unique(out.begin(), out.end(),
                               [](const auto& a, const auto& b) { return a.key() == b.key(); });
  doubled = out.end() - end;
  out.erase(end, out.end());
  return out;
}

/// Returns the default of gap_max_s, which exceeds the time between poses of a recording without
/// gaps.
double usual_gap_s(const std::vector<TableRow>& pose_rows) {
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < pose_rows.size(); ++i) {
    steps_s.push_back(pose_rows[i].numbers[0] - pose_rows[i - 1].numbers[0]);
  }
  if (steps_s.empty()) {
    return 0.0;
  }
  const auto middle = steps_s.begin() + static_cast<std::ptrdiff_t>(steps_s.size() / 2);
  std::nth_element(steps_s.begin(), middle, steps_s.end());
  return std::max(5.0 * *middle, 1.0);
}

}  // namespace

Table read_ranges(const std::string& path) {
  const std::array columns = {time_column(), beacon_column(),
                              length_column({"range", "distance", "dist", "r"})};
  return read_table(path, columns);
}

Table read_poses(const std::string& path) {
  const std::array columns = {time_column(), x_column(), y_column()};
  return read_table(path, columns);
}

std::vector<Survey> read_survey(const std::string& path) {
  const std::array columns = {beacon_column(), x_column(), y_column()};
  std::vector<Survey> out;
  std::set<std::string> names;
  for (const TableRow& row : read_table(path, columns).rows) {
    if (!names.insert(row.name).second) {
      throw StartupError(
          fmt::format("{}: beacon '{}' is listed twice; expected once", path, row.name));
    }
    out.push_back({row.name, {row.numbers[0], row.numbers[1]}});
  }
  return out;
}

RangeRecording place_ranges(Table ranges, Table poses, std::optional<double> gap_max_s) {
  RangeRecording recording;
  recording.not_finite = ranges.not_finite + (ranges.is_torn ? 1 : 0);
  recording.poses_left_out = poses.not_finite + (poses.is_torn ? 1 : 0);
  std::vector<TableRow>& pose_rows = poses.rows;
  std::stable_sort(pose_rows.begin(), pose_rows.end(), [](const TableRow& a, const TableRow& b) {
    return a.numbers[0] < b.numbers[0];
  });
  const auto end = std::unique(
      pose_rows.begin(), pose_rows.end(),
      [](const TableRow& a, const TableRow& b) { return a.numbers[0] == b.numbers[0]; });
  recording.poses_left_out += pose_rows.end() - end;
  pose_rows.erase(end, pose_rows.end());

  const double gap_s = gap_max_s ? *gap_max_s : usual_gap_s(pose_rows);

  std::vector<NamedRange> placed;
  for (NamedRange& range : without_doubles(std::move(ranges), recording.doubled)) {
    const auto after =
        std::lower_bound(pose_rows.begin(), pose_rows.end(), range.time_s,
                         [](const TableRow& pose, double t) { return pose.numbers[0] < t; });
    if (after == pose_rows.end() ||
        (after == pose_rows.begin() && after->numbers[0] != range.time_s)) {
      ++recording.outside_poses;
      continue;
    }
    const TableRow& to = *after;
    const TableRow& from = after == pose_rows.begin() ? *after : *std::prev(after);
    const double lasts_s = to.numbers[0] - from.numbers[0];
    const bool is_at_pose = to.numbers[0] == range.time_s;
    if (!is_at_pose && lasts_s > gap_s) {
      ++recording.in_gaps;
      continue;
    }
    const double share = is_at_pose ? 1.0 : (range.time_s - from.numbers[0]) / lasts_s;
    const Eigen::Vector2d a(from.numbers[1], from.numbers[2]);
    const Eigen::Vector2d b(to.numbers[1], to.numbers[2]);
    range.robot_m = a + share * (b - a);
    placed.push_back(std::move(range));
  }
  take(std::move(placed), recording);
  return recording;
}

RangeRecording recording_of(const logs::IndexedLog& log, const std::string& robot) {
  const scenario::Scenario scenario = scenario_of(log);
  std::set<std::string> rangers;
  for (const scenario::RobotSpec& each : scenario.robots) {
    const models::SensorKind kind = each.sensor.kind;
    const bool ranges =
        kind == models::SensorKind::kRange || kind == models::SensorKind::kRangeBearing;
    if (ranges && (robot.empty() || each.name == robot)) {
      rangers.insert(each.name);
    }
  }
  if (rangers.empty()) {
    throw StartupError(fmt::format("{}: {}; expected a sensor of kind range or range_bearing",
                                   log.path(),
                                   robot.empty() ? "no robot of its scenario has a range sensor"
                                                 : "no robot '" + robot + "' with a range sensor"));
  }
  std::vector<NamedRange> named;
  RangeRecording recording;
  logs::LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    logs::visit_message(*event, [&]<class Message>(const Message& message) {
      if constexpr (std::is_same_v<Message, models::RobotMeasurement>) {
        for (const models::Detection& each : message.detections) {
          const auto target = index(each.target_id);
          if (!rangers.contains(message.robot) || target >= scenario.targets.size()) {
            continue;  // not a selected robot, or a range without a target's id
          }
          named.push_back({1e-6 * static_cast<double>(to_utime(message.stamp.time)),
                           scenario.targets[target].name, each.measurement.z(0),
                           message.viewpoint.world_from_body.position_m()});
        }
      }
    });
  }
  take(std::move(named), recording);
  return recording;
}

SplitRecording split(const RangeRecording& recording, double fitted_share) {
  SplitRecording out;
  if (recording.ranges.empty()) {
    return out;
  }
  const double begin_s = recording.times_s.front();
  const double until_s = begin_s + fitted_share * (recording.times_s.back() - begin_s);
  std::vector<int> fitted(recording.beacons.size());
  for (std::size_t i = 0; i < recording.ranges.size(); ++i) {
    fitted[index(recording.ranges[i].beacon)] += recording.times_s[i] <= until_s ? 1 : 0;
  }
  std::vector<int> numbers(recording.beacons.size(), -1);
  for (std::size_t b = 0; b < numbers.size(); ++b) {
    if (fitted[b] >= estimator::kRangesOfBeaconMin) {
      numbers[b] = static_cast<int>(out.beacons.size());
      out.beacons.push_back(recording.beacons[b]);
    }
  }
  for (std::size_t i = 0; i < recording.ranges.size(); ++i) {
    estimator::TakenRange range = recording.ranges[i];
    range.beacon = numbers[index(range.beacon)];
    if (range.beacon >= 0) {
      (recording.times_s[i] <= until_s ? out.fitted : out.held_back).push_back(range);
    }
  }
  return out;
}

}  // namespace vantage::tools
