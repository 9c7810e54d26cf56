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

// The words that the well-known schemas are made of, as JSON.

namespace vantage::logs::foxglove {

using Json = nlohmann::json;

inline constexpr const char* kWorldFrame = "world";

/// Each channel in [0, 1].
struct Colour {
  double r = 0.0;
  double g = 0.0;
  double b = 0.0;
  double a = 1.0;
};

/// Type of a `lines` primitive.
enum class LineType { kStrip = 0, kLoop = 1, kList = 2 };

/// {sec, nsec} with 0 ≤ nsec < 10⁹, also before 1970.
Json to_json(Time time);
Json to_json(Duration duration);
Json to_json(const Eigen::Vector3d& v);
Json to_json(const Quaternion& q);
Json to_json(const Pose3& pose);
Json to_json(const Colour& colour);

/// A scene entity without primitives yet. A locked one moves with its frame.
Json entity(const std::string& id, const std::string& frame, Time time, bool is_locked);
/// `thickness_px` on the screen, whatever the zoom.
Json line(LineType type, const std::vector<Eigen::Vector3d>& points, double thickness_px,
          const Colour& colour);
/// Three points a triangle.
Json triangles(const std::vector<Eigen::Vector3d>& points, const Colour& colour);
Json cube(const Pose3& pose, const Eigen::Vector3d& size_m, const Colour& colour);
Json cylinder(const Pose3& pose, const Eigen::Vector3d& size_m, const Colour& colour);
/// Turned towards the viewer, `size_px` high on the screen.
Json label(const std::string& text, const Eigen::Vector3d& at_m, double size_px,
           const Colour& colour);
/// The entities as a SceneUpdate that deletes nothing.
Json scene_update(std::vector<Json> entities);

/// RFC 4648 with padding.
std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace vantage::logs::foxglove
