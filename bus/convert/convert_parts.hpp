#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "vantage_lcm/input_ref_t.hpp"

#include "bus/convert/convert.hpp"
#include "core/angle.hpp"
#include "core/linear.hpp"
#include "models/exchange/messages.hpp"

// Conversions that several messages share. `…_from` functions return nullopt for impossible values;
// `…_to` functions cannot fail.

namespace vantage::bus::parts {

inline constexpr std::size_t kTextBytesMax = 256;
inline constexpr std::size_t kYamlBytesMax = std::size_t{1} << 20U;
/// maximum number of targets, segments, bodies, inputs and other elements of a list
inline constexpr std::size_t kItemsMax = 10'000;
inline constexpr std::size_t kCellsMax = 1'000'000;
/// µs since 1970; latest accepted time, in the year 2286. Differences of two accepted times do not
/// overflow.
inline constexpr std::int64_t kUtimeMax = 10'000'000'000'000'000;
/// Limits of a motion: distance from the origin, duration, and rate (m/s, rad/s, m/s²). Results
/// computed from values within these limits stay finite.
inline constexpr double kPositionMax_m = 1e6;
inline constexpr double kMotionMax_s = 3600.0;
inline constexpr double kRateMax = 1e3;
/// asymmetry of a matrix, relative to its largest entry
inline constexpr double kAsymmetryMax = 1e-9;
inline constexpr double kQuaternionNormErrorMax = 1e-3;

/// Matrix of up to 4×4 without heap memory, for covariances of measurements and information of
/// targets.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, kUnaligned, 4, 4>;
using Rows = std::vector<std::vector<double>>;

bool is_utime(std::int64_t utime);
/// True if `text` is at most `bytes_max` bytes of UTF-8 without NUL.
bool is_text(const std::string& text, std::size_t bytes_max = kTextBytesMax);
/// Returns `text` in a form that is_text() accepts: converted by readable() if it is not UTF-8, and
/// truncated with a final "…" if it is too long.
std::string to_wire_text(std::string text);
/// True if the count in the message equals the number of elements and is at most `cap`.
bool is_count(std::int64_t count, std::size_t elements, std::size_t cap = kItemsMax);
template <class... Doubles>
bool are_finite(Doubles... values) {
  return (std::isfinite(values) && ...);
}

std::optional<Pose2> pose2_from(double x_m, double y_m, double yaw_rad);
std::optional<Pose3> pose3_from(const double (&position_m)[3], const double (&quaternion_wxyz)[4]);
void pose3_to(const Pose3& pose, double (&position_m)[3], double (&quaternion_wxyz)[4]);

/// Returns the matrix if it is symmetric positive definite with dim × dim entries; otherwise
/// nullopt.
std::optional<SmallMatrix> definite_from(const Rows& rows, int dim);
/// Returns the dim × dim rows of `M`. Entries that `M` does not have become NaN, which receivers
/// refuse.
Rows rows_to(const SmallMatrix& M, int dim);

std::optional<std::vector<models::InputRef>> inputs_from(
    std::int32_t count, const std::vector<vantage_lcm::input_ref_t>& wire);
std::vector<vantage_lcm::input_ref_t> inputs_to(const std::vector<models::InputRef>& inputs);

inline std::int32_t count_of(std::size_t elements) { return static_cast<std::int32_t>(elements); }

/// Returns the input references of a message that names its inputs.
template <class Wire>
auto inputs_from(const Wire& wire) {
  return inputs_from(wire.num_inputs, wire.inputs);
}
template <class Wire>
void inputs_to(const std::vector<models::InputRef>& inputs, Wire& wire) {
  wire.num_inputs = count_of(inputs.size());
  wire.inputs = inputs_to(inputs);
}

template <class Enum>
std::optional<Enum> enumerator_from(std::int32_t value, Enum last) {
  if (value < 0 || value > static_cast<std::int32_t>(last)) {
    return std::nullopt;
  }
  return static_cast<Enum>(value);
}

/// True if the byte is a valid boolean: 0 or 1.
inline bool is_boolean(std::int8_t value) { return value == 0 || value == 1; }

template <class Wire>
void stamp_to(const models::Stamp& stamp, Wire& wire) {
  wire.utime = to_utime(stamp.time);
  wire.run_id = stamp.run_id;
  wire.sequence = stamp.sequence;
}

/// Returns a message with `stamp` and otherwise empty fields.
template <class Wire>
Wire stamped(const models::Stamp& stamp) {
  Wire wire{};
  stamp_to(stamp, wire);
  return wire;
}

template <class Wire>
std::optional<models::Stamp> stamp_from(const Wire& wire) {
  if (!is_utime(wire.utime) || wire.sequence < 0) {
    return std::nullopt;
  }
  return models::Stamp{from_utime(wire.utime), wire.run_id, wire.sequence};
}

template <class Wire>
void viewpoint_to(const models::Viewpoint& from, Wire& wire) {
  wire.x_world_m = from.world_from_body.x_m;
  wire.y_world_m = from.world_from_body.y_m;
  wire.yaw_world_rad = from.world_from_body.yaw_rad;
  wire.height_m = from.height_m;
}

template <class Wire>
std::optional<models::Viewpoint> viewpoint_from(const Wire& wire) {
  const auto pose = pose2_from(wire.x_world_m, wire.y_world_m, wire.yaw_world_rad);
  if (!pose || !are_finite(wire.height_m)) {
    return std::nullopt;
  }
  return models::Viewpoint{*pose, wire.height_m};
}

template <class Wire>
void grid_to(const models::GridGeometry& grid, Wire& wire) {
  wire.grid_origin_x_m = grid.origin_m.x();
  wire.grid_origin_y_m = grid.origin_m.y();
  wire.grid_resolution_m = grid.resolution_m;
  wire.grid_columns = grid.columns;
  wire.grid_rows = grid.rows;
}

/// Returns the grid of a message that has no array with one element per cell.
template <class Wire>
std::optional<models::GridGeometry> grid_from(const Wire& wire) {
  if (!are_finite(wire.grid_origin_x_m, wire.grid_origin_y_m, wire.grid_resolution_m) ||
      wire.grid_resolution_m <= 0.0 || wire.grid_columns < 0 || wire.grid_rows < 0 ||
      std::int64_t{wire.grid_columns} * wire.grid_rows > static_cast<std::int64_t>(kCellsMax)) {
    return std::nullopt;
  }
  return models::GridGeometry{{wire.grid_origin_x_m, wire.grid_origin_y_m},
                              wire.grid_resolution_m,
                              wire.grid_columns,
                              wire.grid_rows};
}

/// Returns the grid of a message. `cells`: number of elements in each array that has one per cell.
template <class Wire>
std::optional<models::GridGeometry> grid_from(const Wire& wire, std::size_t cells) {
  const bool is_complete = is_count(wire.num_cells, cells, kCellsMax) &&
                           std::int64_t{wire.grid_columns} * wire.grid_rows == wire.num_cells;
  return is_complete ? grid_from(wire) : std::nullopt;
}

/// The common fields of beliefs and maps: the robot's step, its viewpoint, the grid and the inputs.
struct StepHead {
  models::Stamp stamp;
  models::Viewpoint viewpoint;
  models::GridGeometry grid;
  std::vector<models::InputRef> inputs;
};

template <class Wire>
std::optional<StepHead> step_head_from(const Wire& wire, std::size_t cells) {
  const auto stamp = stamp_from(wire);
  const auto viewpoint = viewpoint_from(wire);
  const auto grid = grid_from(wire, cells);
  auto inputs = inputs_from(wire);
  if (!stamp || !viewpoint || !grid || !inputs || !is_text(wire.robot) || wire.step < 0) {
    return std::nullopt;
  }
  return StepHead{*stamp, *viewpoint, *grid, std::move(*inputs)};
}

/// Returns a message with the common fields of `content` and a count of `cells`; other fields are
/// empty.
template <class Wire, class Content>
Wire with_step_head(const Content& content, std::size_t cells) {
  auto wire = stamped<Wire>(content.stamp);
  wire.robot = content.robot;
  wire.step = content.step;
  viewpoint_to(content.viewpoint, wire);
  grid_to(content.grid, wire);
  wire.num_cells = count_of(cells);
  inputs_to(content.inputs, wire);
  return wire;
}

}  // namespace vantage::bus::parts
