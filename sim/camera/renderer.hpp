#pragma once

#include <optional>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "models/camera/camera_model.hpp"
#include "models/camera/image.hpp"
#include "sim/camera/tag_pattern.hpp"

namespace vantage::sim {

/// Printed tag in the world. Tag frame: x right, y up, z out of the tag, origin at its centre.
struct PlacedTag {
  TagPattern pattern;
  double size_m = 0.16;  ///< side of the black square
  Pose3 world_from_tag;
};

/// Imperfections of a simulated image.
struct ImageQuality {
  double blur_sigma_pixels = 0.5;  ///< 1σ of a Gaussian point spread; 0: none
  double noise_sigma = 2.0;        ///< 1σ of each pixel, in grey levels of 255
  double black = 35.0;             ///< grey level of printed black
  double white = 215.0;            ///< grey level of paper
  double shade_share = 0.2;        ///< loss of brightness from the centre to the corners
};

/// Software renderer for tags above a tiled floor at z = 0. Pixels on tags are averages over 16
/// points (anti-aliasing). Nearer tags hide farther ones.
class TagRenderer {
 public:
  /// Precondition: is_invertible(camera).
  explicit TagRenderer(const models::CameraModel& camera);

  /// Returns the image. It depends on the arguments and the state of `rng` only.
  [[nodiscard]] models::GrayImage render(const Pose3& world_from_camera,
                                         const std::vector<PlacedTag>& tags,
                                         const ImageQuality& quality, std::mt19937_64& rng) const;

 private:
  struct Box {
    int column_begin = 0;
    int column_end = 0;
    int row_begin = 0;
    int row_end = 0;
  };
  /// Tag in the frame of the camera, prepared for intersections with rays.
  struct Board {
    const TagPattern* pattern = nullptr;
    Eigen::Matrix3d tag_from_camera;
    Eigen::Vector3d camera_in_tag_m;  ///< position of the camera in the tag's frame
    double cell_m = 0.0;
    double half_m = 0.0;  ///< half the side length of the tag including its margin
  };
  static Board board_of(const PlacedTag& tag, const Pose3& tag_from_camera);
  /// Returns the printed grey level where the ray meets the board; nullopt if the ray misses the
  /// board or meets its back.
  static std::optional<double> meet(const Board& board, const Eigen::Vector2d& ratio,
                                    const ImageQuality& quality);
  void draw(const Board& board, const Box& box, const ImageQuality& quality,
            std::vector<double>& levels) const;
  /// Returns x / z and y / z of the ray through the pixel (column + right, row + down). `right` and
  /// `down` are from −0.5 to 0.5.
  [[nodiscard]] Eigen::Vector2d ratio_at(int column, int row, double right, double down) const;
  [[nodiscard]] std::vector<double> floor(const Pose3& world_from_camera) const;
  [[nodiscard]] Box box_of(const Pose3& camera_from_tag, double half_m) const;

  models::CameraModel camera_;
  /// x / z and y / z of the rays through the pixels' centres, with one more pixel on each side.
  std::vector<Eigen::Vector2d> ratios_;
};

}  // namespace vantage::sim
