// Labels on a canvas. Drawing text is slow, so each label is drawn once with its halo and then copied as an image.

import { shown } from "./appearance.js";

const kPad = 3;
const kKeptMax = 2000;

export class Names {
  /** @param options of the contexts of the canvas and of the label images */
  constructor(canvas, options) {
    this.canvas = canvas;
    this.options = options;
    this.pen = canvas.getContext("2d", options);
    this.ruler = new OffscreenCanvas(1, 1).getContext("2d"); // separate, so that measuring does not change the pen's font
    this.ratio = 1;
    this.halo = "";
    this.stamps = new Map(); // image by text, size and colour
    this.known = new WeakMap(); // image by text annotation
  }

  resize(width, height, ratio) {
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    this.ratio = ratio;
    this.forget();
  }

  forget() {
    this.stamps.forEach(({ image }) => image.close());
    this.stamps.clear();
    this.known = new WeakMap();
  }

  /** Begins a new picture. @param halo colour of the halos */
  begin(halo) {
    if (halo !== this.halo || this.stamps.size > kKeptMax) this.forget();
    this.halo = halo;
  }

  /** Clears an area and calls `draw` with the pen, clipped to that area. Coordinates are the stage's pixels. */
  within(at, draw) {
    const { pen } = this;
    pen.save();
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.beginPath();
    pen.rect(at.x, at.y, at.width, at.height);
    pen.clip();
    pen.clearRect(at.x, at.y, at.width, at.height);
    draw(pen);
    pen.restore();
  }

  /** Returns the size of a text annotation in the stage's pixels. */
  size_of(text) {
    const { image } = this.stamp_of(text);
    return { width: image.width / this.ratio, height: image.height / this.ratio };
  }

  /** Draws a text annotation with its upper left corner at (left, top). */
  write(text, left, top) {
    const { image } = this.stamp_of(text);
    this.pen.drawImage(image, left, top, image.width / this.ratio, image.height / this.ratio);
  }

  stamp_of(annotation) {
    let stamp = this.known.get(annotation);
    if (!stamp) {
      const { text, font_size } = annotation;
      const color = shown(annotation.color);
      const fill = `rgb(${["r", "g", "b"].map((c) => Math.round(255 * color[c]))})`;
      const key = `${font_size} ${fill} ${text}`;
      if (!this.stamps.has(key)) this.stamps.set(key, this.make_stamp(text, font_size, fill));
      stamp = this.stamps.get(key);
      this.known.set(annotation, stamp);
    }
    return stamp;
  }

  make_stamp(text, font_size, fill) {
    const font = `600 ${font_size * this.ratio}px system-ui, sans-serif`;
    this.ruler.font = font;
    const pad = kPad * this.ratio;
    const size = this.ruler.measureText(text);
    const ascent = Math.ceil(size.actualBoundingBoxAscent) + pad;
    const height = ascent + Math.ceil(size.actualBoundingBoxDescent) + pad;
    const canvas = new OffscreenCanvas(Math.ceil(size.width) + 2 * pad, height);
    const pen = canvas.getContext("2d", this.options);
    pen.font = font;
    pen.lineJoin = "round";
    pen.lineWidth = 3 * this.ratio;
    pen.strokeStyle = this.halo;
    pen.fillStyle = fill;
    pen.strokeText(text, pad, ascent);
    pen.fillText(text, pad, ascent);
    return { image: canvas.transferToImageBitmap(), ascent };
  }
}
