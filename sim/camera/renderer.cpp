#include "sim/camera/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/check.hpp"

namespace vantage::sim {
namespace {

constexpr int kSamplesPerSide = 4;  // sampled points along each side of a pixel
constexpr int kOutlinePoints = 16;  // points per side of a tag, for its bounding box in the image
constexpr double kTileSide_m = 0.5;
constexpr double kTileDarkest = 70.0;
constexpr double kTileBrightest = 150.0;
constexpr double kFarWall = 120.0;  // grey level above the horizon

/// Returns a grey level that depends on the tile only.
double tile_level(double x_m, double y_m) {
  const auto column =
      static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(x_m / kTileSide_m)));
  const auto row =
      static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(y_m / kTileSide_m)));
  std::uint64_t mixed = column * 0x9E3779B97F4A7C15U + row * 0xC2B2AE3D27D4EB4FU;
  mixed ^= mixed >> 29U;
  mixed *= 0xBF58476D1CE4E5B9U;
  mixed ^= mixed >> 32U;
  return kTileDarkest +
         (kTileBrightest - kTileDarkest) * static_cast<double>(mixed % 1024) / 1023.0;
}

/// Convolves the rows of `image` with a Gaussian and transposes it.
std::vector<double> blur_rows(const std::vector<double>& image, int width, int height,
                              double sigma_pixels) {
  const int reach = std::max(1, static_cast<int>(std::ceil(3.0 * sigma_pixels)));
  std::vector<double> weights;
  double sum = 0.0;
  for (int i = -reach; i <= reach; ++i) {
    weights.push_back(std::exp(-0.5 * i * i / (sigma_pixels * sigma_pixels)));
    sum += weights.back();
  }
  std::vector<double> out(image.size());
  for (int row = 0; row < height; ++row) {
    const double* const from = image.data() + static_cast<std::ptrdiff_t>(row) * width;
    for (int column = 0; column < width; ++column) {
      double value = 0.0;
      for (int i = -reach; i <= reach; ++i) {
        value += weights[static_cast<std::size_t>(i + reach)] *
                 from[std::clamp(column + i, 0, width - 1)];
      }
      out[static_cast<std::size_t>(column) * static_cast<std::size_t>(height) +
          static_cast<std::size_t>(row)] = value / sum;
    }
  }
  return out;
}

/// Adds shade and noise, and rounds to grey levels.
models::GrayImage expose(const std::vector<double>& levels, const models::CameraModel& camera,
                         const ImageQuality& quality, std::mt19937_64& rng) {
  models::GrayImage out{camera.width, camera.height, std::vector<std::uint8_t>(levels.size())};
  std::normal_distribution<double> noise(0.0, 1.0);
  const double corner2 = 0.25 * (static_cast<double>(camera.width) * camera.width +
                                 static_cast<double>(camera.height) * camera.height);
  std::size_t i = 0;
  for (int row = 0; row < camera.height; ++row) {
    const double dy = row - 0.5 * (camera.height - 1);
    for (int column = 0; column < camera.width; ++column, ++i) {
      const double dx = column - 0.5 * (camera.width - 1);
      const double light = 1.0 - quality.shade_share * (dx * dx + dy * dy) / corner2;
      const double level = levels[i] * light + quality.noise_sigma * noise(rng);
      out.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(level), 0L, 255L));
    }
  }
  return out;
}

}  // namespace

TagRenderer::TagRenderer(const models::CameraModel& camera) : camera_(camera) {
  const auto ratio_of = [&](double column, double row) {
    const auto ratio = models::undistort(camera, {column, row});
    demand(ratio.has_value(), "the camera's distortion must be invertible in the whole image");
    return *ratio;
  };
  ratios_.reserve(static_cast<std::size_t>(camera.width + 2) *
                  static_cast<std::size_t>(camera.height + 2));
  for (int row = -1; row <= camera.height; ++row) {
    for (int column = -1; column <= camera.width; ++column) {
      // The pixels around the image are needed for interpolation at its border. They are
      // extrapolated, because the distortion may not be invertible there.
      const double inner_column = std::clamp(column, 0, camera.width - 1);
      const double inner_row = std::clamp(row, 0, camera.height - 1);
      const Eigen::Vector2d inner = ratio_of(inner_column, inner_row);
      const Eigen::Vector2d edge = ratio_of(0.5 * (column + inner_column), 0.5 * (row + inner_row));
      ratios_.emplace_back(2.0 * edge - inner);
    }
  }
}

