"""Pictures of the environments, as `vantage demo` draws them."""
import pathlib
import shutil
import tempfile
import webbrowser
import zlib

import numpy

from .. import _vantage

RENDER_MODES = ["human", "rgb_array"]

_PAGE = """<!doctype html><meta charset="utf-8"><title>{title}</title>
<body style="margin:0;background:#fff"><img id="picture" src="picture.png" style="max-width:100%">
<script>setInterval(() => {{ picture.src = "picture.png?" + Date.now(); }}, 500);</script>
"""


def require_mode(render_mode):
    """Returns `render_mode`. Raises ValueError unless it is None, human or rgb_array."""
    if render_mode is not None and render_mode not in RENDER_MODES:
        raise ValueError(f"render_mode: must be None or one of {', '.join(RENDER_MODES)}, got {render_mode!r}")
    return render_mode


def decode_png(data):
    """Returns the picture of a PNG file with 8 bits per channel as an array (height, width, 3), on white.

    Reads the format that rsvg-convert writes: RGB or RGBA, not interlaced. Raises ValueError for others.
    """
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError("not a PNG file")
    width, height = (int.from_bytes(data[i:i + 4], "big") for i in (16, 20))
    depth, colour, interlaced = data[24], data[25], data[28]
    if depth != 8 or colour not in (2, 6) or interlaced:
        raise ValueError(f"unsupported PNG: depth {depth}, colour type {colour}, interlaced {interlaced}")
    packed, at = b"", 8
    while at < len(data):
        size = int.from_bytes(data[at:at + 4], "big")
        if data[at + 4:at + 8] == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    channels = 3 if colour == 2 else 4
    picture = _vantage._unfilter_png(zlib.decompress(packed), height, width, channels)
    if channels == 3:
        return picture
    opacity = picture[..., 3:].astype(numpy.uint16)
    on_white = (picture[..., :3] * opacity + 255 * (255 - opacity) + 127) // 255
    return on_white.astype(numpy.uint8)


class Pictures:
    """Pictures of several tasks as files in a temporary folder, and a web page that shows the first task."""

    def __init__(self, tasks, title):
        self._tasks = tasks
        self._title = title
        self._folder = pathlib.Path(tempfile.mkdtemp(prefix="vantage_picture_"))
        self._is_open = False

    def array(self, index=0):
        """Returns the picture of task `index`, (height, width, 3)."""
        return decode_png(self._draw(index).read_bytes())

    def show(self):
        """Draws the first task and, at the first call, opens a page that reloads the picture."""
        self._draw(0)
        if not self._is_open:
            self._is_open = True
            page = self._folder / "index.html"
            page.write_text(_PAGE.format(title=self._title), encoding="utf-8")
            webbrowser.open(page.as_uri())

    def close(self):
        shutil.rmtree(self._folder, ignore_errors=True)

    def _draw(self, index):
        png = self._folder / "picture.png"
        self._tasks.picture(index, self._title, str(self._folder / "picture.svg"), str(png))
        return png
