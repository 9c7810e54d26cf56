#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <unistd.h>

#include "core/check.hpp"
#include "models/camera/image.hpp"
#include "scenario/reader/camera_yaml.hpp"
#include "scenario/reader/localizer_yaml.hpp"
#include "scenario/reader/text_file.hpp"
#include "scenario/reader/yaml_document.hpp"

namespace vantage::scenario {
namespace {

constexpr std::size_t kTagsMax = 1000;
constexpr int kTagNumberMax = 100'000;
constexpr int kBodyIdMax = 1'000'000;
constexpr double kOffsetMaxM = 10.0;
constexpr double kFocalMaxPixels = 1e5;
constexpr double kCoefficientMax = 1e3;
constexpr int kImageSideMin = 32;

/// Returns the value under `key` of a mapping; nullopt if it is absent or `parent` has no keys.
std::optional<Value> value_under(const Value& parent, std::string_view key) {
  const Node& node = *parent.node;
  const std::size_t entries = node.kind == Node::Kind::kMapping ? node.entry_count() : 0;
  for (std::size_t entry = 0; entry < entries; ++entry) {
    if (node.key(entry).text == key) {
      const std::string path = parent.path.empty() ? "" : parent.path + ".";
      return child_of(parent, path + std::string(key), node.key(entry), node.value(entry));
    }
  }
  return std::nullopt;
}

/// Returns the mapping under `keys` of each layer that has it.
std::vector<Value> values_under(std::vector<Value> layers,
                                std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    std::vector<Value> next;
    for (const Value& layer : layers) {
      if (std::optional<Value> found = value_under(layer, key)) {
        next.push_back(*std::move(found));
      }
    }
    layers = std::move(next);
  }
  return layers;
}

void declare_all(Mapping& from, const Node& node) {
  for (std::size_t entry = 0; entry < node.entry_count(); ++entry) {
    from.declare({node.key(entry).text});
  }
}

/// Returns the numbers of a matrix: a mapping with `rows`, `cols` and `data`, or a plain list.
std::vector<double> numbers_of(const Value& matrix, std::size_t count_min, std::size_t count_max,
                               std::string_view shape) {
  Value data = matrix;
  if (matrix.node->kind == Node::Kind::kMapping) {
    const std::optional<Value> list = value_under(matrix, "data");
    if (!list) {
      matrix.refuse("has no key data; expected " + std::string(shape));
    }
    data = *list;
    const std::optional<Value> rows = value_under(matrix, "rows");
    const std::optional<Value> cols = value_under(matrix, "cols");
    if (rows && cols) {
      constexpr std::int64_t kRowsMax = 100;
      const std::int64_t cells = rows->integer(1, kRowsMax) * cols->integer(1, kRowsMax);
      if (cells != std::ssize(data.items())) {
        data.refuse(fmt::format("must contain rows · cols = {} numbers, contains {}", cells,
                                data.items().size()));
      }
    }
  }
  const std::vector<Value> items = data.items();
  if (items.size() < count_min || items.size() > count_max) {
    data.refuse(fmt::format("must contain {}, contains {} numbers", shape, items.size()));
  }
  std::vector<double> out;
  for (const Value& item : items) {
    out.push_back(item.number(from_to(-kFocalMaxPixels, kFocalMaxPixels)));
  }
  return out;
}

void read_matrix(Mapping& from, models::CameraModel& camera) {
  const std::optional<Value> value = from.find_required("camera_matrix");
  if (!value) {
    return;
  }
  const std::vector<double> k =
      numbers_of(*value, 9, 9, "nine numbers [fx, 0, cx, 0, fy, cy, 0, 0, 1]");
  const bool has_form = k[1] == 0.0 && k[3] == 0.0 && k[6] == 0.0 && k[7] == 0.0 && k[8] == 1.0;
  if (!has_form) {
    value->refuse("must have the form [fx, 0, cx, 0, fy, cy, 0, 0, 1]");
  }
  if (!(k[0] >= 1.0 && k[4] >= 1.0)) {
    value->refuse(fmt::format("fx and fy must be at least 1 pixel, are {} and {}", k[0], k[4]));
  }
  const bool has_center =
      k[2] > 0.0 && k[2] < camera.width - 1.0 && k[5] > 0.0 && k[5] < camera.height - 1.0;
  if (!has_center) {
    value->refuse(
        fmt::format("the principal point ({}, {}) must be inside the image of {} x {} pixels: the "
                    "calibration belongs to images of another size; calibrate at this size",
                    k[2], k[5], camera.width, camera.height));
  }
  camera.focal_x_pixels = k[0];
  camera.focal_y_pixels = k[4];
  camera.center_x_pixels = k[2];
  camera.center_y_pixels = k[5];
}

void read_distortion(Mapping& from, models::CameraModel& camera) {
  enum class Distortion { kPlumbBob };
  Distortion model = Distortion::kPlumbBob;
  from.choice("distortion_model", model, {{"plumb_bob", Distortion::kPlumbBob}});
  const std::optional<Value> value = from.find_required("distortion_coefficients");
  if (!value) {
    return;
  }
  const std::vector<double> d =
      numbers_of(*value, 4, 5, "four or five numbers [k1, k2, p1, p2, k3]");
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (std::abs(d[i]) > kCoefficientMax) {
      value->refuse(
          fmt::format("each coefficient must be at most {} in size, is {}", kCoefficientMax, d[i]));
    }
    camera.distortion[i] = d[i];
  }
  if (!models::is_invertible(camera)) {
    value->refuse(
        "the coefficients fold the image: two directions have the same pixel within the image; "
        "calibrate again with views of the pattern at the borders of the image");
  }
}

