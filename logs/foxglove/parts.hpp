#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "core/linear.hpp"
#include "core/pose.hpp"
#include "core/time.hpp"

// JSON building blocks of the Foxglove schemas.

namespace vantage::logs::foxglove {

using Json = nlohmann::json;

inline constexpr const char* kWorldFrame = "world";

/// Colour with components in [0, 1].
struct Colour {
  double r = 0.0;
  double g = 0.0;
  double b = 0.0;
  double a = 1.0;
};

/// Type of a `lines` primitive.
enum class LineType { kStrip = 0, kLoop = 1, kList = 2 };

/// Returns {sec, nsec} with 0 ≤ nsec < 10⁹, even for times before 1970.
Json to_json(Time time);
Json to_json(Duration duration);
Json to_json(const Eigen::Vector3d& v);
Json to_json(const Quaternion& q);
Json to_json(const Pose3& pose);
Json to_json(const Colour& colour);

/// Returns a scene entity without primitives. A locked entity moves with its frame.
Json entity(const std::string& id, const std::string& frame, Time time, bool is_locked);
/// Returns a line of constant `thickness_px` on the screen at any zoom.
Json line(LineType type, const std::vector<Eigen::Vector3d>& points, double thickness_px,
          const Colour& colour);
/// Returns triangles, three points each.
Json triangles(const std::vector<Eigen::Vector3d>& points, const Colour& colour);
Json cube(const Pose3& pose, const Eigen::Vector3d& size_m, const Colour& colour);
Json cylinder(const Pose3& pose, const Eigen::Vector3d& size_m, const Colour& colour);
/// Returns a label that faces the viewer and is `size_px` high on the screen.
Json label(const std::string& text, const Eigen::Vector3d& at_m, double size_px,
           const Colour& colour);
/// Returns a SceneUpdate with the entities and without deletions.
Json scene_update(std::vector<Json> entities);

/// Encodes as in RFC 4648, with padding.
std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace vantage::logs::foxglove
