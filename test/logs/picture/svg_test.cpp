#include "logs/picture/svg.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "logs/picture/layout.hpp"

namespace vantage::logs {
namespace {

TEST(Svg, WritesElementsInOrder) {
  Svg svg(640.4, 480.2);
  auto added = [&, before = svg.str()](const auto& add) mutable {
    const std::string end = "</svg>\n";
    const std::size_t at = before.size() - end.size();
    add();
    before = svg.str();
    return before.substr(at, before.size() - at - end.size());
  };
  EXPECT_NE(svg.str().find(R"(width="640" height="480" viewBox="0 0 640 480")"), std::string::npos);
  EXPECT_EQ(added([&] {
              svg.rectangle({1, 2}, {3, 4}, "a=\"b\"");
            }),
            "<rect x=\"1.00\" y=\"2.00\" width=\"3.00\" height=\"4.00\" a=\"b\"/>\n");
  EXPECT_EQ(added([&] {
              svg.circle({1, 2}, 3, "a=\"b\"");
            }),
            "<circle cx=\"1.00\" cy=\"2.00\" r=\"3.00\" a=\"b\"/>\n");
  EXPECT_EQ(added([&] {
              svg.ellipse({1, 2}, {3, 4}, 5, "a=\"b\"");
            }),
            "<ellipse rx=\"3.00\" ry=\"4.00\" transform=\"translate(1.00 2.00) rotate(5.00)\" "
            "a=\"b\"/>\n");
  EXPECT_EQ(added([&] {
              svg.line({1, 2}, {3, 4}, "a=\"b\"");
            }),
            "<line x1=\"1.00\" y1=\"2.00\" x2=\"3.00\" y2=\"4.00\" a=\"b\"/>\n");
  EXPECT_EQ(added([&] {
              svg.polyline({{1, 2}, {3, 4}}, "a=\"b\"");
            }),
            "<polyline points=\"1.00,2.00 3.00,4.00 \" a=\"b\"/>\n");
  EXPECT_EQ(added([&] {
              svg.polyline({{1, 2}}, "a=\"b\"");
            }),
            "")
      << "a single point is not a line";
  EXPECT_EQ(added([&] {
              svg.polygon({{1, 2}}, "a=\"b\"");
            }),
            "<polygon points=\"1.00,2.00 \" a=\"b\"/>\n");
  EXPECT_EQ(added([&] {
              svg.text({1, 2}, "<&>", "a=\"b\"");
            }),
            "<text x=\"1.00\" y=\"2.00\" a=\"b\">&lt;&amp;&gt;</text>\n");
  EXPECT_EQ(added([&] { svg.open_group("a=\"b\""); }), "<g a=\"b\">\n");
  EXPECT_EQ(added([&] { svg.close_group(); }), "</g>\n");
  for (const char* id : {"clip1", "clip2"}) {
    const std::string clip = id;
    EXPECT_EQ(added([&] {
                svg.open_clip({1, 2}, {3, 4});
              }),
              "<clipPath id=\"" + clip +
                  "\"><rect x=\"1.00\" y=\"2.00\" width=\"3.00\" height=\"4.00\" />\n"
                  "</clipPath>\n<g clip-path=\"url(#" +
                  clip + ")\">\n");
  }
}

TEST(EscapeXml, EscapesReservedCharacters) {
  EXPECT_EQ(escape_xml("a&b<c>d\"e'f"), "a&amp;b&lt;c&gt;d&quot;e&apos;f");
}

// The map is as large as the page allows, for any shape of the world and any position of its
// corner.
TEST(Layout, FitsMapAndPanelOnThePage) {
  for (const auto& [width_m, height_m] :
       {std::pair{8.0, 4.0}, {4.0, 8.0}, {10.4, 8.2}, {100.0, 90.0}, {0.5, 3.0}}) {
    for (const double panel_height_px : {0.0, 400.0, 2000.0}) {
      const Layout layout({{-3.0, 7.0}, {-3.0 + width_m, 7.0 + height_m}}, panel_height_px);
      const Eigen::Vector2d size_px = layout.map_size_px;
      EXPECT_NEAR(size_px.x() / size_px.y(), width_m / height_m, 1e-9);
      EXPECT_NEAR(std::max(size_px.x() / 1040.0, size_px.y() / 820.0), 1.0, 1e-9);
      const double left_px = Layout::kMargin_px;
      const double top_px = Layout::kHeader_px;
      const auto at = [&](double share_x, double share_y) {
        return layout.page_from_world({-3.0 + share_x * width_m, 7.0 + share_y * height_m});
      };
      EXPECT_LT((at(0, 1) - Eigen::Vector2d(left_px, top_px)).norm(), 1e-9);
      EXPECT_LT((at(0, 0) - Eigen::Vector2d(left_px, top_px + size_px.y())).norm(), 1e-9);
      EXPECT_LT((at(1, 1) - Eigen::Vector2d(left_px + size_px.x(), top_px)).norm(), 1e-9);
      EXPECT_LT((at(0.25, 0.5) -
                 Eigen::Vector2d(left_px + 0.25 * size_px.x(), top_px + 0.5 * size_px.y()))
                    .norm(),
                1e-9);
      EXPECT_EQ(layout.panel_corner_px.y(), top_px);
      const double gap_px = layout.panel_corner_px.x() - (left_px + size_px.x());
      EXPECT_GT(gap_px, 20.0);
      EXPECT_LT(gap_px, 60.0);
      EXPECT_EQ(layout.page_size_px.x(), layout.panel_corner_px.x() + Layout::kPanel_px);
      EXPECT_NEAR(layout.page_size_px.y(),
                  top_px + std::max(size_px.y(), panel_height_px) + Layout::kMargin_px, 1e-9);
    }
  }
}

}  // namespace
}  // namespace vantage::logs
