#include "logs/picture/svg.hpp"

#include <iterator>

#include <fmt/format.h>

namespace vantage::logs {

std::string escape_xml(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&apos;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

Svg::Svg(double width_px, double height_px) {
  body_ = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"DejaVu Sans, Helvetica, Arial, "
      "sans-serif\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      width_px, height_px);
}

void Svg::rectangle(const Eigen::Vector2d& corner_px, const Eigen::Vector2d& size_px,
                    std::string_view style) {
  body_ += fmt::format(R"(<rect x="{:.2f}" y="{:.2f}" width="{:.2f}" height="{:.2f}" {}/>)",
                       corner_px.x(), corner_px.y(), size_px.x(), size_px.y(), style);
  body_ += '\n';
}

void Svg::circle(const Eigen::Vector2d& centre_px, double radius_px, std::string_view style) {
  body_ += fmt::format(R"(<circle cx="{:.2f}" cy="{:.2f}" r="{:.2f}" {}/>)", centre_px.x(),
                       centre_px.y(), radius_px, style);
  body_ += '\n';
}

void Svg::ellipse(const Eigen::Vector2d& centre_px, const Eigen::Vector2d& half_axes_px,
                  double angle_deg, std::string_view style) {
  body_ += fmt::format(
      "<ellipse rx=\"{:.2f}\" ry=\"{:.2f}\" "
      "transform=\"translate({:.2f} {:.2f}) rotate({:.2f})\" {}/>",
      half_axes_px.x(), half_axes_px.y(), centre_px.x(), centre_px.y(), angle_deg, style);
  body_ += '\n';
}

void Svg::line(const Eigen::Vector2d& from_px, const Eigen::Vector2d& to_px,
               std::string_view style) {
  body_ += fmt::format(R"(<line x1="{:.2f}" y1="{:.2f}" x2="{:.2f}" y2="{:.2f}" {}/>)", from_px.x(),
                       from_px.y(), to_px.x(), to_px.y(), style);
  body_ += '\n';
}

void Svg::points_element(std::string_view element, const std::vector<Eigen::Vector2d>& points_px,
                         std::string_view style) {
  body_ += fmt::format("<{} points=\"", element);
  for (const Eigen::Vector2d& p_px : points_px) {
    fmt::format_to(std::back_inserter(body_), "{:.2f},{:.2f} ", p_px.x(), p_px.y());
  }
  body_ += fmt::format("\" {}/>\n", style);
}

void Svg::polyline(const std::vector<Eigen::Vector2d>& points_px, std::string_view style) {
  if (points_px.size() > 1) {
    points_element("polyline", points_px, style);
  }
}

void Svg::polygon(const std::vector<Eigen::Vector2d>& points_px, std::string_view style) {
  points_element("polygon", points_px, style);
}

void Svg::text(const Eigen::Vector2d& baseline_px, std::string_view words, std::string_view style) {
  body_ += fmt::format("<text x=\"{:.2f}\" y=\"{:.2f}\" {}>{}</text>\n", baseline_px.x(),
                       baseline_px.y(), style, escape_xml(words));
}

void Svg::open_group(std::string_view style) { body_ += fmt::format("<g {}>\n", style); }

void Svg::close_group() { body_ += "</g>\n"; }

void Svg::open_clip(const Eigen::Vector2d& corner_px, const Eigen::Vector2d& size_px) {
  ++clips_;
  body_ += fmt::format("<clipPath id=\"clip{}\">", clips_);
  rectangle(corner_px, size_px, "");
  body_ += fmt::format("</clipPath>\n<g clip-path=\"url(#clip{})\">\n", clips_);
}

std::string Svg::str() const { return body_ + "</svg>\n"; }

}  // namespace vantage::logs
