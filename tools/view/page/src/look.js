// What things look like and are called: the same table as in pictures, plots and the terminal.

import table from "../../../../logs/look/look.json";

export const look = table;

const channels = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));

/** On the stream a colour is halfway between those on a light and on a dark ground: which one is it? */
const by_middle = new Map(
  [...table.robots, ...Object.values(table.roles)].map((paint) => {
    const [light, dark] = [channels(paint.light), channels(paint.dark)];
    return [light.map((c, i) => Math.floor((c + dark[i]) / 2)).join(), { light, dark }];
  }),
);

let theme = "light";

/** The ground that is drawn on: "light" or "dark". */
export function set_ground(name) {
  theme = name;
}

/** A colour of the stream as it is to be shown on this ground; strangers' stay as they are. */
export function shown(color) {
  const paint = by_middle.get([color.r, color.g, color.b].map((c) => Math.round(255 * c)).join());
  if (!paint) return color;
  const [r, g, b] = paint[theme].map((c) => c / 255);
  return { r, g, b, a: color.a };
}

/** A role's colour as the stream has it. */
export function color_of_role(role) {
  const [light, dark] = ["light", "dark"].map((ground) => channels(table.roles[role][ground]));
  const [r, g, b] = light.map((c, i) => Math.floor((c + dark[i]) / 2) / 255);
  return { r, g, b, a: 1 };
}

/** Red, green and blue of a role on this ground, each in [0, 255]. */
export const channels_of = (role) => channels(table.roles[role][theme]);

/** A role's colour for CSS. */
export const css_of_role = (role, alpha = 1) => `rgba(${channels_of(role)},${alpha})`;

/** As logs/look says it: what tells robot `index` of a scenario from the others. */
export function robot_look(index) {
  const count = table.robots.length;
  const turn = Math.floor(index / count) % count;
  return { body: index % count, core: (index + turn) % count, dash: turn };
}

export const robot_css = (place) => `rgba(${channels(table.robots[place][theme])},1)`;

/** How a chart's line is dashed, by `dash` of robot_look(). */
export const kDashes = [[], [7, 4], [2, 3], [10, 3, 2, 3], [4, 2], [12, 5], [2, 6], [8, 2, 2, 2, 2, 2]];

/** "entropy a target [nat]". */
export function title_of(measure) {
  const { name, unit } = table.measures[measure];
  return unit ? `${name} [${unit}]` : name;
}

/** A number with as many digits as say something. */
export function digits(value) {
  if (!Number.isFinite(value)) return String(value);
  const size = Math.abs(value);
  if (Number.isInteger(value) && size < 1e6) return String(value);
  if (size >= 1e6 || (size < 1e-3 && size > 0)) return value.toExponential(2);
  return value.toFixed(size >= 100 ? 1 : size >= 1 ? 2 : 3);
}
