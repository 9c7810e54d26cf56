// Legend of the glyphs that are visible on the stage.

import { css_of_role, appearance, robot_css } from "./appearance.js";
import { make } from "./panels.js";

const kSize = "0 0 30 18";

/** SVG content of each glyph's picture, 30 × 18 pixels. */
const kDrawn = {
  robot: () => `<circle cx="13" cy="9" r="6" fill="${robot_css(0)}"/><path d="M20 9l-5 4v-8z" transform="translate(4 0)" fill="${robot_css(0)}"/>`,
  jammed: () => `<circle cx="13" cy="9" r="6" fill="${css_of_role("jammed")}"/><circle cx="13" cy="9" r="3" fill="${robot_css(0)}"/><path d="M20 9l-5 4v-8z" transform="translate(4 0)" fill="${css_of_role("jammed")}"/>`,
  view: () => `<circle cx="15" cy="9" r="8" fill="${robot_css(0)}" fill-opacity=".14" stroke="${robot_css(0)}"/>`,
  plan: () => `<path d="M2 13C10 3 14 15 24 7" fill="none" stroke="${robot_css(0)}" stroke-width="2.5"/><circle cx="25" cy="7" r="2.5" fill="${robot_css(0)}"/>`,
  late: () => `<path d="M2 13C10 3 14 15 27 6" fill="none" stroke="${css_of_role("late")}" stroke-width="2.5"/>`,
  fallback: () => `<path d="M2 13C10 3 14 15 27 6" fill="none" stroke="${css_of_role("fallback")}" stroke-width="2.5"/>`,
  proposal: () => `<path d="M2 13C10 3 14 15 27 6" fill="none" stroke="${robot_css(0)}" stroke-width="1.5" stroke-dasharray="4 3"/>`,
  trail: () => `<path d="M2 13C10 3 14 15 27 6" fill="none" stroke="${robot_css(0)}" stroke-opacity=".55" stroke-width="1.5"/>`,
  truth: () => `<path d="M15 2l7 7-7 7-7-7z" fill="${css_of_role("truth")}"/>`,
  estimate: () => `<ellipse cx="15" cy="9" rx="13" ry="7" fill="none" stroke="${css_of_role("estimate")}" stroke-width="2"/><path d="M11 9h8M15 5v8" stroke="${css_of_role("estimate")}" stroke-width="2"/>`,
  look: () => `<path d="M3 14L27 4" stroke="${css_of_role("late")}" stroke-width="1.5"/>`,
  ...Object.fromEntries(["seen", "stale", "unseen", "occupied", "free", "obstacle", "region"].map((role) => [
    role, () => `<rect x="3" y="3" width="24" height="12" fill="${css_of_role(role)}" stroke="${css_of_role("wall", 0.5)}"/>`])),
  unknown: () => `<rect x="3" y="3" width="24" height="12" fill="${css_of_role("unseen")}" stroke="${css_of_role("wall", 0.5)}"/>`,
};

/** Writes the legend into `box`.
    @param glyphs names in appearance.json of the glyphs to explain
    @param more text added to a glyph's explanation, by its name */
export function write_legend(box, glyphs, more) {
  const said = glyphs.map((glyph) => `${glyph}${more[glyph] ?? ""}`).join();
  const key = `${said} ${css_of_role("truth")}`;
  if (box.dataset.key === key) return;
  box.dataset.key = key;
  box.replaceChildren(...glyphs.map((glyph) => {
    const row = make("li");
    const picture = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    picture.setAttribute("viewBox", kSize);
    picture.setAttribute("aria-hidden", "true");
    picture.innerHTML = kDrawn[glyph](); // safe: the text is from this file
    row.append(picture, make("span", "", `${appearance.glyphs[glyph]}${more[glyph] ?? ""}`));
    return row;
  }));
}