void read_calibration(Mapping& from, models::CameraModel& camera) {
  from.require("image_width");
  from.require("image_height");
  from.integer("image_width", camera.width, kImageSideMin, models::kImageSideMax);
  from.integer("image_height", camera.height, kImageSideMin, models::kImageSideMax);
  read_matrix(from, camera);
  read_distortion(from, camera);
}

void read_extrinsics(Mapping& from, Pose3& body_from_camera) {
  double pan_rad = 0.0;
  double tilt_rad = 0.0;
  double roll_rad = 0.0;
  from.number("x_m", body_from_camera.translation_m.x(), from_to(-kOffsetMaxM, kOffsetMaxM));
  from.number("y_m", body_from_camera.translation_m.y(), from_to(-kOffsetMaxM, kOffsetMaxM));
  from.number("z_m", body_from_camera.translation_m.z(), from_to(-kOffsetMaxM, kOffsetMaxM));
  from.angle("pan", pan_rad, from_to(-180.0, 180.0));
  from.angle("tilt", tilt_rad, from_to(-90.0, 90.0));
  from.angle("roll", roll_rad, from_to(-180.0, 180.0));
  Eigen::Matrix3d forward;   // camera that looks along the body's x axis
  forward << 0.0, 0.0, 1.0,  //
      -1.0, 0.0, 0.0,        //
      0.0, -1.0, 0.0;
  body_from_camera.rotation = Eigen::AngleAxisd(pan_rad, Eigen::Vector3d::UnitZ()) *
                              Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitY()) *
                              Eigen::Quaterniond(forward) *
                              Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ());
  body_from_camera.rotation.normalize();
}

void read_tag(Mapping& from, TagSpec& tag) {
  from.require("id");
  from.require("size_m");
  from.integer("id", tag.id, 0, kTagNumberMax);
  from.number("size_m", tag.size_m, from_to(0.001, kOffsetMaxM));
  from.number("height_m", tag.height_m, from_to(-kOffsetMaxM, kOffsetMaxM));
  int carriers = 0;
  if (from.find("target")) {
    ++carriers;
    tag.carrier = TagCarrier::kTarget;
    from.text("target", tag.body);
  }
  if (from.find("landmark")) {
    ++carriers;
    tag.carrier = TagCarrier::kLandmark;
    from.integer("landmark", tag.body_id, 0, kBodyIdMax);
  }
  if (from.find("robot")) {
    ++carriers;
    tag.carrier = TagCarrier::kRobot;
    from.text("robot", tag.body);
  }
  if (carriers != 1) {
    from.refuse("id",
                fmt::format("tag {} must have exactly one of target, landmark and robot", tag.id));
  }
}