Eigen::Vector2d TagRenderer::ratio_at(int column, int row, double right, double down) const {
  const int left_column = right < 0.0 ? column - 1 : column;
  const int upper_row = down < 0.0 ? row - 1 : row;
  const double u = right < 0.0 ? right + 1.0 : right;
  const double v = down < 0.0 ? down + 1.0 : down;
  const auto stride = static_cast<std::size_t>(camera_.width + 2);
  const std::size_t at =
      static_cast<std::size_t>(upper_row + 1) * stride + static_cast<std::size_t>(left_column + 1);
  return (1.0 - v) * ((1.0 - u) * ratios_[at] + u * ratios_[at + 1]) +
         v * ((1.0 - u) * ratios_[at + stride] + u * ratios_[at + stride + 1]);
}

std::vector<double> TagRenderer::floor(const Pose3& world_from_camera) const {
  const Eigen::Matrix3d turn = world_from_camera.rotation.toRotationMatrix();
  const Eigen::Vector3d at_m = world_from_camera.translation_m;
  std::vector<double> out;
  out.reserve(static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height));
  const auto stride = static_cast<std::size_t>(camera_.width + 2);
  for (int row = 0; row < camera_.height; ++row) {
    for (int column = 0; column < camera_.width; ++column) {
      const Eigen::Vector2d ratio = ratios_[static_cast<std::size_t>(row + 1) * stride +
                                            static_cast<std::size_t>(column + 1)];
      const Eigen::Vector3d ray = turn * Eigen::Vector3d(ratio.x(), ratio.y(), 1.0);
      constexpr double kFarthest_m = 100.0;
      const double depth = -at_m.z() / ray.z();
      const bool meets_floor = depth > 0.0 && depth < kFarthest_m;
      out.push_back(meets_floor ? tile_level(at_m.x() + depth * ray.x(), at_m.y() + depth * ray.y())
                                : kFarWall);
    }
  }
  return out;
}

TagRenderer::Box TagRenderer::box_of(const Pose3& camera_from_tag, double half_m) const {
  Box box{camera_.width, 0, camera_.height, 0};
  const auto include = [&](double x, double y) {
    const auto seen = models::project(camera_, camera_from_tag * Eigen::Vector3d(x, y, 0.0));
    if (!seen || !seen->pixel.allFinite()) {
      box = {0, camera_.width, 0, camera_.height};  // partly behind the camera: test every pixel
      return;
    }
    const auto column = [&](double value) {
      return static_cast<int>(std::clamp(value, 0.0, camera_.width + 0.0));
    };
    const auto row = [&](double value) {
      return static_cast<int>(std::clamp(value, 0.0, camera_.height + 0.0));
    };
    box.column_begin = std::min(box.column_begin, column(seen->pixel.x() - 2.0));
    box.column_end = std::max(box.column_end, column(seen->pixel.x() + 3.0));
    box.row_begin = std::min(box.row_begin, row(seen->pixel.y() - 2.0));
    box.row_end = std::max(box.row_end, row(seen->pixel.y() + 3.0));
  };
  for (int i = 0; i <= kOutlinePoints; ++i) {
    const double at = half_m * (2.0 * i / kOutlinePoints - 1.0);
    include(at, -half_m);
    include(at, half_m);
    include(-half_m, at);
    include(half_m, at);
  }
  return box;
}

