//! The place in a file's name, as in `N47E008.hgt`, `n47_e008_1arc_v3.dt2` or `Copernicus_DSM_10_N47_00_E008_00_DEM.tif`.

use super::Area;

/// South-west corner in a name: latitude and longitude, degrees; `None` without any.
///
/// # Errors
/// A place that no square degree has, such as 180° east.
pub(super) fn corner(file_name: &str) -> Result<Option<[f64; 2]>, String> {
    let name = file_name.to_ascii_uppercase();
    let found = (0..name.len()).find_map(|at| name.get(at..).and_then(begins));
    let Some((text, latitude, longitude)) = found else {
        return Ok(None);
    };
    let signed = |(letter, degrees): (char, u16), negative: char| {
        let zero_is_ambiguous = degrees == 0 && letter == negative;
        let sign = if letter == negative { -1.0 } else { 1.0 };
        (!zero_is_ambiguous).then_some(sign * f64::from(degrees))
    };
    match (signed(latitude, 'S'), signed(longitude, 'W')) {
        (Some(south), Some(west))
            if (-90.0..90.0).contains(&south) && (-180.0..180.0).contains(&west) =>
        {
            Ok(Some([south, west]))
        }
        _ => Err(format!(
            "has the place {text} in its name, expected a south-west corner from S90 to N89 and from W180 to E179, with N00 and E000 for zero"
        )),
    }
}

type Letter = (char, u16);

/// The place at the beginning of a text.
fn begins(text: &str) -> Option<(String, Letter, Letter)> {
    let (latitude, rest) = part(text, ['N', 'S'], 2)?;
    // Copernicus writes the minutes, which are always 00.
    let rest = rest.strip_prefix("_00").unwrap_or(rest);
    let rest = rest.strip_prefix('_').unwrap_or(rest);
    let (longitude, _) = part(rest, ['E', 'W'], 3)?;
    let text = format!(
        "{}{:02}{}{:03}",
        latitude.0, latitude.1, longitude.0, longitude.1
    );
    Some((text, latitude, longitude))
}

fn part(text: &str, letters: [char; 2], digits: usize) -> Option<(Letter, &str)> {
    let letter = text.chars().next().filter(|c| letters.contains(c))?;
    let number = text.get(1..=digits)?;
    let all = number.bytes().all(|byte| byte.is_ascii_digit());
    let degrees = number.parse().ok().filter(|_| all)?;
    let rest = text.get(digits + 1..)?;
    (!rest.starts_with(|c: char| c.is_ascii_digit())).then_some(((letter, degrees), rest))
}

/// Refuses a file whose content is elsewhere than its name.
pub(super) fn agrees(file_name: &str, area: &Area) -> Result<(), String> {
    let Ok(Some([south_deg, west_deg])) = corner(file_name) else {
        return Ok(());
    };
    let named = Area::of([south_deg, west_deg, south_deg + 1.0, west_deg + 1.0]);
    if named.overlaps(area) {
        return Ok(());
    }
    Err(format!(
        "holds {area}, expected the square degree of its name, {named}; is a hemisphere wrong?"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_in_names_are_found() {
        for (name, place) in [
            ("N47E008.hgt", Some([47.0, 8.0])),
            ("s34w071.SRTMGL1.hgt.gz", Some([-34.0, -71.0])),
            ("n47_e008_1arc_v3.dt2", Some([47.0, 8.0])),
            (
                "Copernicus_DSM_COG_10_S01_00_W180_00_DEM.tif",
                Some([-1.0, -180.0]),
            ),
            ("valley.tif", None),
            ("N470E008.hgt", None),
            ("é.tif", None),
        ] {
            assert_eq!(corner(name).unwrap(), place, "{name}");
        }
        for name in ["N90E008.hgt", "N47E180.hgt", "S00E008.hgt", "N47W000.hgt"] {
            let error = corner(name).unwrap_err();
            assert!(error.contains(&name[..7]), "{error}");
        }
    }
}
