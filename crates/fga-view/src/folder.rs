use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use fga_report::listing::{Listing, ListingRow, shares_of};
use serde_json::Value;

use crate::Catalogue;

/// The text of a regular file; `None` for anything else under its name: a pipe would never end.
fn read_regular(path: &Path) -> Option<String> {
    path.is_file().then(|| fs::read_to_string(path).ok())?
}

/// Deepest folder searched.
const MAX_DEPTH: usize = 6;
/// Most rows listed.
const MAX_ROWS: usize = 200_000;

/// A folder of runs: each folder below it with a `run.json` is a run or a batch.
///
/// The page of a run is its `replay.html`, of an encounter of a batch `replay/<encounter>.html`.
#[derive(Debug, Clone)]
pub struct ServedFolder {
    root: PathBuf,
}

impl ServedFolder {
    /// Opens a folder.
    ///
    /// # Errors
    /// If it is not a folder or is unreadable.
    pub fn open(path: &Path) -> io::Result<Self> {
        let root = path.canonicalize()?;
        if !root.is_dir() {
            let message = format!("{}: expected a folder", path.display());
            return Err(io::Error::new(io::ErrorKind::NotADirectory, message));
        }
        Ok(Self { root })
    }

    fn collect(&self, folder: &Path, depth: usize, rows: &mut Vec<ListingRow>) -> io::Result<()> {
        if let Some(text) = read_regular(&folder.join("run.json")) {
            // The folder may hold any file: an entry that does not parse is no run.
            let document: Value = serde_json::from_str(&text).unwrap_or_default();
            if document.get("command").and_then(Value::as_str) == Some("campaign") {
                rows.push(self.campaign(folder, &document));
            } else if folder.join("results.csv").is_file() {
                self.batch(folder, &document, rows);
            } else if document.is_object() {
                rows.push(self.run(folder, &document));
            }
        }
        if depth == MAX_DEPTH {
            return Ok(());
        }
        let mut below: Vec<PathBuf> = fs::read_dir(folder)?
            .filter_map(Result::ok)
            // The type of the entry itself: links are not followed.
            .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()))
            .map(|entry| entry.path())
            .collect();
        below.sort();
        for folder in below {
            if rows.len() >= MAX_ROWS {
                break;
            }
            // One unreadable folder must not hide the others.
            let _ = self.collect(&folder, depth + 1, rows);
        }
        Ok(())
    }

    /// A campaign: only `Server` with a campaign catalogue can list its encounters.
    fn campaign(&self, folder: &Path, document: &Value) -> ListingRow {
        let name = document.pointer("/configuration/name");
        ListingRow {
            name: format!(
                "{} ({}, a campaign: view its folder)",
                self.relative(folder),
                name.and_then(Value::as_str).unwrap_or_default()
            ),
            ..ListingRow::default()
        }
    }

    fn run(&self, folder: &Path, document: &Value) -> ListingRow {
        let text = |key: &str| document.get(key).and_then(Value::as_str);
        let number = |key: &str| document.get(key).and_then(Value::as_f64);
        let place = self.relative(folder);
        let name = match (text("name"), place.as_str()) {
            (Some(name), "") => name.to_owned(),
            (Some(name), place) if place.rsplit('/').next() != Some(name) => {
                format!("{place} ({name})")
            }
            (_, place) => place.to_owned(),
        };
        ListingRow {
            name,
            policy: text("policy").unwrap_or_default().to_owned(),
            source: String::new(),
            avoidable: None,
            separated: document.get("separated").and_then(Value::as_bool),
            min_margin_m: number("min_margin_m"),
            max_cross_track_m: number("max_cross_track_m"),
            extra_path_m: number("extra_path_m"),
            link: self.link(&folder.join("replay.html")),
        }
    }

    /// A row for each encounter of a batch; skips a line that does not parse.
    fn batch(&self, folder: &Path, document: &Value, rows: &mut Vec<ListingRow>) {
        let Ok(mut reader) = csv::Reader::from_path(folder.join("results.csv")) else {
            return;
        };
        let Ok(header) = reader.headers().cloned() else {
            return;
        };
        let column = |name: &str| header.iter().position(|title| title == name);
        let (Some(encounter), separated) = (column("encounter"), column("separated")) else {
            return;
        };
        let margin = column("min_margin_m");
        let cross_track = column("max_cross_track_m");
        let extra_path = column("extra_path_m");
        let policy = document.get("policy").and_then(Value::as_str);
        let place = self.relative(folder);
        for record in reader.records().filter_map(Result::ok) {
            if rows.len() >= MAX_ROWS {
                return;
            }
            let number = |column: Option<usize>| record.get(column?)?.parse::<f64>().ok();
            let Some(encounter) = record.get(encounter) else {
                continue;
            };
            let file = folder.join("replay").join(format!("{encounter}.html"));
            rows.push(ListingRow {
                name: if place.is_empty() {
                    encounter.to_owned()
                } else {
                    format!("{place} {encounter}")
                },
                policy: policy.unwrap_or_default().to_owned(),
                source: String::new(),
                avoidable: None,
                separated: separated.and_then(|c| record.get(c)?.parse().ok()),
                min_margin_m: number(margin),
                max_cross_track_m: number(cross_track),
                extra_path_m: number(extra_path),
                link: self.link(&file),
            });
        }
    }

    fn relative(&self, path: &Path) -> String {
        let below = path.strip_prefix(&self.root).unwrap_or(path);
        let parts: Vec<_> = below.iter().map(|part| part.to_string_lossy()).collect();
        parts.join("/")
    }

    /// The key of a page, if [`Catalogue::page`] serves it.
    fn link(&self, file: &Path) -> Option<String> {
        let key = self.relative(file);
        self.resolve(&key).map(|_| key)
    }

    /// The file of a key: a replay page inside the folder, with links resolved and checked.
    fn resolve(&self, key: &str) -> Option<PathBuf> {
        let below = Path::new(key);
        let plain = below
            .components()
            .all(|c| matches!(c, Component::Normal(_)));
        let is_replay = below.file_name()? == "replay.html"
            || (below.extension()? == "html"
                && below.parent().and_then(Path::file_name)? == "replay");
        if !plain || !is_replay {
            return None;
        }
        let file = self.root.join(below).canonicalize().ok()?;
        (file.starts_with(&self.root) && file.is_file()).then_some(file)
    }
}

