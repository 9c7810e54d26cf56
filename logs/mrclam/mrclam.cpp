#include "logs/mrclam/mrclam.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "core/angle.hpp"
#include "core/check.hpp"

namespace vantage::logs {
namespace {

constexpr int kRobotsMax = 50;
constexpr double kTimeMaxS = 1e10;
constexpr double kRangeMaxM = 1e4;

using Row = std::vector<double>;
/// Function that checks the numbers of a line. Returns the violated rule as text for an error, or
/// an empty text if the numbers are valid.
using Rule = std::function<std::string(const Row&)>;

bool is_whole(double value) { return value >= 0.0 && value <= 1e6 && value == std::floor(value); }

/// Calls `use` for each line of numbers in `path`. Empty lines and lines that begin with # are
/// skipped. `columns`: required number of numbers per line.
void read_rows(const std::filesystem::path& path, std::size_t columns, const Rule& rule,
               const std::function<void(const Row&)>& use) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) {
    throw StartupError(path.string() + ": cannot be read; the folder must contain this file");
  }
  std::string line;
  bool is_empty = true;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos || line[begin] == '#') {
      continue;
    }
    const auto refuse = [&](const std::string& why) {
      constexpr std::size_t kShown = 80;  // characters of the line in an error
      throw StartupError(path.string() + ':' + std::to_string(number) + ": '" +
                         line.substr(0, kShown) + "' " + why);
    };
    std::istringstream words(line);
    Row row;
    for (double value = 0.0; words >> value;) {
      row.push_back(value);
    }
    bool is_valid = words.eof() && row.size() == columns;
    for (const double value : row) {
      is_valid = is_valid && std::isfinite(value) && std::abs(value) < kTimeMaxS;
    }
    if (!is_valid) {
      refuse("must consist of " + std::to_string(columns) +
             " finite numbers; the file is damaged or is another file of the data set");
    }
    if (const std::string why = rule(row); !why.empty()) {
      refuse(why);
    }
    is_empty = false;
    use(row);
  }
  if (is_empty) {
    throw StartupError(path.string() + ": contains no line of numbers; the file is truncated");
  }
}

/// Sorts rows by time. Returns the number of rows with a time before that of the preceding row.
template <class Rows>
std::int64_t sort_by_time(Rows& rows) {
  std::int64_t count = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    count += rows[i].time < rows[i - 1].time ? 1 : 0;
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& a, const auto& b) { return a.time < b.time; });
  return count;
}

/// Calls `use` with the time of each line, which is its first number.
void read_timed_rows(const std::filesystem::path& path, std::size_t columns, const Rule& rule,
                     const std::function<void(Time, const Row&)>& use) {
  const auto timed = [&](const Row& row) {
    return row[0] < 0.0 ? "must begin with a time of at least 0 s" : rule(row);
  };
  read_rows(path, columns, timed, [&](const Row& row) { use(Time{} + from_seconds(row[0]), row); });
}

std::string command_rule(const Row& row) {
  constexpr double kRateMax = 100.0;
  return std::abs(row[1]) > kRateMax || std::abs(row[2]) > kRateMax
             ? "must consist of a time, a speed within 100 m/s and a turn rate within 100 rad/s"
             : "";
}

std::string observation_rule(const Row& row) {
  return is_whole(row[1]) ? "" : "must have a bar code, which is a whole number, in column 2";
}

std::string pose_rule(const Row& row) {
  constexpr double kPositionMaxM = 1e4;
  return std::abs(row[1]) > kPositionMaxM || std::abs(row[2]) > kPositionMaxM
             ? "must have a position within 10 km of the origin in columns 2 and 3"
             : "";
}

std::string subject_rule(const Row& row) {
  return is_whole(row[0]) ? "" : "must begin with a subject, which is a whole number";
}

std::filesystem::path odometry_file(const std::filesystem::path& folder, int subject) {
  return folder / ("Robot" + std::to_string(subject) + "_Odometry.dat");
}

MrclamData::Robot read_robot(const std::filesystem::path& folder, int subject,
                             const std::map<int, int>& subject_of_code, MrclamData& data) {
  MrclamData::Robot robot;
  robot.subject = subject;
  const std::string stem = "Robot" + std::to_string(subject) + "_";
  read_timed_rows(odometry_file(folder, subject), 3, command_rule, [&](Time time, const Row& row) {
    robot.commands.push_back({time, row[1], row[2]});
  });
  read_timed_rows(folder / (stem + "Measurement.dat"), 4, observation_rule,
                  [&](Time time, const Row& row) {
                    const auto found = subject_of_code.find(static_cast<int>(row[1]));
                    const int seen = found == subject_of_code.end() ? -1 : found->second;
                    if (row[2] <= 0.0 || row[2] > kRangeMaxM || std::abs(row[3]) > kPi) {
                      ++data.impossible;
                    } else {
                      robot.observations.push_back({time, seen, row[2], row[3]});
                    }
                  });
  read_timed_rows(folder / (stem + "Groundtruth.dat"), 4, pose_rule,
                  [&](Time time, const Row& row) {
                    robot.truth.push_back({time, {row[1], row[2], wrap_to_pi(row[3])}});
                  });
  data.reordered += sort_by_time(robot.commands);
  data.reordered += sort_by_time(robot.observations);
  data.reordered += sort_by_time(robot.truth);
  return robot;
}

}  // namespace

MrclamData read_mrclam(const std::string& folder) {
  const std::filesystem::path path(folder);
  MrclamData data;
  std::map<int, int> subject_of_code;
  read_rows(
      path / "Barcodes.dat", 2,
      [](const Row& row) {
        return is_whole(row[0]) && is_whole(row[1])
                   ? ""
                   : "must consist of a subject and a bar code, which are whole numbers";
      },
      [&](const Row& row) {
        subject_of_code[static_cast<int>(row[1])] = static_cast<int>(row[0]);
      });
  read_rows(path / "Landmark_Groundtruth.dat", 5, subject_rule, [&](const Row& row) {
    data.landmarks.push_back({static_cast<int>(row[0]), {row[1], row[2]}});
  });
  for (int subject = 1; subject <= kRobotsMax; ++subject) {
    if (!std::filesystem::exists(odometry_file(path, subject))) {
      continue;
    }
    if (static_cast<int>(data.robots.size()) + 1 < subject) {
      throw StartupError(odometry_file(path, subject - 1).string() +
                         ": is missing, but the folder contains " +
                         odometry_file(path, subject).filename().string());
    }
    data.robots.push_back(read_robot(path, subject, subject_of_code, data));
  }
  if (data.robots.empty()) {
    throw StartupError(folder +
                       ": contains no Robot1_Odometry.dat; must be a folder of the MRCLAM "
                       "data set");
  }
  return data;
}

}  // namespace vantage::logs
