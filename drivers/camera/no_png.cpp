#include "drivers/camera/image_file.hpp"

namespace vantage::drivers::camera {

Result<models::GrayImage> decode_png(std::span<const std::uint8_t> /*bytes*/) {
  return Error{
      "this program was built without the PNG library: install libpng-dev and build again, or "
      "convert the image to PGM"};
}

}  // namespace vantage::drivers::camera
