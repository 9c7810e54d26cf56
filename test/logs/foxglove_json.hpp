#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "logs/appearance/appearance.hpp"
#include "logs/foxglove/parts.hpp"

// Helpers that read the JSON sent to viewers.

namespace vantage::logs::foxglove {

inline Eigen::Vector3d xyz(const Json& v) {
  return {v.at("x").get<double>(), v.at("y").get<double>(), v.at("z").get<double>()};
}

inline std::vector<Eigen::Vector3d> points_of(const Json& primitive) {
  std::vector<Eigen::Vector3d> out;
  for (const Json& each : primitive.at("points")) {
    out.push_back(xyz(each));
  }
  return out;
}

/// Returns a colour as 0xRRGGBB.
inline std::uint32_t rgb(const Json& colour) {
  std::uint32_t out = 0;
  for (const char* channel : {"r", "g", "b"}) {
    out = out << 8U |
          static_cast<std::uint32_t>(std::lround(255.0 * colour.at(channel).get<double>()));
  }
  return out;
}

inline std::uint32_t role(const char* name) { return appearance().roles.at(name).middle(); }

inline std::string told(const Json& entity, const std::string& key) {
  for (const Json& each : entity.at("metadata")) {
    if (each.at("key") == key) {
      return each.at("value");
    }
  }
  return "nothing of " + key;
}

/// Returns the corner of an upright cube with the smallest coordinates.
inline Eigen::Vector3d low_corner(const Json& cube) {
  return xyz(cube.at("pose").at("position")) - 0.5 * xyz(cube.at("size"));
}
inline Eigen::Vector3d high_corner(const Json& cube) {
  return xyz(cube.at("pose").at("position")) + 0.5 * xyz(cube.at("size"));
}

inline void expect_near(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  EXPECT_LT((a - b).norm(), 1e-9) << a.transpose() << " and " << b.transpose();
}

}  // namespace vantage::logs::foxglove
