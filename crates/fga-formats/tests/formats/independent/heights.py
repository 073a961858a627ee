"""Writes files of heights into a folder with GDAL, and prints places of their pixels with the heights that GDAL reads there."""
import itertools
import os
import sys

import numpy as np
import rasterio
from rasterio.transform import from_origin
from rasterio.warp import transform

folder = sys.argv[1]
random = np.random.default_rng(3)
rows, columns = np.mgrid[0:40, 0:50]
hills = 700 + 300 * np.sin(rows / 7) * np.cos(columns / 9)
degrees = dict(crs="EPSG:4326", transform=from_origin(8.0, 47.0, 1 / 1200, 1 / 1200))
written = itertools.count()


def write(heights, mask=None, scale=(1, 0), unit=("", 1), overviews=(), slack=0.02, **options):
    path = os.path.join(folder, f"{next(written)}.tif")
    profile = dict(degrees, driver="GTiff", width=50, height=40, count=1, dtype=str(heights.dtype)) | options
    with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=True), rasterio.open(path, "w", **profile) as file:
        file.write(heights, 1)
        if mask is not None:
            file.write_mask(mask)
        file.scales, file.offsets = [scale[0]], [scale[1]]
        file.set_band_unit(1, unit[0])
        file.build_overviews(overviews)
    with rasterio.open(path) as file:
        found = file.read(1, masked=True).astype("float64") * file.scales[0] + file.offsets[0]
        found = found.filled(np.nan) * unit[1]
        for row, column in random.integers(0 if file.crs.is_geographic else 3, 37, (60, 2)):
            x, y = file.xy(row, column)
            (x,), (y,) = transform(file.crs, "EPSG:4326", [x], [y])
            print(os.path.basename(path), repr(float(y)), repr(float(x)), repr(float(found[row, column])), slack)


whole = hills.astype("int16")
single = hills.astype("float32")
holes = np.where((rows % 9 == 4) & (columns % 7 == 3), -9999, whole).astype("int16")
for compress, tiled, predictor in itertools.product(["deflate", "lzw", "packbits", "zstd", None], [False, True], [1, 2, 3]):
    tiles = dict(tiled=True, blockxsize=16, blockysize=16) if tiled else {}
    if predictor == 1 or compress not in ("packbits", None):
        write(single if predictor == 3 else whole, compress=compress, predictor=predictor, **tiles)
for options in [dict(BIGTIFF="YES"), dict(ENDIANNESS="BIG"), dict(BIGTIFF="YES", ENDIANNESS="BIG"), dict(blockysize=7), dict(INTERLEAVE="BAND")]:
    write(whole, **options)
    write(whole, mask=holes != -9999, **options)
for kind in ["uint16", "int32", "uint32", "float64"]:
    write(hills.astype(kind))
write(holes, nodata=-9999)
write(np.where(holes == -9999, 65535, whole).astype("uint16"), nodata=65535)
write(np.where(holes == -9999, np.nan, single).astype("float32"), nodata=float("nan"))
write(np.where(holes == -9999, -3.4028234663852886e38, single).astype("float32"), nodata=-3.4028234663852886e38)
write(whole, overviews=[2, 4])
write(whole, mask=holes != -9999, overviews=[2, 4], compress="deflate")
write((10 * hills).astype("int16"), scale=(0.1, 5.0))
write((hills / 0.3048).astype("float32"), unit=("ft", 0.3048))
write(whole, AREA_OR_POINT="Point")
for code, x, y in [(32632, 500000, 5200000), (2056, 2600000, 1200000), (27700, 400000, 300000), (25832, 600000, 5300000)]:
    write(single, crs=f"EPSG:{code}", transform=from_origin(x, y, 90, 90), slack=12.0)
