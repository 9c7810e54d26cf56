#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace vantage::models {

/// Grey image. Rows are stored from top to bottom without gaps.
struct GrayImage {
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
  std::vector<std::uint8_t> pixels;

  [[nodiscard]] std::uint8_t at(int column, int row) const {
    return pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)];
  }
};

/// Largest width and height of an image.
inline constexpr int kImageSideMax = 8192;

}  // namespace vantage::models
