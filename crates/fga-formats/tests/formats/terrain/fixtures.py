"""Writes the files of heights beside this script, from one formula, with GDAL (rasterio 1.4.4), PROJ (pyproj 3.7.2) and struct alone.

python3 -m venv v && v/bin/pip install numpy==2.* rasterio==1.4.4 pyproj==3.7.2 && v/bin/python fixtures.py
"""
import gzip
import math
import os
import struct

import numpy as np
import pyproj
import rasterio
from rasterio.shutil import copy
from rasterio.transform import from_origin

HERE = os.path.dirname(os.path.abspath(__file__))


def formula(latitude, longitude):
    """Height in metres at a place in degrees."""
    return 700 + 400 * np.sin(7 * latitude) * np.cos(5 * longitude) + 90 * np.sin(40 * longitude)


def grid(south, west, step_north, step_east, rows, columns):
    """Heights from the north-west."""
    latitudes = south + step_north * np.arange(rows - 1, -1, -1)
    longitudes = west + step_east * np.arange(columns)
    return formula(latitudes[:, None], longitudes[None, :])


def tif(name, heights, west, north, step, crs="EPSG:4326+5773", point=False, mask=None, unit=None, line=None, **options):
    half = 0.5 * step
    path = os.path.join(HERE, name)
    profile = dict(driver="GTiff", height=heights.shape[0], width=heights.shape[1], count=1,
                   dtype=str(heights.dtype), crs=crs,
                   transform=from_origin(west - half, north + half, step, step), **options)
    with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=True), rasterio.open(path, "w", **profile) as file:
        file.update_tags(AREA_OR_POINT="Point" if point else "Area")
        if unit:
            file.set_band_unit(1, unit)
        if line:
            file.scales, file.offsets = [[number] for number in line]
        file.write(heights, 1)
        if mask is not None:
            file.write_mask(mask)


def hgt():
    rows = np.arange(1201)
    heights = (100 + rows[:, None] // 40 * 7 + rows[None, :] // 60 * 3).astype(">i2")
    heights[300, 500] = -32768
    with open(os.path.join(HERE, "S34W071.hgt.gz"), "wb") as file:
        file.write(gzip.compress(heights.tobytes(), 9, mtime=0))


def dted():
    step = 1 / 120
    heights = np.round(grid(-30, -178, step, step, 121, 121)).astype("int16") - 700
    heights[0, 5] = -32767
    source = "/tmp/source.tif"
    with rasterio.open(source, "w", driver="GTiff", height=121, width=121, count=1, dtype="int16", nodata=-32767,
                       crs="EPSG:4326", transform=from_origin(-178 - step / 2, -29 + step / 2, step, step)) as file:
        file.write(heights, 1)
    copy(source, "/tmp/source.dt0", driver="DTED")
    with open("/tmp/source.dt0", "rb") as whole, open(os.path.join(HERE, "s30_w178.dt0.gz"), "wb") as file:
        file.write(gzip.compress(whole.read(), 9, mtime=0))


def crc(data):
    value = 0
    for byte in data:
        value ^= byte << 8
        for _ in range(8):
            value = (value << 1 ^ 0x1021 if value & 0x8000 else value << 1) & 0xFFFF
    return value


def block(degree, index, spacing, filled=(1 << 56) - 1, new=True):
    """A block of ArduPilot; `new`: longitudes have the scale half way to the block."""
    per_degree = 0.011131884502145034 * 1e7
    south = degree[0] + index[0] * 24 * spacing / per_degree

    def place(x, y):
        latitude = south + x * spacing / per_degree
        scale = math.cos(math.radians((degree[0] + latitude) / 2 if new else degree[0]))
        return latitude, degree[1] + (index[1] * 28 + y) * spacing / per_degree / scale

    heights = [round(float(formula(*place(x, y)))) for x in range(28) for y in range(32)]
    corner = [round(value * 1e7) for value in place(0, 0)]

    def packed(checksum):
        return struct.pack("<QiiHHH896hHHhb", filled, *corner, checksum, 1, spacing, *heights, *index,
                           degree[1], degree[0])

    return (packed(crc(packed(0))) + b"\x01").ljust(2048, b"\0")


def dat():
    blocks = [block((46, 9), (2, 3), 100), bytes(2048), block((46, 9), (3, 3), 100, filled=(1 << 56) - 1 - 1),
              block((46, 9), (2, 4), 100)]
    with open(os.path.join(HERE, "N46E009.DAT"), "wb") as file:
        file.write(b"".join(blocks))
    with open(os.path.join(HERE, "old.dat"), "wb") as file:
        file.write(block((46, 9), (2, 3), 100, new=False))


step = 1 / 400
north, west = 46.6, 9.2
heights = grid(north - 39 * step, west, step, step, 40, 50)
whole = np.round(heights).astype("int16")
holed = whole.copy()
holed[10, 20] = -9999
tif("strips.tif", holed, west, north, step, nodata=-9999, compress="deflate", predictor=2)
floats = heights.astype("float32")
tif("tiles.tif", floats, west, north, step, crs="EPSG:4326+3855", point=True, tiled=True, blockxsize=16, blockysize=16,
    compress="lzw", predictor=3, ENDIANNESS="BIG")
tif("ellipsoid.tif", whole, west, north, step, crs="EPSG:4979", BIGTIFF="YES")
tif("packed.tif", whole, west, north, step, crs="EPSG:4326", compress="packbits")
# Grids of maps, each 48 x 40 posts 100 m apart.
for name, west_m, north_m, crs, options in [
    ("utm.tif", 516000, 5160000, "EPSG:32632", {}),
    ("swiss.tif", 2755000, 1160000, "EPSG:2056+5728", dict(compress="zstd", predictor=3)),
    ("british.tif", 256000, 192000, "EPSG:27700", dict(compress="zstd")),
]:
    on_map = pyproj.Transformer.from_crs(crs.split("+")[0], 4326, always_xy=True)
    longitudes, latitudes = on_map.transform(*np.meshgrid(west_m + 100.0 * np.arange(40), north_m - 100.0 * np.arange(48)))
    tif(name, formula(latitudes, longitudes).astype("float32"), west_m, north_m, 100.0, crs=crs, **options)
# Neighbours without a common line of posts, as tiles of Copernicus are.
tif("west.tif", whole[:, :20], west, north, step)
tif("east.tif", whole[:, 20:], west + 20 * step, north, step)
tif("south.tif", np.round(grid(north - 59 * step, west, step, step, 20, 50)).astype("int16"), west, north - 40 * step, step)
# Pixels without a value under a mask; feet; pixels with a scale and an offset.
known = (np.arange(40)[:, None] + np.arange(50)[None, :]) % 9 != 0
masked = np.where(known, whole, 0).astype("int16")
tif("masked.tif", masked, west, north, step, mask=known, compress="deflate")
tif("masked-tiles.tif", masked, west, north, step, mask=known, tiled=True, blockxsize=16, blockysize=16, compress="deflate",
    BIGTIFF="YES", ENDIANNESS="BIG")
tif("feet.tif", np.round(heights / 0.3048).astype("int16"), west, north, step, unit="ft")
tif("scaled.tif", np.round((heights - 500) / 0.1).astype("int16"), west, north, step, line=(0.1, 500))
hgt()
dted()
dat()
