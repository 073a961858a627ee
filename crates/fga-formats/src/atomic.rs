//! Writes files completely or not at all.
//!
//! The output goes to a temporary file in the same folder, which takes the final name only when
//! all data is on its way to the disk. If anything fails earlier, or the program ends, the previous
//! file is untouched.

use crate::error::OutputError;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::{NamedTempFile, TempDir};

/// A file under construction. It gets its name in [`AtomicFile::commit`]; dropped earlier, it leaves
/// nothing behind.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    writer: BufWriter<NamedTempFile>,
}

impl AtomicFile {
    /// Begins the file `path`, of a link the file behind it; its folder must exist.
    ///
    /// # Errors
    /// A missing or unwritable folder, or a path that is itself a folder, a device or a pipe.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let linked = if path.is_symlink() {
            fs::canonicalize(path).ok()
        } else {
            None
        };
        let path = linked.as_deref().unwrap_or(path);
        let failed = |error| OutputError::new(path, error);
        let Some(name) = path.file_name().filter(|_| !path.is_dir()) else {
            return Err(failed(io::ErrorKind::IsADirectory.into()));
        };
        // Its place would be taken by a file.
        if path.exists() && !path.is_file() {
            let words = "a device or a pipe, expected a file or a new name";
            return Err(failed(io::Error::other(words)));
        }
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let mut prefix = std::ffi::OsString::from(".");
        prefix.push(name);
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(".part");
        // A new file gets the usual rights (the umask still applies), not the private ones of a temporary file.
        #[cfg(unix)]
        let rights = {
            use std::os::unix::fs::PermissionsExt as _;
            fs::Permissions::from_mode(0o666)
        };
        #[cfg(unix)]
        builder.permissions(rights);
        let file = builder
            .tempfile_in(folder)
            .map_err(|error| failed(bare(&error)))?;
        Ok(Self {
            path: path.into(),
            writer: BufWriter::with_capacity(1 << 16, file),
        })
    }

    /// Finishes the file and gives it its name, replacing a previous file.
    ///
    /// # Errors
    /// The rest of the data cannot be written; the previous file is then unchanged.
    pub fn commit(self) -> Result<(), OutputError> {
        let Self { path, writer } = self;
        let file = writer
            .into_inner()
            .map_err(|error| OutputError::new(&path, error.into_error()))?;
        file.persist(&path)
            .map_err(|error| OutputError::new(&path, error.error))?;
        Ok(())
    }
}

/// Files of a folder under construction: all of them get their place in [`AtomicFolder::commit`]; dropped
/// earlier, they leave nothing behind.
#[derive(Debug)]
pub struct AtomicFolder {
    path: PathBuf,
    temporary: TempDir,
}

impl AtomicFolder {
    /// Begins files of the folder `path`, which is made if it is missing.
    ///
    /// # Errors
    /// A folder that cannot be made or that is not writable.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        prepare_folder(path)?;
        let temporary = tempfile::Builder::new()
            .prefix(".fga")
            .suffix(".part")
            .tempdir_in(path)
            .map_err(|error| OutputError::new(path, bare(&error)))?;
        Ok(Self {
            path: path.into(),
            temporary,
        })
    }

    /// Where the files go until all are complete.
    pub fn path(&self) -> &Path {
        self.temporary.path()
    }

    /// An error about one of the files, with the name that it would have got.
    pub fn named(&self, error: OutputError) -> OutputError {
        match error.path.strip_prefix(self.path()) {
            Ok(name) => OutputError::new(self.path.join(name), error.source),
            Err(_) => error,
        }
    }

    /// Gives the files their places, also in folders below; one of the same name is replaced, others stay.
    ///
    /// # Errors
    /// A file that cannot be moved.
    pub fn commit(self) -> Result<(), OutputError> {
        move_all(self.temporary.path(), &self.path)
    }
}

fn move_all(from: &Path, to: &Path) -> Result<(), OutputError> {
    let failed = |error| OutputError::new(to, error);
    for entry in fs::read_dir(from).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let place = to.join(entry.file_name());
        if place.is_dir() && entry.path().is_dir() {
            move_all(&entry.path(), &place)?;
        } else {
            fs::rename(entry.path(), &place).map_err(|error| OutputError::new(&place, error))?;
        }
    }
    Ok(())
}

