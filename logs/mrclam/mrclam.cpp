#include "logs/mrclam/mrclam.hpp"

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

using Row = std::vector<double>;

/// Calls `use` for each line of numbers in `path`. Empty lines and lines that begin with # are
/// skipped. `columns`: required number of numbers per line.
void read_rows(const std::filesystem::path& path, std::size_t columns,
               const std::function<void(const Row&)>& use) {
  std::ifstream file(path);
  if (!file) {
    throw StartupError(path.string() + ": cannot be read; the folder must contain this file");
  }
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos || line[begin] == '#') {
      continue;
    }
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
      throw StartupError(path.string() + ':' + std::to_string(number) + ": '" + line +
                         "' must consist of " + std::to_string(columns) + " finite numbers");
    }
    use(row);
  }
}

/// As read_rows(), for files whose first column is the time. The times must not decrease.
void read_timed_rows(const std::filesystem::path& path, std::size_t columns,
                     const std::function<void(Time, const Row&)>& use) {
  double newest_s = 0.0;
  read_rows(path, columns, [&](const Row& row) {
    if (row[0] < newest_s) {
      throw StartupError(path.string() + ": time " + std::to_string(row[0]) +
                         " s must not be before the previous line's, " + std::to_string(newest_s) +
                         " s; sort the file");
    }
    newest_s = row[0];
    use(Time{} + from_seconds(row[0]), row);
  });
}

MrclamData::Robot read_robot(const std::filesystem::path& folder, int subject,
                             const std::map<int, int>& subject_of_code) {
  MrclamData::Robot robot;
  robot.subject = subject;
  const std::string stem = "Robot" + std::to_string(subject) + "_";
  read_timed_rows(folder / (stem + "Odometry.dat"), 3, [&](Time time, const Row& row) {
    robot.commands.push_back({time, row[1], row[2]});
  });
  read_timed_rows(folder / (stem + "Measurement.dat"), 4, [&](Time time, const Row& row) {
    const auto found = subject_of_code.find(static_cast<int>(row[1]));
    const int seen = found == subject_of_code.end() ? -1 : found->second;
    robot.observations.push_back({time, seen, row[2], row[3]});
  });
  read_timed_rows(folder / (stem + "Groundtruth.dat"), 4, [&](Time time, const Row& row) {
    robot.truth.push_back({time, {row[1], row[2], wrap_to_pi(row[3])}});
  });
  return robot;
}

}  // namespace

MrclamData read_mrclam(const std::string& folder) {
  const std::filesystem::path path(folder);
  MrclamData data;
  std::map<int, int> subject_of_code;
  read_rows(path / "Barcodes.dat", 2, [&](const Row& row) {
    subject_of_code[static_cast<int>(row[1])] = static_cast<int>(row[0]);
  });
  read_rows(path / "Landmark_Groundtruth.dat", 5, [&](const Row& row) {
    data.landmarks.push_back({static_cast<int>(row[0]), {row[1], row[2]}});
  });
  for (int subject = 1; subject <= kRobotsMax; ++subject) {
    if (!std::filesystem::exists(path / ("Robot" + std::to_string(subject) + "_Odometry.dat"))) {
      break;
    }
    data.robots.push_back(read_robot(path, subject, subject_of_code));
  }
  if (data.robots.empty()) {
    throw StartupError(folder +
                       ": contains no Robot1_Odometry.dat; must be a folder of the MRCLAM "
                       "data set");
  }
  return data;
}

}  // namespace vantage::logs