void read_tags(Mapping& from, CameraSpec& camera) {
  const std::optional<Value> list = from.find_required("tags");
  if (!list) {
    return;
  }
  std::set<int> ids;
  for (const Value& item : list->items()) {
    if (camera.tags.size() == kTagsMax) {
      item.refuse(fmt::format("too many tags; at most {} are allowed", kTagsMax));
    }
    TagSpec tag;
    read_mapping({item}, [&](Mapping& one) { read_tag(one, tag); });
    if (!ids.insert(tag.id).second) {
      item.refuse(fmt::format("id must be unique; an earlier tag has the id {}", tag.id));
    }
    camera.tags.push_back(std::move(tag));
  }
}

void read_source(Mapping& from, std::string& source) {
  from.require("source");
  from.text("source", source);
  const std::string_view text = source;
  const auto names_something = [&](std::string_view kind) {
    return text.starts_with(kind) && text.size() > kind.size();
  };
  if (!text.empty() && !names_something(kFolderSource) && !names_something(kV4l2Source) &&
      text != kSimulatedSource) {
    from.refuse("source", "must be folder:PATH, v4l2:DEVICE or simulated, is '" + source + "'");
  }
}

/// Sets the ids of the bodies that carry the tags. `list`: the tags in the file.
void resolve_tags(const Value& list, const Scenario& scenario,
                  const std::optional<LocalizerSpec>& localizer, std::vector<TagSpec>& tags) {
  const std::vector<Value> items = list.items();
  for (std::size_t i = 0; i < tags.size(); ++i) {
    TagSpec& tag = tags[i];
    if (tag.carrier == TagCarrier::kTarget) {
      const auto found = std::find_if(scenario.targets.begin(), scenario.targets.end(),
                                      [&](const auto& each) { return each.name == tag.body; });
      if (found == scenario.targets.end()) {
        items[i].refuse("target must be the name of a target, is '" + tag.body + "'");
      }
      tag.body_id = found->id;
    } else if (tag.carrier == TagCarrier::kLandmark) {
      const bool is_known =
          localizer && std::any_of(localizer->landmarks.begin(), localizer->landmarks.end(),
                                   [&](const auto& each) { return each.id == tag.body_id; });
      if (!is_known) {
        items[i].refuse(fmt::format("landmark must be the id of one of localizer.landmarks, is {}",
                                    tag.body_id));
      }
    } else {
      const auto* const robots = localizer ? &localizer->robots : nullptr;
      const auto found =
          robots == nullptr ? std::vector<LocalizedRobotSpec>::const_iterator{}
                            : std::find_if(robots->begin(), robots->end(),
                                           [&](const auto& each) { return each.name == tag.body; });
      if (robots == nullptr || found == robots->end()) {
        items[i].refuse("robot must be the name of one of localizer.robots, is '" + tag.body + "'");
      }
      tag.body_id = found->id;
    }
  }
}

/// Returns the layers of the section `sensor` of robot number `i`.
std::vector<Value> sensor_layers(const Value& document, std::size_t i) {
  std::vector<Value> layers;
  if (const std::optional<Value> robots = value_under(document, "robots")) {
    layers.push_back(robots->items().at(i));
  }
  if (std::optional<Value> defaults = value_under(document, "robot_defaults")) {
    layers.push_back(*std::move(defaults));
  }
  return values_under(std::move(layers), {"sensor"});
}

bool is_camera(const std::vector<Value>& sensor) {
  const std::vector<Value> devices = values_under(sensor, {"device"});
  return !devices.empty() && devices.front().node->text == "camera";
}

/// Refuses a camera of a robot if the robot's detections come from ROS 2.
void check_only_detector(const Value& document, const Value& sensor, const std::string& robot) {
  const std::vector<Value> lists = values_under({document}, {"ros2", "detections"});
  for (const Value& input : lists.empty() ? std::vector<Value>() : lists.front().items()) {
    const std::optional<Value> name = value_under(input, "robot");
    if (name && name->node->text == robot) {
      sensor.refuse("device must be external for " + robot +
                    ", because ros2.detections provides its detections; otherwise two processes "
                    "would publish the same channel");
    }
  }
}

/// Refuses sensors and objectives that need more than the positions of identified targets.
void check_purpose(const Value& sensor, const Scenario& scenario, const RobotSpec& robot) {
  if (models::measures_velocity(robot.sensor)) {
    sensor.refuse(
        fmt::format("kind must be one without velocities with device: camera, which "
                    "measures positions; is {}",
                    robot.sensor.kind.name()));
  }
  if (!robot.detection.detects_ids) {
    sensor.refuse("detects_ids must be true with device: camera: tags identify their targets");
  }
  if (scenario.planner.objective == PlanObjective::kMapping) {
    sensor.refuse(
        "device must be vantage or external with planner.objective: mapping, because a "
        "camera measures no ranges of obstacles");
  }
}

