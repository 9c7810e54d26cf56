#include "logs/picture/picture.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "core/child.hpp"
#include "logs/picture/layout.hpp"
#include "logs/picture/map_layer.hpp"
#include "logs/picture/panel.hpp"
#include "logs/picture/svg.hpp"

namespace vantage::logs {

std::string draw_picture(const scenario::Scenario& scenario, const Scene& scene,
                         const logs::TrialSummary& summary, KeyNumbers numbers) {
  const Layout layout(scenario.world.bounds, panel_height_px(scenario));
  Svg svg(layout.page_size_px.x(), layout.page_size_px.y());
  draw_header(svg, layout, scenario, summary, numbers);
  svg.open_clip(layout.map_corner_px, layout.map_size_px);
  draw_ground(svg, layout, scenario, scene);
  draw_tracks(svg, layout, scenario, scene);
  draw_views_and_plans(svg, layout, scenario, scene);
  draw_estimates(svg, layout, scene);
  svg.close_group();
  draw_axes(svg, layout, scenario.world);
  draw_bodies(svg, layout, scenario, scene);
  draw_panel(svg, layout, scenario, scene, summary);
  return svg.str();
}

Result<std::string> render_png(const std::string& svg_path, const std::string& png_path) {
  const std::string temporary_path = png_path + ".part";
  Result<Child> child =
      Child::start({"rsvg-convert", "--format=png", "--output=" + temporary_path, svg_path});
  if (!child.ok()) {
    return Error{"no PNG: rsvg-convert is not installed (apt install librsvg2-bin)"};
  }
  const std::optional<ChildExit> ended = std::move(child).value().wait(std::chrono::seconds(30));
  if (!ended || !ended->is_success()) {
    std::remove(temporary_path.c_str());
    throw std::runtime_error(png_path + ": cannot be written: rsvg-convert failed on " + svg_path);
  }
  if (std::rename(temporary_path.c_str(), png_path.c_str()) != 0) {
    throw std::runtime_error(png_path + ": cannot be written: " + std::strerror(errno));
  }
  return png_path;
}

}  // namespace vantage::logs
