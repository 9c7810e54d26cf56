#include "drivers/camera/image_file.hpp"

#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::drivers::camera {
namespace {

Result<models::GrayImage> decode(const std::string& text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  return decode_image(bytes);
}

// 2 x 2 grey levels 0, 85, 170, 255, written by an independent program (Python's zlib).
constexpr std::uint8_t kPng[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
    0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x00, 0x00, 0x00, 0x00, 0x57,
    0xdd, 0x52, 0xf8, 0x00, 0x00, 0x00, 0x0e, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x60,
    0x08, 0x65, 0x58, 0xf5, 0x1f, 0x00, 0x03, 0xad, 0x01, 0xff, 0x7a, 0x93, 0x84, 0x7f, 0x00,
    0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

TEST(DecodeImage, ReadsPgm) {
  const auto image = decode("P5\n# comment\n3 2\n255\nabcdef");
  ASSERT_TRUE(image.ok());
  EXPECT_EQ(image.value().width, 3);
  EXPECT_EQ(image.value().height, 2);
  EXPECT_EQ(image.value().at(2, 1), 'f');
}

TEST(DecodeImage, ScalesOtherDepthsTo8Bits) {
  EXPECT_EQ(decode(std::string("P5 2 1 15\n\0\x0f", 12)).value().pixels,
            (std::vector<std::uint8_t>{0, 255}));
  EXPECT_EQ(decode(std::string("P5 2 1 65535\n\x80\0\xff\xff", 17)).value().pixels,
            (std::vector<std::uint8_t>{127, 255}));
}

TEST(DecodeImage, RefusesDamagedPgms) {
  for (const char* text :
       {"", "P", "P5", "P5\n", "P5 3", "P5 3 2", "P5 3 2 255", "P5 3 2 255\nabcde", "P5 0 2 255\n",
        "P5 3 2 0\nabcdef", "P5 -3 2 255\nabcdef", "P5 99999 99999 255\n",
        "P5 99999999999999999999 2 255\n", "P5 8193 1 255\n", "P2 1 1 255\n0", "GIF89a"}) {
    EXPECT_FALSE(decode(text).ok()) << text;
  }
}

TEST(DecodeImage, ReadsPng) {
  const auto image = decode_image(kPng);
  if (!image.ok() && image.error().message.find("without the PNG") != std::string::npos) {
    GTEST_SKIP() << image.error().message;
  }
  ASSERT_TRUE(image.ok()) << image.error().message;
  EXPECT_EQ(image.value().width, 2);
  EXPECT_EQ(image.value().pixels, (std::vector<std::uint8_t>{0, 85, 170, 255}));
}

// A truncated or changed file gives an image or an error, and no access outside its bytes (which
// the sanitizers would report).
TEST(DecodeImage, SurvivesDamagedFiles) {
  std::mt19937_64 rng(4);
  std::uniform_int_distribution<int> byte(0, 255);
  const std::string png(std::begin(kPng), std::end(kPng));
  for (const std::string& whole : {png, std::string("P5\n3 2\n255\nabcdef")}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      static_cast<void>(decode(whole.substr(0, size)));
      for (int i = 0; i < 20; ++i) {
        std::string changed = whole;
        changed[size] = static_cast<char>(byte(rng));
        static_cast<void>(decode(changed));
      }
    }
    EXPECT_FALSE(decode(whole.substr(0, whole.size() / 2)).ok());
  }
}

}  // namespace
}  // namespace vantage::drivers::camera
