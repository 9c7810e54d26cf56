#include "logs/appearance/appearance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::logs {
namespace {

using Colour = std::array<double, 3>;

// Returns the linear light of "#rrggbb". Source: IEC 61966-2-1.
Colour linear(const std::string& hex) {
  Colour out{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double c = std::stoi(hex.substr(1 + 2 * i, 2), nullptr, 16) / 255.0;
    out[i] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  }
  return out;
}

Colour times(const std::array<Colour, 3>& m, const Colour& v) {
  Colour out{};
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = std::clamp(m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2], 0.0, 1.0);
  }
  return out;
}

// Colour vision: normal, without red cones, without green cones.
// Source: Machado, Oliveira, Fernandes 2009, severity 1.
constexpr std::array<std::array<Colour, 3>, 3> kEyes = {{
    {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
    {{{0.152286, 1.052583, -0.204868},
      {0.114503, 0.786281, 0.099216},
      {-0.003882, -0.048116, 1.051998}}},
    {{{0.367322, 0.860646, -0.227968},
      {0.280085, 0.672501, 0.047413},
      {-0.011820, 0.042940, 0.968881}}},
}};

// Returns the OKLab coordinates of a linear colour. Source: Ottosson 2020.
Colour oklab(const Colour& rgb) {
  const auto cone = [&](double r, double g, double b) {
    return std::cbrt(r * rgb[0] + g * rgb[1] + b * rgb[2]);
  };
  const double l = cone(0.4122214708, 0.5363325363, 0.0514459929);
  const double m = cone(0.2119034982, 0.6806995451, 0.1073969566);
  const double s = cone(0.0883024619, 0.2817188376, 0.6299787005);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

// Returns the minimum distance between two colours for the three kinds of colour vision; the
// distance from black to white is 1.
double distance(const std::string& a, const std::string& b) {
  double least = 10.0;
  for (const auto& eye : kEyes) {
    const Colour p = oklab(times(eye, linear(a)));
    const Colour q = oklab(times(eye, linear(b)));
    least = std::min(least, std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
  }
  return least;
}

double contrast(const std::string& a, const std::string& b) {
  const auto luminance = [](const Colour& c) {
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2] + 0.05;
  };
  const double x = luminance(linear(a));
  const double y = luminance(linear(b));
  return std::max(x, y) / std::min(x, y);
}

TEST(Appearance, EllipseHasTheStatedProbability) {
  EXPECT_NEAR(appearance().ellipse_radius(), 2.447746830680816, 1e-12);  // √χ²₂(0.95), from tables
  EXPECT_EQ(appearance().ellipse_label(), "95 %");
  EXPECT_NE(appearance().glyphs.at("estimate").find(appearance().ellipse_label()),
            std::string::npos);
}

TEST(Appearance, ColoursAreDistinctForColourBlindReaders) {
  for (const bool is_dark : {false, true}) {
    const auto shown = [&](const Paint& paint) { return is_dark ? paint.dark : paint.light; };
    std::vector<std::string> colours;
    for (const Paint& paint : appearance().robots) {
      colours.push_back(shown(paint));
    }
    for (const char* role : {"jammed", "estimate", "truth"}) {
      colours.push_back(shown(appearance().roles.at(role)));
    }
    for (std::size_t i = 0; i < colours.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_GT(distance(colours[i], colours[j]), 0.07) << colours[i] << " " << colours[j];
      }
      EXPECT_GE(contrast(colours[i], is_dark ? "#101317" : "#fbfbfc"), 2.95) << colours[i];
    }
  }
}

TEST(Appearance, MeanColoursAreDistinct) {
  std::set<std::uint32_t> met;
  std::size_t count = 0;
  std::set<std::string> pairs;  // colour pairs; roles with equal pairs count once
  for (const Paint& paint : appearance().robots) {
    met.insert(paint.middle());
    ++count;
  }
  for (const auto& [name, paint] : appearance().roles) {
    if (pairs.insert(paint.light + paint.dark).second) {
      met.insert(paint.middle());
      ++count;
    }
  }
  EXPECT_EQ(met.size(), count);
  EXPECT_EQ((Paint{"#010203", "#030507"}.middle()), 0x020305U);
}

TEST(RobotAppearance, DistinguishesSixtyFourRobots) {
  std::set<std::pair<std::size_t, std::size_t>> bodies;
  std::set<std::pair<std::size_t, std::size_t>> lines;
  for (std::size_t i = 0; i < 64; ++i) {
    const RobotAppearance looks = robot_appearance(i);
    bodies.emplace(looks.body, looks.core);
    lines.emplace(looks.body, looks.dash);
    EXPECT_EQ(looks.core == looks.body, i < 8) << i;
  }
  EXPECT_EQ(bodies.size(), 64U);
  EXPECT_EQ(lines.size(), 64U);
}

TEST(Measure, TitleContainsItsUnit) {
  EXPECT_EQ(appearance().measures.at("entropy").title(), "entropy per target [nat]");
  EXPECT_EQ(appearance().measures.at("found").title(), "targets found");
}

}  // namespace
}  // namespace vantage::logs
