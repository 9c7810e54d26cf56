#include "sim/vicon/recorded_flight.hpp"

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/check.hpp"

namespace vantage::sim::vicon {
namespace {

constexpr std::size_t kColumns = 8;
constexpr double kTimeError_s = 1e-4;

bool parse(const std::string& line, std::array<double, kColumns>& row) {
  const char* at = line.c_str();
  for (std::size_t column = 0; column < kColumns; ++column) {
    char* end = nullptr;
    row[column] = std::strtod(at, &end);
    const char expected = column + 1 < kColumns ? ',' : '\0';
    if (end == at || (*end != expected && *end != '\r') || !std::isfinite(row[column])) {
      return false;
    }
    at = end + 1;
  }
  return true;
}

}  // namespace

RecordedFlight read_flight(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) {
    throw StartupError(path + ": cannot be read");
  }
  RecordedFlight flight;
  flight.name = std::filesystem::path(path).stem().string();
  std::array<double, kColumns> row{};
  double first_s = 0.0;
  for (std::size_t number = 2; std::getline(file, line); ++number) {
    const std::string where = path + ":" + std::to_string(number) + ": ";
    if (!parse(line, row)) {
      throw StartupError(where + "expected eight numbers: time, position, quaternion w x y z");
    }
    const Quaternion rotation(row[4], row[5], row[6], row[7]);
    if (std::abs(rotation.norm() - 1.0) > 1e-3) {
      throw StartupError(where + "the quaternion must have length 1");
    }
    const std::size_t count = flight.world_from_body.size();
    first_s = count == 0 ? row[0] : first_s;
    flight.period_s = count == 1 ? row[0] - first_s : flight.period_s;
    const double expected_s = first_s + static_cast<double>(count) * flight.period_s;
    if (count > 1 && std::abs(row[0] - expected_s) > kTimeError_s) {
      throw StartupError(where + "times must be evenly spaced");
    }
    flight.world_from_body.push_back({{row[1], row[2], row[3]}, rotation.normalized()});
  }
  if (flight.world_from_body.empty() || flight.period_s <= 0.0) {
    throw StartupError(path + ": contains no flight");
  }
  return flight;
}

}  // namespace vantage::sim::vicon
