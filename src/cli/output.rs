//! Where results go, and how they are told.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Duration;

use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::Failure;

/// Where results go.
#[derive(Args, Debug, Clone, Default)]
pub struct Output {
    /// Folder for the results [default: the first free of out/NAME, out/NAME_2, ...].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Replace files that are already there.
    #[arg(long)]
    pub force: bool,
}

/// The folder of a run, with nothing in the way of what will be written.
pub struct Folder {
    path: PathBuf,
    /// Files written so far.
    pub written: Vec<PathBuf>,
}

impl Output {
    /// Finds the folder and makes sure that nothing there is overwritten; writes nothing yet.
    pub fn folder(&self, name: &str, files: &[&str]) -> Result<Folder, Failure> {
        let name: String =
            name.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { '_' }).collect();
        let path = match &self.out {
            Some(path) => path.clone(),
            None if self.force => Path::new("out").join(name),
            None => (1..)
                .map(|i| Path::new("out").join(if i == 1 { name.clone() } else { format!("{name}_{i}") }))
                .find(|path| !path.exists())
                .unwrap_or_default(),
        };
        free(files.iter().map(|file| path.join(file)), self.force)?;
        Ok(Folder { path, written: Vec::new() })
    }
}

/// Makes sure that none of these files is there, unless they may be replaced.
pub fn free(files: impl Iterator<Item = PathBuf>, replace: bool) -> Result<(), Failure> {
    let there: Vec<String> =
        files.filter(|f| !replace && f.exists()).map(|f| f.display().to_string()).collect();
    if there.is_empty() { Ok(()) } else { Err(Failure::InTheWay(there)) }
}

/// Makes sure that a folder is new or empty, unless files in it may be replaced.
pub fn free_folder(folder: &Path, replace: bool) -> Result<(), Failure> {
    let empty = match std::fs::read_dir(folder) {
        Ok(mut inside) => inside.next().is_none(),
        // No folder: a file in its place is in the way, and what else there is shows when it is made.
        Err(_) => !folder.is_file(),
    };
    if empty || (replace && folder.is_dir()) {
        return Ok(());
    }
    Err(Failure::InTheWay(vec![folder.display().to_string()]))
}

/// Makes a folder, and makes sure that it can be written to.
pub fn create_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder)
        .and_then(|()| tempfile_in(folder))
        .map_err(|source| Failure::Io { what: folder.display().to_string(), source })
}

/// Makes sure that files can be written where they shall be, before long work is done for them.
pub fn can_write<'a>(files: impl Iterator<Item = &'a PathBuf>) -> Result<(), Failure> {
    for file in files {
        let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        tempfile_in(folder).map_err(|source| Failure::Io { what: file.display().to_string(), source })?;
    }
    Ok(())
}

/// Writes an empty file in a folder and takes it away again.
fn tempfile_in(folder: &Path) -> std::io::Result<()> {
    let probe = folder.join(format!(".burgeon-{}", std::process::id()));
    std::fs::File::create(&probe)?;
    std::fs::remove_file(probe)
}

/// A path from the root, told by its parts: `o/` is `o`.
pub fn whole(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()).components().collect()
}

impl Folder {
    /// Whether a path is its own, or leads to one of these files in it or below one.
    pub fn holds(&self, path: &Path, names: &[&str]) -> bool {
        let (path, own) = (whole(path), whole(&self.path));
        path == own || names.iter().any(|name| path.starts_with(own.join(name)))
    }

    /// Makes the folder, and makes sure that it can be written to.
    pub fn create(&self) -> Result<(), Failure> {
        create_folder(&self.path)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The path of a file about to be written.
    pub fn file(&mut self, name: &str) -> PathBuf {
        let path = self.path.join(name);
        self.written.push(path.clone());
        path
    }

    /// Writes a text file, whole or not at all.
    pub fn text(&mut self, name: &str, text: &str) -> Result<(), Failure> {
        let path = self.file(name);
        burgeon::files::write_whole(&path, &[text.as_bytes()])
            .map_err(|source| Failure::Io { what: path.display().to_string(), source })
    }

    /// Where the results are, in one line.
    pub fn line(&self) -> String {
        let names: Vec<_> =
            self.written.iter().filter_map(|p| p.file_name()).map(|n| n.to_string_lossy()).collect();
        format!("{}: {}", self.path.display(), names.join(", "))
    }
}

/// Why a line could not be printed, the first time one could not.
static UNSAID: OnceLock<std::io::Error> = OnceLock::new();

/// Prints a line; a reader that has gone away is no error, another failure is told at the end: [`unsaid`].
pub fn say(line: impl core::fmt::Display) {
    if let Err(why) = writeln!(std::io::stdout(), "{line}")
        && why.kind() != std::io::ErrorKind::BrokenPipe
    {
        // Only the first failure is told.
        let _ = UNSAID.set(why);
    }
}

/// Why something could not be printed, if that was so.
pub fn unsaid() -> Option<&'static std::io::Error> {
    UNSAID.get()
}

/// A bar on the terminal, none elsewhere. `what` follows the count.
pub fn progress(total: u64, what: &'static str) -> ProgressBar {
    let target = match std::io::stderr().is_terminal() {
        true => ProgressDrawTarget::stderr(),
        false => ProgressDrawTarget::hidden(),
    };
    let bar = ProgressBar::with_draw_target(Some(total), target);
    let template = format!("{what} {{pos}}/{{len}} {{bar:24}} {{msg}} · {{per_sec}} · {{eta}} left");
    if let Ok(style) = ProgressStyle::with_template(&template) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(500));
    bar
}

/// A number with thousands set apart.
pub fn grouped(n: u32) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