std::vector<CameraSpec> read_cameras(const Value& document, const Scenario& scenario,
                                     const std::optional<LocalizerSpec>& localizer) {
  std::vector<CameraSpec> out;
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const std::vector<Value> sensor = sensor_layers(document, i);
    if (!is_camera(sensor)) {
      continue;
    }
    const std::vector<Value> layers = values_under(sensor, {"camera"});
    if (layers.empty()) {
      sensor.front().refuse("device: camera needs a section `camera` (docs/guide/camera.md)");
    }
    CameraSpec camera;
    read_mapping(layers, [&](Mapping& from) { read_camera(from, camera); });
    camera.robot = scenario.robots[i].name;
    camera.simulated_folder =
        fmt::format("/dev/shm/vantage-camera-{}/{}-{}", ::geteuid(), scenario.name, camera.robot);
    check_only_detector(document, sensor.front(), camera.robot);
    check_purpose(sensor.front(), scenario, scenario.robots[i]);
    if (const std::vector<Value> lists = values_under(layers, {"tags"}); !lists.empty()) {
      resolve_tags(lists.front(), scenario, localizer, camera.tags);
    }
    out.push_back(std::move(camera));
  }
  return out;
}

}  // namespace

void read_camera(Mapping& from, CameraSpec& camera) {
  read_source(from, camera.source);
  if (const std::optional<Value> calibration = from.find_required("calibration")) {
    if (calibration->node->kind == Node::Kind::kMapping) {
      read_mapping({*calibration}, [&](Mapping& each) {
        read_calibration(each, camera.inline_calibration.emplace());
      });
    } else {
      camera.calibration_file = calibration->text();
    }
  }
  std::vector<std::pair<std::string_view, std::string>> families;
  for (const char* family : kTagFamilies) {
    families.emplace_back(family, family);
  }
  from.choice("family", camera.family, families);
  from.require("body_from_camera");
  from.section("body_from_camera",
               [&](Mapping& each) { read_extrinsics(each, camera.body_from_camera); });
  from.number("rate_hz", camera.rate_hz, from_to(0.0, 1000.0));
  from.number("corner_sigma_pixels", camera.corner_sigma_pixels, from_to(0.001, 100.0));
  from.angle("attitude_sigma", camera.attitude_sigma_rad, from_to(0.0, 30.0));
  from.number("exposure_s", camera.exposure_s, from_to(0.0, 1.0));
  from.number("readout_s", camera.readout_s, from_to(0.0, 1.0));
  from.integer("hamming_max", camera.hamming_max, 0, 2);
  read_tags(from, camera);
}

void check_cameras(const Value& document, const Scenario& scenario,
                   const std::optional<LocalizerSpec>& localizer) {
  static_cast<void>(read_cameras(document, scenario, localizer));
}

std::vector<CameraSpec> cameras_of(const Scenario& scenario) {
  if (scenario.source_text.empty()) {
    return {};  // the scenario was not read from a file
  }
  const Value document = parse_yaml(scenario.source_text, scenario.name);
  const bool has_localizer = value_under(document, "localizer").has_value();
  return read_cameras(
      document, scenario,
      has_localizer ? parse_localizer(scenario.source_text, scenario.name) : std::nullopt);
}

std::optional<CameraSpec> camera_of(const Scenario& scenario, const std::string& robot) {
  for (CameraSpec& camera : cameras_of(scenario)) {
    if (camera.robot == robot) {
      return std::move(camera);
    }
  }
  return std::nullopt;
}

models::CameraModel parse_calibration(const std::string& yaml, const std::string& name) {
  const Value document = parse_yaml(yaml, name);
  models::CameraModel camera;
  read_mapping({document}, [&](Mapping& from) {
    declare_all(from, *document.node);
    read_calibration(from, camera);
  });
  return camera;
}

models::CameraModel calibration_of(const CameraSpec& camera) {
  return camera.inline_calibration
             ? *camera.inline_calibration
             : parse_calibration(read_text_file(camera.calibration_file), camera.calibration_file);
}

}  // namespace vantage::scenario
