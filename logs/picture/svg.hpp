#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace vantage::logs {

/// Builder of an SVG document in page pixels, x right, y down. Numbers have two decimals; text is
/// escaped.
class Svg {
 public:
  Svg(double width_px, double height_px);

  /// `style` is any list of attributes, for example `fill="none" stroke="#000"`.
  void rectangle(const Eigen::Vector2d& corner_px, const Eigen::Vector2d& size_px,
                 std::string_view style);
  void circle(const Eigen::Vector2d& centre_px, double radius_px, std::string_view style);
  /// Half axes are along page x and y before the rotation by `angle_deg` (clockwise on the page).
  void ellipse(const Eigen::Vector2d& centre_px, const Eigen::Vector2d& half_axes_px,
               double angle_deg, std::string_view style);
  void line(const Eigen::Vector2d& from_px, const Eigen::Vector2d& to_px, std::string_view style);
  void polyline(const std::vector<Eigen::Vector2d>& points_px, std::string_view style);
  void polygon(const std::vector<Eigen::Vector2d>& points_px, std::string_view style);
  void text(const Eigen::Vector2d& baseline_px, std::string_view words, std::string_view style);
  /// Applies `style` to everything until close_group().
  void open_group(std::string_view style);
  void close_group();
  /// Clips everything until close_group() to the rectangle.
  void open_clip(const Eigen::Vector2d& corner_px, const Eigen::Vector2d& size_px);

  /// Returns the complete document with the content so far.
  [[nodiscard]] std::string str() const;

 private:
  void points_element(std::string_view element, const std::vector<Eigen::Vector2d>& points_px,
                      std::string_view style);
  std::string body_;
  int clips_ = 0;
};

/// Returns `text` with the five characters that XML reserves written as entities.
std::string escape_xml(std::string_view text);

}  // namespace vantage::logs
