use std::io;

use fga_report::listing::Listing;

/// A table of runs and the page of each.
///
/// Implement it for results without files of their own, such as a campaign, which flies an encounter
/// again when somebody opens it.
pub trait Catalogue: Send + Sync + 'static {
    /// The table. The `link` of a row is the key for [`Self::page`], any text; the server makes an
    /// address of it.
    ///
    /// # Errors
    /// If the runs cannot be read.
    fn listing(&self) -> io::Result<Listing>;

    /// The page of a run; `None` for an unknown key. Keys come from the network: a client can ask for
    /// any text.
    ///
    /// # Errors
    /// If the page cannot be read or made.
    fn page(&self, key: &str) -> io::Result<Option<String>>;
}
