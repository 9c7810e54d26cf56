#include "drivers/camera/image_file.hpp"

#include <cctype>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>

namespace vantage::drivers::camera {
namespace {

constexpr int kLevelMax16 = 65535;

/// Reader of the header of a PGM.
class Header {
 public:
  explicit Header(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  /// Returns the next number, at most `max`; skips spaces and comments before it.
  std::optional<int> number(int max) {
    skip();
    int value = 0;
    std::size_t digits = 0;
    for (; at_ < bytes_.size() && std::isdigit(bytes_[at_]) != 0; ++at_, ++digits) {
      value = 10 * value + (bytes_[at_] - '0');
      if (value > max) {
        return std::nullopt;
      }
    }
    return digits > 0 ? std::optional(value) : std::nullopt;
  }
  [[nodiscard]] std::size_t at() const { return at_; }

 private:
  void skip() {
    while (at_ < bytes_.size() && (std::isspace(bytes_[at_]) != 0 || bytes_[at_] == '#')) {
      const bool is_comment = bytes_[at_] == '#';
      ++at_;
      while (is_comment && at_ < bytes_.size() && bytes_[at_] != '\n') {
        ++at_;
      }
    }
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 2;
};

Result<models::GrayImage> decode_pgm(std::span<const std::uint8_t> bytes) {
  Header header(bytes);
  const std::optional<int> width = header.number(models::kImageSideMax);
  const std::optional<int> height = width ? header.number(models::kImageSideMax) : std::nullopt;
  const std::optional<int> level_max = height ? header.number(kLevelMax16) : std::nullopt;
  if (!level_max || *width == 0 || *height == 0 || *level_max == 0) {
    return Error{"the header of the PGM is damaged, or the image is larger than " +
                 std::to_string(models::kImageSideMax) + " pixels per side"};
  }
  const std::size_t begin = header.at() + 1;
  const std::size_t count = static_cast<std::size_t>(*width) * static_cast<std::size_t>(*height);
  const bool is_wide = *level_max > 255;
  const std::size_t needed = count * (is_wide ? 2 : 1);
  if (begin > bytes.size() || bytes.size() - begin < needed) {
    return Error{"the PGM is truncated: " + std::to_string(needed) + " bytes of pixels expected"};
  }
  models::GrayImage out{*width, *height, std::vector<std::uint8_t>(count)};
  if (!is_wide && *level_max == 255) {
    std::memcpy(out.pixels.data(), bytes.data() + begin, count);
    return out;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = begin + i * (is_wide ? 2 : 1);
    const int level = is_wide ? bytes[at] * 256 + bytes[at + 1] : bytes[at];
    out.pixels[i] = static_cast<std::uint8_t>(std::min(level, *level_max) * 255 / *level_max);
  }
  return out;
}

}  // namespace

Result<models::GrayImage> decode_image(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t kPng[] = {0x89, 'P', 'N', 'G'};
  if (bytes.size() > 2 && bytes[0] == 'P' && bytes[1] == '5') {
    return decode_pgm(bytes);
  }
  if (bytes.size() > sizeof kPng && std::memcmp(bytes.data(), kPng, sizeof kPng) == 0) {
    return decode_png(bytes);
  }
  return Error{"not a binary PGM (P5) or a PNG"};
}

}  // namespace vantage::drivers::camera
