// Names in the picture: a canvas over it. Each name is drawn with its halo once and stamped from
// then on, since writing text is slow.

const kPad = 3;
const kKeptMax = 2000;

export class Names {
  /** @param is_plain write in memory, where the graphics are no faster */
  constructor(canvas, is_plain) {
    this.canvas = canvas;
    this.options = { willReadFrequently: is_plain };
    this.pen = canvas.getContext("2d", this.options);
    this.ratio = 1;
    this.halo = "";
    this.stamps = new Map();
  }

  resize(width, height, ratio) {
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    this.ratio = ratio;
    this.stamps.clear();
  }

  /** Begins a picture. */
  begin(halo) {
    if (halo !== this.halo || this.stamps.size > kKeptMax) this.stamps.clear();
    this.halo = halo;
    this.pen.setTransform(1, 0, 0, 1, 0, 0);
    this.pen.clearRect(0, 0, this.canvas.width, this.canvas.height);
  }

  /** What `draw` writes stays inside an area. */
  within(area, draw) {
    const [x, y, width, height] = [area.x, area.y, area.width, area.height].map((v) => v * this.ratio);
    this.pen.save();
    this.pen.beginPath();
    this.pen.rect(x, y, width, height);
    this.pen.clip();
    draw();
    this.pen.restore();
  }

  /** A text annotation with its base line's middle at a place. */
  write(text, left, top) {
    const stamp = this.stamp_of(text);
    this.pen.drawImage(
      stamp.canvas,
      Math.round(left * this.ratio - stamp.canvas.width / 2),
      Math.round(top * this.ratio - stamp.ascent),
    );
  }

  stamp_of({ text, font_size, color }) {
    const fill = `rgb(${["r", "g", "b"].map((c) => Math.round(255 * color[c]))})`;
    const key = `${font_size} ${fill} ${text}`;
    if (!this.stamps.has(key)) this.stamps.set(key, this.make_stamp(text, font_size, fill));
    return this.stamps.get(key);
  }

  make_stamp(text, font_size, fill) {
    const canvas = document.createElement("canvas");
    const pen = canvas.getContext("2d", this.options);
    const font = `600 ${font_size * this.ratio}px system-ui, sans-serif`;
    pen.font = font;
    const pad = kPad * this.ratio;
    const size = pen.measureText(text);
    const ascent = Math.ceil(size.actualBoundingBoxAscent) + pad;
    canvas.width = Math.ceil(size.width) + 2 * pad;
    canvas.height = ascent + Math.ceil(size.actualBoundingBoxDescent) + pad;
    pen.font = font; // a canvas forgets it with its size
    pen.lineJoin = "round";
    pen.lineWidth = 3 * this.ratio;
    pen.strokeStyle = this.halo;
    pen.fillStyle = fill;
    pen.strokeText(text, pad, ascent);
    pen.fillText(text, pad, ascent);
    return { canvas, ascent };
  }
}
