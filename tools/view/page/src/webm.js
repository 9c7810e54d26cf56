// Writer of a WebM file of encoded pictures. The file contains its length and an index of the key frames, so players can seek.
// Pure functions from numbers and bytes to bytes.
// Source: RFC 8794 (EBML), RFC 9559 (Matroska), of which WebM is a part.

const kClock_ns = 1_000_000; // all times are in milliseconds

const bytes_of = (hex) => Uint8Array.from(hex.match(/../g), (pair) => parseInt(pair, 16));
const text = (words) => new TextEncoder().encode(words);

/** Encodes an unsigned integer in `width` bytes, big-endian. */
function unsigned(value, width = 8) {
  const out = new Uint8Array(width);
  for (let i = width - 1, left = value; i >= 0; i -= 1, left = Math.floor(left / 256)) out[i] = left % 256;
  return out;
}

function float(value) {
  const out = new DataView(new ArrayBuffer(8));
  out.setFloat64(0, value);
  return new Uint8Array(out.buffer);
}

function joined(parts) {
  const out = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  parts.reduce((at, part) => (out.set(part, at), at + part.length), 0);
  return out;
}

/** Encodes an EBML element: identifier, length in eight bytes, content. */
function element(id, ...parts) {
  const body = joined(parts);
  const length = unsigned(body.length);
  length[0] = 0x01;
  return joined([bytes_of(id), length, body]);
}

function header() {
  return element("1a45dfa3",
    element("4286", unsigned(1, 1)), element("42f7", unsigned(1, 1)), element("42f2", unsigned(4, 1)), element("42f3", unsigned(8, 1)),
    element("4282", text("webm")), element("4287", unsigned(4, 1)), element("4285", unsigned(2, 1)));
}

function info(length_ms) {
  return element("1549a966",
    element("2ad7b1", unsigned(kClock_ns, 4)), element("4489", float(length_ms)),
    element("4d80", text("vantage")), element("5741", text("vantage")));
}

function tracks({ codec, width, height, fps }) {
  return element("1654ae6b", element("ae",
    element("d7", unsigned(1, 1)), element("73c5", unsigned(1, 1)), element("83", unsigned(1, 1)), element("9c", unsigned(0, 1)),
    element("86", text(codec)), element("23e383", unsigned(Math.round(1e9 / fps), 4)),
    element("e0", element("b0", unsigned(width, 2)), element("ba", unsigned(height, 2)))));
}

/** Groups pictures: each group begins with a key frame. */
function clusters_of(pictures) {
  const clusters = [];
  for (const picture of pictures) {
    if (picture.is_key || clusters.length === 0) clusters.push([]);
    clusters.at(-1).push(picture);
  }
  return clusters;
}

function cluster(pictures) {
  const [{ at_ms: from_ms }] = pictures;
  return element("1f43b675",
    element("e7", unsigned(from_ms)),
    ...pictures.map(({ at_ms, is_key, data }) =>
      element("a3", Uint8Array.of(0x81), unsigned(at_ms - from_ms, 2), Uint8Array.of(is_key ? 0x80 : 0), data)));
}

/** Encodes the index of the clusters. Its length does not depend on the offsets. */
function cues(places) {
  return element("1c53bb6b", ...places.map(({ at_ms, offset }) =>
    element("bb", element("b3", unsigned(at_ms)), element("b7", element("f7", unsigned(1, 1)), element("f1", unsigned(offset))))));
}

/** Returns the bytes of the whole file.
    @param track {codec: "V_VP8" or "V_VP9", width, height, fps}
    @param pictures {at_ms, is_key, data}, in order, whole milliseconds, the first one a key frame, key frames at most 32 s apart
    @param length_ms length of the video */
export function webm(track, pictures, length_ms) {
  const groups = clusters_of(pictures);
  const made = groups.map(cluster);
  const first = [info(length_ms), tracks(track)];
  const places = groups.map(([{ at_ms }]) => ({ at_ms, offset: 0 }));
  let offset = joined([...first, cues(places)]).length;
  made.forEach((each, i) => {
    places[i].offset = offset;
    offset += each.length;
  });
  return joined([header(), element("18538067", ...first, cues(places), ...made)]);
}
