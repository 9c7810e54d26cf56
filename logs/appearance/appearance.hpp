#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

// Appearance and names of all displayed items, for page, pictures, plots and terminal. They are
// defined once, in appearance.json, which the page also reads.

namespace vantage::logs {

/// The text of appearance.json.
extern const char* const kAppearanceText;

/// One colour for a white and one for a black background, both "#rrggbb". Drawings for an unknown
/// background use middle().
struct Paint {
  std::string light;
  std::string dark;

  /// Returns the mean of the two colours, each channel rounded down: 0xRRGGBB.
  [[nodiscard]] std::uint32_t middle() const;
};

/// Name and unit of a displayed quantity: "entropy per target", "nat".
struct Measure {
  std::string name;
  std::string unit;  ///< unit's symbol; empty for a count

  /// Returns the name with the unit, such as "entropy per target [nat]".
  [[nodiscard]] std::string title() const;
};

struct Appearance {
  double ellipse_probability = 0.0;  ///< probability inside a drawn ellipse
  double trail_s = 0.0;              ///< s; length of the displayed path behind a body
  std::vector<Paint> robots;         ///< body colours; distinguishable for colour-blind people
  std::map<std::string, Paint> roles;
  std::map<std::string, std::string> glyphs;  ///< meaning of each glyph, for legends
  std::map<std::string, Measure> measures;

  /// Returns the Mahalanobis radius of an ellipse of `ellipse_probability` in 2-D, √(−2 ln(1 − p)).
  [[nodiscard]] double ellipse_radius() const;
  /// Returns the ellipse probability as text, such as "95 %".
  [[nodiscard]] std::string ellipse_label() const;
};

/// Returns the content of appearance.json. Lookups by .at() throw if a name is missing in
/// appearance.json.
const Appearance& appearance();

/// Appearance that identifies robot `index` of a scenario in all drawings. The body has a colour of
/// appearance().robots. From the ninth robot on, the body has a core of another colour. In charts
/// the robot's line has one of 8 dash patterns. Up to 64 robots are distinguishable.
struct RobotAppearance {
  std::size_t body = 0;  ///< index into appearance().robots
  std::size_t core = 0;  ///< index into appearance().robots; equal to `body`: no core
  std::size_t dash = 0;  ///< dash pattern; 0: solid

  [[nodiscard]] const Paint& body_paint() const { return appearance().robots[body]; }
  [[nodiscard]] const Paint& core_paint() const { return appearance().robots[core]; }
};
RobotAppearance robot_appearance(std::size_t index);

}  // namespace vantage::logs
