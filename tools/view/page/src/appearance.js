// Colours and names of displayed items, from the table that pictures, plots and the terminal also use.

import table from "../../../../logs/appearance/appearance.json";

export const appearance = table;

const channels = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));

/** Colours for a light and a dark background. The key is the mean of both, which is the colour in the stream. */
const by_middle = new Map(
  [...table.robots, ...table.targets, ...Object.values(table.roles)].map((paint) => {
    const [light, dark] = [channels(paint.light), channels(paint.dark)];
    return [light.map((c, i) => Math.floor((c + dark[i]) / 2)).join(), { light, dark }];
  }),
);

let theme = "light";

/** Sets the background: "light" or "dark". */
export function set_ground(name) {
  theme = name;
}

/** Converts a colour of the stream into the colour for the current background. Unknown colours stay unchanged. */
export function shown(color) {
  const paint = by_middle.get([color.r, color.g, color.b].map((c) => Math.round(255 * c)).join());
  if (!paint) return color;
  const [r, g, b] = paint[theme].map((c) => c / 255);
  return { r, g, b, a: color.a };
}

/** Returns a role's colour as in the stream: the mean for both backgrounds. */
export function color_of_role(role) {
  const [light, dark] = ["light", "dark"].map((ground) => channels(table.roles[role][ground]));
  const [r, g, b] = light.map((c, i) => Math.floor((c + dark[i]) / 2) / 255);
  return { r, g, b, a: 1 };
}

/** Returns the colour of target `index` of a scenario as in the stream: the mean for both backgrounds. */
export function color_of_target(index) {
  const paint = table.targets[index % table.targets.length];
  const [light, dark] = ["light", "dark"].map((ground) => channels(paint[ground]));
  const [r, g, b] = light.map((c, i) => Math.floor((c + dark[i]) / 2) / 255);
  return { r, g, b, a: 1 };
}

/** Returns the colour of target `index` for CSS on the current background. */
export const target_css = (index) => `rgb(${channels(table.targets[index % table.targets.length][theme])})`;

/** Returns red, green and blue of a role for the current background, each in [0, 255]. */
export const channels_of = (role) => channels(table.roles[role][theme]);

/** Returns a role's colour for CSS. */
export const css_of_role = (role, alpha = 1) => `rgba(${channels_of(role)},${alpha})`;

/** Returns the colours and the dash that distinguish robot `index` of a scenario, as logs/appearance does. */
export function robot_appearance(index) {
  const count = table.robots.length;
  const turn = Math.floor(index / count) % count;
  return { body: index % count, core: (index + turn) % count, dash: turn };
}

export const robot_css = (place) => `rgba(${channels(table.robots[place][theme])},1)`;

/** Dash patterns of chart lines, by `dash` of robot_appearance(). */
export const kDashes = [[], [7, 4], [2, 3], [10, 3, 2, 3], [4, 2], [12, 5], [2, 6], [8, 2, 2, 2, 2, 2]];

/** Returns the name of a measure with its unit, such as "entropy per target [nat]". */
export function title_of(measure) {
  const { name, unit } = table.measures[measure];
  return unit ? `${name} [${unit}]` : name;
}

/** Formats a number with its significant digits. */
export function digits(value) {
  if (!Number.isFinite(value)) return String(value);
  const size = Math.abs(value);
  if (Number.isInteger(value) && size < 1e6) return String(value);
  if (size >= 1e6 || (size < 1e-3 && size > 0)) return value.toExponential(2);
  return value.toFixed(size >= 100 ? 1 : size >= 1 ? 2 : 3);
}
