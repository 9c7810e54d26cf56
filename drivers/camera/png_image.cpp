#include <string>

#include <png.h>

#include "drivers/camera/image_file.hpp"

namespace vantage::drivers::camera {

Result<models::GrayImage> decode_png(std::span<const std::uint8_t> bytes) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) == 0) {
    return Error{std::string("the PNG is damaged: ") + png.message};
  }
  constexpr auto kSideMax = static_cast<png_uint_32>(models::kImageSideMax);
  if (png.width > kSideMax || png.height > kSideMax) {
    png_image_free(&png);
    return Error{"the PNG is larger than " + std::to_string(models::kImageSideMax) +
                 " pixels per side"};
  }
  png.format = PNG_FORMAT_GRAY;
  models::GrayImage out{static_cast<int>(png.width), static_cast<int>(png.height),
                        std::vector<std::uint8_t>(PNG_IMAGE_SIZE(png))};
  constexpr png_color kBlack{};  // background of transparent pixels
  if (png_image_finish_read(&png, &kBlack, out.pixels.data(), 0, nullptr) == 0) {
    return Error{std::string("the PNG is damaged: ") + png.message};
  }
  return out;
}

}  // namespace vantage::drivers::camera
