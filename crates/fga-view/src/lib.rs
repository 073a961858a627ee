//! Shows runs in the browser: a folder of them ([`Server::catalogue`]), or one while it goes on
//! ([`Server::live`]).
//!
//! The server answers on the address it is given, as a rule 127.0.0.1, from a thread of its own.
//! It reads and never writes. What it protects against:
//!
//! - a page of another site that asks it through the browser: on loopback it answers to the names
//!   `localhost` and IP addresses alone, so that a foreign name that points here gets nothing,
//!   and live runs to pages of its own alone;
//! - a request for a file elsewhere: of a folder it serves replay pages alone, never what lies
//!   outside it, not through symbolic links either;
//! - a page in the folder that somebody else wrote: replays are served sandboxed, without access
//!   to anything else on the server;
//! - a slow or vanished browser: a live run hands its messages over without ever waiting.

extern crate alloc;

mod catalogue;
mod folder;
mod guard;
mod live;
mod server;

pub use catalogue::Catalogue;
pub use folder::Folder;
pub use live::Live;
pub use server::Server;
