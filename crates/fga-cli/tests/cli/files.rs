//! `fga init`, `fga check`, `fga completions` and `fga man`.

use std::fs;

use crate::support::{errors, fga_in, repository};

#[test]
fn each_kind_of_file_that_init_writes_is_usable_and_flies() {
    let folder = tempfile::tempdir().unwrap();
    for kind in ["scenario", "vehicle", "campaign", "link"] {
        let written = fga_in(folder.path(), &["init", kind]);
        assert!(written.status.success(), "{kind}: {}", errors(&written));
        let file = format!("{kind}.toml");
        let checked = fga_in(folder.path(), &["check", &file]);
        let said = String::from_utf8_lossy(&checked.stdout);
        assert!(checked.status.success(), "{kind}: {}", errors(&checked));
        assert!(said.contains(&format!("a usable {kind} file")), "{said}");
    }
    let flown = fga_in(
        folder.path(),
        &["run", "scenario.toml", "--vehicle", "vehicle.toml"],
    );
    assert_eq!(flown.status.code(), Some(0), "{}", errors(&flown));
    let campaign = ["campaign", "run", "campaign.toml", "--encounters", "8"];
    let flown = fga_in(folder.path(), &campaign);
    assert_eq!(flown.status.code(), Some(0), "{}", errors(&flown));
}

#[test]
fn init_leaves_a_file_that_is_there_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    fs::write(&path, "mine").unwrap();
    let refused = fga_in(folder.path(), &["init", "scenario", "mine.toml"]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(errors(&refused).contains("mine.toml exists already"));
    assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
}

#[test]
fn check_reads_every_shipped_file() {
    for folder in ["scenarios", "vehicles", "campaigns", "campaigns/league"] {
        let entries = fs::read_dir(repository().join(folder)).unwrap();
        let paths = entries.map(|entry| entry.unwrap().path());
        for path in paths.filter(|path| path.is_file()) {
            let checked = fga_in(&repository(), &["check", &path.display().to_string()]);
            assert!(checked.status.success(), "{}", errors(&checked));
        }
    }
}

#[test]
fn check_names_the_file_and_what_is_wrong_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text, expected) in [
        (
            "a.toml",
            "name = 'a'\nduration_s = 10\n[mission]\nwaypoints_km = []",
            "a.toml, line 4",
        ),
        ("b.toml", "speed = 3", "b.toml: is of no kind"),
        (
            "c.toml",
            "[vehicle]\nmax_bank_deg = 400.0",
            "vehicle.max_bank_deg is 400",
        ),
        (
            "d.toml",
            "[vehicle]\n\nmax_bnk_deg = 40.0",
            "d.toml, line 3: unknown field",
        ),
        ("e.csv", "", "e.csv"),
        ("f.daa", "", "f.daa"),
        ("g.xyz", "", "cannot be checked"),
        ("h.txt", "", "h.txt"),
        (
            "i.plan",
            "{}",
            "i.plan, line 1: is no plan of QGroundControl",
        ),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
        let checked = fga_in(folder.path(), &["check", name]);
        let said = errors(&checked);
        assert_eq!(checked.status.code(), Some(1), "{name}: {said}");
        assert!(said.contains(expected), "{name}: {said}");
        assert_eq!(said.trim_end().lines().count(), 1, "{name}: {said}");
    }
    let missing = fga_in(folder.path(), &["check", "nothing.toml", "--json"]);
    assert_eq!(missing.status.code(), Some(1));
}

#[test]
fn completions_and_manual_pages_know_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let bash = fga_in(folder.path(), &["completions", "bash"]);
    assert!(String::from_utf8_lossy(&bash.stdout).contains("campaign"));
    let man = fga_in(folder.path(), &["man", "--out", "pages"]);
    assert!(man.status.success(), "{}", errors(&man));
    for page in ["fga.1", "fga-run.1", "fga-check.1"] {
        assert!(folder.path().join("pages").join(page).exists(), "{page}");
    }
}

/// By their first bytes or by their endings.
#[test]
fn check_names_the_kinds_of_files_that_no_command_reads() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes, expected) in [
        (
            "a.bin2",
            &b"GRIB\0"[..],
            "is weather in GRIB, which is not read, expected heights as GeoTIFF",
        ),
        (
            "a.shp",
            b"\0\0\x27\x0a",
            "is a part of a shapefile, which is not read, expected its areas as GeoJSON",
        ),
        ("a.weird", b"\x89HDF\r\n", "is HDF5, which is not read"),
        (
            "a.asc",
            b"ncols 3",
            "is an ASCII grid of Esri, which is not read",
        ),
        ("a.laz", b"LASF", "is a cloud of points, which is not read"),
        (
            "a.sbs.xz",
            b"\xfd7zXZ",
            "is compressed by another program than gzip, which is not read",
        ),
        ("a.igc", b"AXXX001", "is a flight of IGC, which is not read"),
    ] {
        fs::write(folder.path().join(name), bytes).unwrap();
        let checked = fga_in(folder.path(), &["check", name]);
        assert_eq!(checked.status.code(), Some(1), "{name}");
        let said = errors(&checked);
        assert!(
            said.starts_with(&format!("fga: {name}: {expected}")),
            "{said}"
        );
    }
}