impl Catalogue for ServedFolder {
    fn listing(&self) -> io::Result<Listing> {
        let mut rows = Vec::new();
        self.collect(&self.root, 0, &mut rows)?;
        let name = self.root.file_name();
        Ok(Listing {
            title: name.map_or_else(|| "Runs".to_owned(), |n| n.to_string_lossy().into_owned()),
            note: if rows.len() >= MAX_ROWS {
                format!("There are more than these {MAX_ROWS} runs.")
            } else {
                String::new()
            },
            shares: shares_of(&rows),
            rows,
        })
    }

    fn page(&self, key: &str) -> io::Result<Option<String>> {
        self.resolve(key).map(fs::read_to_string).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(folder: &Path, file: &str, text: &str) {
        let path = folder.join(file);
        fs::create_dir_all(path.parent().expect("below a folder")).expect("create");
        fs::write(path, text).expect("write");
    }

    #[cfg(unix)]
    #[test]
    fn l14_a_pipe_under_the_name_of_a_run_is_passed_over() {
        let home = tempfile::tempdir().expect("folder");
        write(home.path(), "a/run.json", r#"{"name":"a"}"#);
        fs::create_dir(home.path().join("b")).expect("create");
        let pipe = home.path().join("b/run.json");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        if !made.is_ok_and(|status| status.success()) {
            assert!(std::env::var("CI").is_err(), "mkfifo is missing");
            eprintln!("skipped: mkfifo is missing");
            return;
        }
        let folder = ServedFolder::open(home.path()).expect("open");
        assert_eq!(folder.listing().expect("listing").rows.len(), 1);
    }

    #[test]
    fn runs_and_batches_are_listed_with_their_pages() {
        let home = tempfile::tempdir().expect("folder");
        let run = r#"{"name":"head-on","policy":"none","separated":false,"min_margin_m":-4.5}"#;
        write(home.path(), "a/run.json", run);
        write(home.path(), "a/replay.html", "page");
        let results = "encounter,separated,min_separation_m,min_margin_m,start_s,clear_s,\
             max_cross_track_m,extra_path_m\n7,true,32.0,2.0,1.5,9.0,12.5,3.25\n8,true,40,10,,,0,0\n";
        write(home.path(), "b/run.json", r#"{"policy":"published"}"#);
        write(home.path(), "b/results.csv", results);
        write(home.path(), "b/replay/7.html", "seven");
        write(home.path(), "c/run.json", "not JSON");
        let campaign = r#"{"command":"campaign","configuration":{"name":"night"}}"#;
        write(home.path(), "d/run.json", campaign);
        write(home.path(), "d/results.csv", results);
        let folder = ServedFolder::open(home.path()).expect("open");
        let rows = folder.listing().expect("listing").rows;
        let seen: Vec<_> = rows
            .iter()
            .map(|r| {
                (
                    r.name.as_str(),
                    r.separated,
                    r.min_margin_m,
                    r.link.as_deref(),
                )
            })
            .collect();
        assert_eq!(
            seen,
            [
                (
                    "a (head-on)",
                    Some(false),
                    Some(-4.5),
                    Some("a/replay.html")
                ),
                ("b 7", Some(true), Some(2.0), Some("b/replay/7.html")),
                ("b 8", Some(true), Some(10.0), None),
                ("d (night, a campaign: view its folder)", None, None, None),
            ]
        );
        let page = folder.page("b/replay/7.html").expect("read");
        assert_eq!(page.as_deref(), Some("seven"));
    }

    #[test]
    fn nothing_outside_the_folder_is_given_out() {
        let home = tempfile::tempdir().expect("folder");
        write(home.path(), "secret/replay.html", "secret");
        write(home.path(), "runs/a/replay.html", "page");
        write(home.path(), "runs/a/track.csv", "t_s");
        let folder = ServedFolder::open(&home.path().join("runs")).expect("open");
        let outside = home.path().join("secret/replay.html");
        for key in [
            "../secret/replay.html",
            "a/../../secret/replay.html",
            &outside.to_string_lossy(),
            "a/track.csv",
            "a",
            "",
            "a/./../a/replay.html",
            "a\0/replay.html",
        ] {
            assert_eq!(folder.page(key).expect("no error"), None, "{key:?}");
        }
        #[cfg(unix)]
        {
            fs::create_dir_all(home.path().join("runs/a/replay")).expect("create");
            std::os::unix::fs::symlink(&outside, home.path().join("runs/a/replay/x.html"))
                .expect("link");
            assert_eq!(folder.page("a/replay/x.html").expect("no error"), None);
        }
    }
}