/// The error without the name of the temporary file, which means nothing to the user.
fn bare(error: &io::Error) -> io::Error {
    error.kind().into()
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

/// Writes the file `path` with `write`, completely or not at all.
///
/// # Errors
/// A missing or unwritable folder, or any error of `write`.
///
/// ```
/// # fn main() -> Result<(), fga_formats::OutputError> {
/// use std::io::Write as _;
///
/// let folder = tempfile::tempdir().expect("a temporary folder");
/// let path = folder.path().join("results.csv");
/// fga_formats::atomic::write_with(&path, |file| writeln!(file, "encounter,separated"))?;
/// # Ok(())
/// # }
/// ```
pub fn write_with(
    path: &Path,
    write: impl FnOnce(&mut AtomicFile) -> io::Result<()>,
) -> Result<(), OutputError> {
    let mut file = AtomicFile::create(path)?;
    write(&mut file).map_err(|error| OutputError::new(path, error))?;
    file.commit()
}

/// Writes `contents` as the file `path`, completely or not at all.
///
/// # Errors
/// As [`write_with`].
pub fn write(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), OutputError> {
    write_with(path, |file| file.write_all(contents.as_ref()))
}

/// Makes the folder `path` and its parents, and proves that it accepts a file.
///
/// Call this before a long computation, so that an unwritable folder is reported at once.
///
/// # Errors
/// A folder that cannot be made or that is not writable.
pub fn prepare_folder(path: &Path) -> Result<(), OutputError> {
    fs::create_dir_all(path).map_err(|error| {
        let error = match error.kind() {
            io::ErrorKind::AlreadyExists => io::ErrorKind::NotADirectory.into(),
            _ => error,
        };
        OutputError::new(path, error)
    })?;
    tempfile::Builder::new()
        .prefix(".fga")
        .suffix(".part")
        .tempfile_in(path)
        .map_err(|error| OutputError::new(path, bare(&error)))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn nothing_is_left_when_writing_fails() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write(&path, "before").unwrap();
        let error = write_with(&path, |file| {
            file.write_all(&vec![b'x'; 1 << 18])?;
            Err(io::ErrorKind::StorageFull.into())
        })
        .unwrap_err();
        assert!(
            error
                .to_string()
                .ends_with("a.csv cannot be written: the disk is full")
        );
        assert_eq!(fs::read_to_string(&path).unwrap(), "before");
        assert_eq!(names(folder.path()), ["a.csv"]);
    }

    /// An earlier version put a file in the place of a device.
    #[cfg(unix)]
    #[test]
    fn a_link_is_written_through_and_what_is_no_file_stays() {
        let folder = tempfile::tempdir().unwrap();
        let [real, link, socket] =
            ["real.csv", "link.csv", "socket"].map(|name| folder.path().join(name));
        write(&real, "one").unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        write(&link, "two").unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read_to_string(&real).unwrap(), "two");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        let error = write(&socket, "three").unwrap_err().to_string();
        assert!(error.contains("expected a file"), "{error}");
        assert!(!socket.is_file());
    }

    #[test]
    fn a_second_write_replaces_the_first() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write(&path, "one").unwrap();
        write(&path, "two").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "two");
        assert_eq!(names(folder.path()), ["a.csv"]);
    }

    #[test]
    fn a_folder_gets_all_of_its_files_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("many");
        let below = path.join("below");
        fs::create_dir_all(&below).unwrap();
        write(&below.join("z.csv"), "z").unwrap();
        let fill = || {
            let many = AtomicFolder::create(&path).unwrap();
            fs::create_dir(many.path().join("below")).unwrap();
            for name in ["a.csv", "below/b.csv"] {
                write(&many.path().join(name), name).unwrap();
            }
            many
        };
        drop(fill());
        assert_eq!(names(&path), ["below"]);
        assert_eq!(names(&below), ["z.csv"]);
        let many = fill();
        let error = OutputError::new(many.path().join("a.csv"), io::ErrorKind::StorageFull.into());
        assert_eq!(many.named(error).path, path.join("a.csv"));
        many.commit().unwrap();
        assert_eq!(names(&path), ["a.csv", "below"]);
        assert_eq!(names(&below), ["b.csv", "z.csv"]);
    }

    #[test]
    fn folders_that_cannot_be_used_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("no").join("a.csv");
        let error = write(&missing, "").unwrap_err().to_string();
        assert!(
            error.ends_with("a.csv cannot be written: there is no such file or folder"),
            "{error}"
        );
        let error = write(folder.path(), "").unwrap_err().to_string();
        assert!(
            error.ends_with("it is a folder, expected a file"),
            "{error}"
        );
        let file = folder.path().join("file");
        write(&file, "").unwrap();
        for path in [file.clone(), file.join("below")] {
            let error = prepare_folder(&path).unwrap_err().to_string();
            assert!(
                error.ends_with("a part of its path is a file, expected a folder"),
                "{error}"
            );
        }
        prepare_folder(&folder.path().join("x").join("y")).unwrap();
    }
}
