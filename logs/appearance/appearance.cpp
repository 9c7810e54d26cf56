#include "logs/appearance/appearance.hpp"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace vantage::logs {
namespace {

using Json = nlohmann::json;

Paint paint(const Json& of) { return {of.at("light"), of.at("dark")}; }

Appearance read(const Json& table) {
  Appearance out;
  out.ellipse_probability = table.at("ellipse_probability");
  out.trail_s = table.at("trail_s");
  for (const Json& each : table.at("robots")) {
    out.robots.push_back(paint(each));
  }
  for (const auto& [name, each] : table.at("roles").items()) {
    out.roles[name] = paint(each);
  }
  out.glyphs = table.at("glyphs");
  for (const auto& [name, each] : table.at("measures").items()) {
    out.measures[name] = {each.at("name"), each.at("unit")};
  }
  return out;
}

}  // namespace

std::uint32_t Paint::middle() const {
  const auto a = static_cast<std::uint32_t>(std::stoul(light.substr(1), nullptr, 16));
  const auto b = static_cast<std::uint32_t>(std::stoul(dark.substr(1), nullptr, 16));
  std::uint32_t out = 0;
  for (const unsigned shift : {0U, 8U, 16U}) {
    out |= ((a >> shift & 0xFFU) + (b >> shift & 0xFFU)) / 2U << shift;
  }
  return out;
}

std::string Measure::title() const {
  return unit.empty() ? name : fmt::format("{} [{}]", name, unit);
}

double Appearance::ellipse_radius() const {
  return std::sqrt(-2.0 * std::log1p(-ellipse_probability));
}

std::string Appearance::ellipse_label() const {
  return fmt::format("{:g} %", 100.0 * ellipse_probability);
}

const Appearance& appearance() {
  static const Appearance table = read(Json::parse(kAppearanceText));
  return table;
}

RobotAppearance robot_appearance(std::size_t index) {
  const std::size_t count = appearance().robots.size();
  const std::size_t turn = index / count % count;
  return {index % count, (index + turn) % count, turn};
}

}  // namespace vantage::logs
