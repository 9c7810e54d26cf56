#!/usr/bin/env python3
"""Tests the pictures of the environments: PNG decoder, modes, and content."""
import pathlib
import shutil
import struct
import unittest
import unittest.mock
import zlib

import numpy
import vantage.env
from vantage.env import picture

HAS_RENDERER = shutil.which("rsvg-convert") is not None


def png_of(pixels, filters):
    """Returns a PNG file of `pixels` (height, width, 3 or 4); row y is stored with filters[y % len(filters)]."""
    height, width, channels = pixels.shape
    rows, above = b"", numpy.zeros(width * channels, numpy.int32)
    for y in range(height):
        row = pixels[y].reshape(-1).astype(numpy.int32)
        left = numpy.concatenate([numpy.zeros(channels, numpy.int32), row[:-channels]])
        corner = numpy.concatenate([numpy.zeros(channels, numpy.int32), above[:-channels]])
        kind = filters[y % len(filters)]
        estimate = left + above - corner
        nearest = [min((abs(e - a), 0, a), (abs(e - b), 1, b), (abs(e - c), 2, c))[2]
                   for e, a, b, c in zip(estimate, left, above, corner)]
        guess = (0, left, above, (left + above) // 2, numpy.array(nearest))[kind]
        rows += bytes([kind]) + ((row - guess) & 255).astype(numpy.uint8).tobytes()
        above = row

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    head = struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 6, 0, 0, 0)
    packed = zlib.compress(rows)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", packed[:50]) + chunk(b"IDAT", packed[50:])
            + chunk(b"IEND", b""))


class DecodePng(unittest.TestCase):
    def test_inverts_every_row_filter(self):
        pixels = numpy.random.default_rng(1).integers(256, size=(20, 13, 3), dtype=numpy.uint8)
        for filters in ([0], [1], [2], [3], [4], [4, 1, 3, 0, 2]):
            numpy.testing.assert_array_equal(picture.decode_png(png_of(pixels, filters)), pixels)

    def test_draws_transparent_pixels_on_white(self):
        pixels = numpy.array([[[10, 20, 30, 255], [10, 20, 30, 0], [0, 0, 0, 51]]], numpy.uint8)
        numpy.testing.assert_array_equal(picture.decode_png(png_of(pixels, [4])),
                                         [[[10, 20, 30], [255, 255, 255], [204, 204, 204]]])

    def test_refuses_other_files(self):
        with self.assertRaisesRegex(ValueError, "not a PNG"):
            picture.decode_png(b"GIF89a" + bytes(40))
        grey = bytearray(png_of(numpy.zeros((1, 1, 3), numpy.uint8), [0]))
        grey[25] = 0
        with self.assertRaisesRegex(ValueError, "unsupported PNG"):
            picture.decode_png(bytes(grey))


class Render(unittest.TestCase):
    def test_returns_nothing_without_a_mode(self):
        with vantage.env.make("TargetTracking") as env:
            env.reset(seed=1)
            self.assertIsNone(env.render())

    def test_refuses_other_modes(self):
        for make in (vantage.env.make, vantage.env.make_team, lambda name, **more: vantage.env.make_vector(name, 2, **more)):
            with self.assertRaisesRegex(ValueError, "render_mode: must be None or one of human, rgb_array, got 'ansi'"):
                make("TeamTracking", render_mode="ansi")

    @unittest.skipUnless(HAS_RENDERER, "rsvg-convert is not installed")
    def test_returns_a_changing_picture_of_every_task(self):
        for name in vantage.env.tasks:
            env = vantage.env.make_team(name, render_mode="rgb_array")
            env.reset(seed=3)
            first = env.render()
            self.assertEqual((first.dtype, first.ndim, first.shape[2]), (numpy.uint8, 3, 3), name)
            self.assertGreater(min(first.shape[:2]), 300)
            numpy.testing.assert_array_equal(env.render(), first)
            for _ in range(5):
                env.step(dict.fromkeys(env.agents, 0))
            self.assertGreater((env.render() != first).any(axis=2).sum(), 200, name)
            env.reset(seed=3)
            numpy.testing.assert_array_equal(env.render(), first)
            env.close()

    @unittest.skipUnless(HAS_RENDERER, "rsvg-convert is not installed")
    def test_returns_one_picture_per_task_of_a_vector(self):
        env = vantage.env.make_vector("TeamMapping", 3, render_mode="rgb_array")
        env.reset(seed=1)
        pictures = env.render()
        self.assertEqual(len(pictures), 3)
        self.assertTrue((pictures[0] != pictures[1]).any())
        env.close()

    @unittest.skipUnless(HAS_RENDERER, "rsvg-convert is not installed")
    def test_human_mode_opens_one_page_and_removes_it_at_the_end(self):
        with unittest.mock.patch("webbrowser.open") as opened:
            env = vantage.env.make("TargetTracking", render_mode="human")
            env.reset(seed=1)
            env.step(0)
            self.assertIsNone(env.render())
            opened.assert_called_once()
            page = pathlib.Path(opened.call_args[0][0].removeprefix("file://"))
            self.assertIn("picture.png", page.read_text())
            self.assertTrue((page.parent / "picture.png").exists())
            env.close()
            self.assertFalse(page.exists())

    def test_needs_an_episode(self):
        env = vantage.env.make("TargetTracking", render_mode="rgb_array")
        with self.assertRaisesRegex(vantage.UsageError, "reset"):
            env.render()
        env.close()


if __name__ == "__main__":
    unittest.main()
