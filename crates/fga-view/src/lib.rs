//! Shows runs in the browser: a folder of them ([`Server::catalogue`]), or a running one
//! ([`Server::live`]).
//!
//! The server listens on the given address, usually 127.0.0.1, in its own thread.
//! It reads and never writes. It protects against:
//!
//! - a page of another site that asks through the browser: on loopback the server answers only to
//!   `localhost` and IP addresses, so a foreign name that points here gets nothing, and it sends
//!   live runs only to its own pages;
//! - a request for a file elsewhere: it serves only replay pages inside the folder, and follows no
//!   symbolic link out of it;
//! - a page in the folder that somebody else wrote: it serves replays sandboxed, without access
//!   to anything else on the server;
//! - a slow or vanished browser: a live run hands its messages over without ever waiting;
//! - any number of connections, idle or greedy: at most 32 at once, each with limits on time and memory.

extern crate alloc;

mod catalogue;
mod connections;
mod folder;
mod guard;
mod live;
mod server;

pub use catalogue::Catalogue;
pub use folder::ServedFolder;
pub use live::Live;
pub use server::Server;
