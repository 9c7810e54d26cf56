#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

// What things look like and are called, wherever they are drawn: by the page, in pictures and
// plots, in the terminal. Said once, in look.json, which the page reads as well.

namespace vantage::logs {

/// The text of look.json.
extern const char* const kLookText;

/// One colour on a white ground and on a black one; both "#rrggbb". What is drawn for an unknown
/// ground has middle().
struct Paint {
  std::string light;
  std::string dark;

  /// Halfway between the two, each channel rounded down: 0xRRGGBB.
  [[nodiscard]] std::uint32_t middle() const;
};

/// A number that is shown: "entropy a target", "nat".
struct Measure {
  std::string name;
  std::string unit;  ///< empty: a count

  /// "entropy a target [nat]".
  [[nodiscard]] std::string title() const;
};

struct Look {
  double ellipse_probability = 0.0;  ///< what a drawn ellipse holds
  double trail_s = 0.0;              ///< how much of the way behind a body is shown
  std::vector<Paint> robots;         ///< of the bodies; told apart by the colour-blind, too
  std::map<std::string, Paint> roles;
  std::map<std::string, std::string> glyphs;  ///< what a legend says of them
  std::map<std::string, Measure> measures;

  /// Mahalanobis radius of an ellipse of `ellipse_probability` in two dimensions, √(−2 ln(1 − p)).
  [[nodiscard]] double ellipse_radius() const;
  /// "95 %".
  [[nodiscard]] std::string ellipse_words() const;
};

/// The table. Each name that the sources ask for is in it (.at() throws what is missing).
const Look& look();

/// What tells robot `index` of a scenario from the others, the same wherever it is drawn: one
/// colour of look().robots for its body and, from the ninth robot on, another one for its core; in
/// charts its line is dashed in one of 8 ways. 64 robots differ.
struct RobotLook {
  std::size_t body = 0;  ///< of look().robots
  std::size_t core = 0;  ///< of look().robots; equal to `body`: none
  std::size_t dash = 0;  ///< 0: drawn through

  [[nodiscard]] const Paint& body_paint() const { return look().robots[body]; }
  [[nodiscard]] const Paint& core_paint() const { return look().robots[core]; }
};
RobotLook robot_look(std::size_t index);

}  // namespace vantage::logs
