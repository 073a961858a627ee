use std::io;

use fga_report::listing::Listing;

/// What there is to look at: a table of runs and the page of each.
///
/// Implement it for results that do not lie in files of their own, such as a campaign's, whose
/// encounters are flown again when they are opened.
pub trait Catalogue: Send + Sync + 'static {
    /// The table. The `link` of a row is the key that [`Self::page`] takes, any text; the server
    /// makes an address of it.
    ///
    /// # Errors
    /// If the runs cannot be read.
    fn listing(&self) -> io::Result<Listing>;

    /// The page of a run; `None` where there is none of this key. Keys come from the network:
    /// any text can be asked for.
    ///
    /// # Errors
    /// If it cannot be read or made.
    fn page(&self, key: &str) -> io::Result<Option<String>>;
}
