#include "logs/foxglove/parts.hpp"

#include <utility>

namespace vantage::logs::foxglove {
namespace {

Json seconds_json(std::int64_t count_us) {
  constexpr std::int64_t kSecond_us = 1'000'000;
  std::int64_t seconds = count_us / kSecond_us;
  std::int64_t rest_us = count_us % kSecond_us;
  if (rest_us < 0) {
    --seconds;
    rest_us += kSecond_us;
  }
  return {{"sec", seconds}, {"nsec", rest_us * 1000}};
}

Json points_json(const std::vector<Eigen::Vector3d>& points) {
  Json out = Json::array();
  for (const Eigen::Vector3d& point : points) {
    out.push_back(to_json(point));
  }
  return out;
}

const Pose3 kHere;

}  // namespace

Json to_json(Time time) { return seconds_json(to_utime(time)); }
Json to_json(Duration duration) { return seconds_json(duration.count()); }
Json to_json(const Eigen::Vector3d& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }
Json to_json(const Quaternion& q) {
  return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}
Json to_json(const Pose3& pose) {
  return {{"position", to_json(pose.translation_m)}, {"orientation", to_json(pose.rotation)}};
}
Json to_json(const Colour& colour) {
  return {{"r", colour.r}, {"g", colour.g}, {"b", colour.b}, {"a", colour.a}};
}

Json entity(const std::string& id, const std::string& frame, Time time, bool is_locked) {
  Json out{{"timestamp", to_json(time)},
           {"frame_id", frame},
           {"id", id},
           {"lifetime", to_json(Duration{0})},
           {"frame_locked", is_locked}};
  for (const char* primitive : {"metadata", "arrows", "cubes", "spheres", "cylinders", "lines",
                                "triangles", "texts", "models"}) {
    out[primitive] = Json::array();
  }
  return out;
}

Json line(LineType type, const std::vector<Eigen::Vector3d>& points, double thickness_px,
          const Colour& colour) {
  return {{"type", static_cast<int>(type)}, {"pose", to_json(kHere)},
          {"thickness", thickness_px},      {"scale_invariant", true},
          {"points", points_json(points)},  {"color", to_json(colour)},
          {"colors", Json::array()},        {"indices", Json::array()}};
}

Json triangles(const std::vector<Eigen::Vector3d>& points, const Colour& colour) {
  return {{"pose", to_json(kHere)},
          {"points", points_json(points)},
          {"color", to_json(colour)},
          {"colors", Json::array()},
          {"indices", Json::array()}};
}

Json cube(const Pose3& pose, const Eigen::Vector3d& size_m, const Colour& colour) {
  return {{"pose", to_json(pose)}, {"size", to_json(size_m)}, {"color", to_json(colour)}};
}

Json cylinder(const Pose3& pose, const Eigen::Vector3d& size_m, const Colour& colour) {
  Json out = cube(pose, size_m, colour);
  out["bottom_scale"] = 1.0;
  out["top_scale"] = 1.0;
  return out;
}

Json label(const std::string& text, const Eigen::Vector3d& at_m, double size_px,
           const Colour& colour) {
  return {{"pose", to_json(Pose3{at_m, Quaternion::Identity()})},
          {"billboard", true},
          {"font_size", size_px},
          {"scale_invariant", true},
          {"color", to_json(colour)},
          {"text", text}};
}

Json scene_update(std::vector<Json> entities) {
  return {{"deletions", Json::array()}, {"entities", std::move(entities)}};
}

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t given = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      group = group << 8U | (j < given ? bytes[i + j] : 0U);
    }
    for (std::size_t j = 0; j < 4; ++j) {
      out.push_back(j <= given ? kDigits[group >> (18U - 6U * j) & 63U] : '=');
    }
  }
  return out;
}

}  // namespace vantage::logs::foxglove
