// Placement of labels next to their items without overlap. Each label keeps its last position if
// nothing else is there, else takes the first unoccupied position. A label for which all positions
// are occupied is not drawn.

/** Positions of a label's centre relative to the item's centre, in units of half the label's size plus the item's radius. */
const kPlaces = [[0, -1], [1, 0], [-1, 0], [0, 1], [0.8, -0.8], [-0.8, -0.8], [0.8, 0.8], [-0.8, 0.8]];
const kGap_px = 2;

export class Labels {
  constructor() {
    this.places = new Map(); // index of the last position in kPlaces, by key
  }

  /** Places labels and returns their boxes.
      @param wanted [{key, x, y, radius_px, width, height, rank}]: lower ranks first
      @param at the area in which the labels must stay
      @param write called with (label, left, top) of each placed label */
  place(wanted, at, write) {
    const taken = [];
    const is_free = (box) =>
      box.left >= at.x && box.top >= at.y && box.right <= at.x + at.width && box.bottom <= at.y + at.height &&
      taken.every((other) => box.left >= other.right || box.right <= other.left || box.top >= other.bottom || box.bottom <= other.top);
    for (const label of wanted.sort((a, b) => a.rank - b.rank)) {
      const { x, y, width, height, radius_px } = label;
      if (x < at.x || x > at.x + at.width || y < at.y || y > at.y + at.height) continue;
      const before = this.places.get(label.key);
      const order = before === undefined ? kPlaces.keys() : [before, ...kPlaces.keys()];
      for (const i of order) {
        const [dx, dy] = kPlaces[i];
        const left = x + dx * (radius_px + kGap_px + width / 2) - width / 2;
        const top = y + dy * (radius_px + kGap_px + height / 2) - height / 2;
        const box = { left, top, right: left + width, bottom: top + height };
        if (!is_free(box)) continue;
        taken.push(box);
        this.places.set(label.key, i);
        write(label, left, top);
        break;
      }
    }
    this.written = taken.length;
    return taken;
  }
}
