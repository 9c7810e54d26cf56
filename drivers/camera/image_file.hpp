#pragma once

#include <cstdint>
#include <span>

#include "core/result.hpp"
#include "models/camera/image.hpp"

namespace vantage::drivers::camera {

/// Decodes a binary PGM (P5, 8 or 16 bits) or a PNG; colours become grey. An error states why the
/// bytes cannot be decoded; the largest image has kImageSideMax pixels per side.
Result<models::GrayImage> decode_image(std::span<const std::uint8_t> bytes);

/// Decodes a PNG; an error if the program was built without the PNG library.
Result<models::GrayImage> decode_png(std::span<const std::uint8_t> bytes);

}  // namespace vantage::drivers::camera
