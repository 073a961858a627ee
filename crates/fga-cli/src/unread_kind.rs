//! Files of others that no command reads, by name.

use std::path::Path;

use fga_formats::error::read_bytes;

/// Endings, words at the beginning of the file or after its first byte, what it is, and what is expected instead.
const KINDS: &str = "\
grb grb2 grib grib2|GRIB|weather in GRIB|heights as GeoTIFF
shp shx dbf prj||a part of a shapefile|its areas as GeoJSON
gpkg mbtiles sqlite db3|SQLite format 3|a GeoPackage or another database|its areas as GeoJSON, its heights as GeoTIFF
fgb|fgb|FlatGeobuf|its areas as GeoJSON
topojson||TopoJSON|its areas as GeoJSON
gml fixm osm||XML of another kind|areas as GeoJSON, KML or AIXM 5.1
nc|CDF|NetCDF|heights as GeoTIFF
h5 hdf|HDF|HDF5|heights as GeoTIFF
jp2 png jpg||a picture|heights as GeoTIFF
las laz|LASF|a cloud of points|heights as GeoTIFF
vrt|<VRTDataset|a mosaic that names other files|these files
asc|ncols|an ASCII grid of Esri|heights as GeoTIFF
bil flt adf img||heights of another kind|GeoTIFF
gpx|<gpx|GPX|a mission of a ground station, or a recording
igc|AXXX|a flight of IGC|a recording
cup|name,code,country|waypoints of SeeYou|a mission of a ground station
nmea|$GP|sentences of NMEA|a recording; FLARM is a feed of fga fly
mcap|MCAP0|a log of messages|a recording
bag|#ROSBAG|a log of ROS|a recording
pcap pcapng||a capture of packets|Beast or BaseStation
ast asterix||radar data in ASTERIX|a recording
zip 7z rar tar tgz|PK\x03\x04|an archive|the files in it
xz zst bz2|BZh|compressed by another program than gzip|gzip or none
pdf|%PDF|a PDF document|data
";

/// What a file is, and what is expected instead, if no command reads its kind.
pub(crate) fn of(path: &Path, ending: &str) -> Option<String> {
    let bytes = read_bytes(path).ok()?;
    let begins = |words: &str| {
        let after = bytes.get(1..).unwrap_or_default();
        !words.is_empty()
            && [bytes.as_slice(), after]
                .iter()
                .any(|at| at.starts_with(words.as_bytes()))
    };
    KINDS.lines().find_map(|kind| {
        let mut parts = kind.split('|');
        let (endings, words, kind) = (parts.next()?, parts.next()?, parts.next()?);
        let is_so = endings.split(' ').any(|known| known == ending) || begins(words);
        let expected = parts.next()?;
        is_so.then(|| format!("is {kind}, which is not read, expected {expected}"))
    })
}