/// Returns the printed grey level where the ray meets the board; nullopt if the ray misses the
/// board or meets its back.
std::optional<double> TagRenderer::meet(const Board& board, const Eigen::Vector2d& ratio,
                                        const ImageQuality& quality) {
  const Eigen::Vector3d ray = board.tag_from_camera * Eigen::Vector3d(ratio.x(), ratio.y(), 1.0);
  if (!(ray.z() < 0.0) || !(board.camera_in_tag_m.z() > 0.0)) {
    return std::nullopt;
  }
  const double depth = -board.camera_in_tag_m.z() / ray.z();
  const Eigen::Vector2d at_m = board.camera_in_tag_m.head<2>() + depth * ray.head<2>();
  if (!(std::abs(at_m.x()) < board.half_m) || !(std::abs(at_m.y()) < board.half_m)) {
    return std::nullopt;
  }
  const int last = board.pattern->cells_per_side - 1;
  const int column = std::min(last, static_cast<int>((at_m.x() + board.half_m) / board.cell_m));
  const int row = std::min(last, static_cast<int>((board.half_m - at_m.y()) / board.cell_m));
  const auto cell = static_cast<std::size_t>(row * board.pattern->cells_per_side + column);
  return board.pattern->is_white[cell] != 0 ? quality.white : quality.black;
}

TagRenderer::Board TagRenderer::board_of(const PlacedTag& tag, const Pose3& tag_from_camera) {
  Board out;
  out.pattern = &tag.pattern;
  out.tag_from_camera = tag_from_camera.rotation.toRotationMatrix();
  out.camera_in_tag_m = tag_from_camera.translation_m;
  out.cell_m = tag.size_m / tag.pattern.border_per_side;
  out.half_m = 0.5 * out.cell_m * tag.pattern.cells_per_side;
  return out;
}

void TagRenderer::draw(const Board& board, const Box& box, const ImageQuality& quality,
                       std::vector<double>& levels) const {
  constexpr int kSamples = kSamplesPerSide * kSamplesPerSide;
  for (int row = box.row_begin; row < box.row_end; ++row) {
    for (int column = box.column_begin; column < box.column_end; ++column) {
      double sum = 0.0;
      int hits = 0;
      for (int sample = 0; sample < kSamples; ++sample) {
        const double right = (sample % kSamplesPerSide + 0.5) / kSamplesPerSide - 0.5;
        const double down = (sample / kSamplesPerSide + 0.5) / kSamplesPerSide - 0.5;
        if (const auto level = meet(board, ratio_at(column, row, right, down), quality)) {
          sum += *level;
          ++hits;
        }
      }
      double& level =
          levels[static_cast<std::size_t>(row) * static_cast<std::size_t>(camera_.width) +
                 static_cast<std::size_t>(column)];
      level = (sum + (kSamples - hits) * level) / kSamples;
    }
  }
}

models::GrayImage TagRenderer::render(const Pose3& world_from_camera,
                                      const std::vector<PlacedTag>& tags,
                                      const ImageQuality& quality, std::mt19937_64& rng) const {
  std::vector<double> levels = floor(world_from_camera);
  std::vector<std::pair<double, const PlacedTag*>> by_distance;
  for (const PlacedTag& tag : tags) {
    by_distance.emplace_back(
        (tag.world_from_tag.translation_m - world_from_camera.translation_m).norm(), &tag);
  }
  std::stable_sort(by_distance.begin(), by_distance.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [distance_m, tag] : by_distance) {
    const Pose3 tag_from_camera = inverse(tag->world_from_tag) * world_from_camera;
    const Pose3 camera_from_tag = inverse(tag_from_camera);
    const Board board = board_of(*tag, tag_from_camera);
    const double reach_m = 2.0 * board.half_m;
    if (camera_from_tag.translation_m.z() > -reach_m) {  // else it is behind the camera
      draw(board, box_of(camera_from_tag, board.half_m), quality, levels);
    }
  }
  if (quality.blur_sigma_pixels > 0.0) {
    levels = blur_rows(blur_rows(levels, camera_.width, camera_.height, quality.blur_sigma_pixels),
                       camera_.height, camera_.width, quality.blur_sigma_pixels);
  }
  return expose(levels, camera_, quality, rng);
}

}  // namespace vantage::sim
