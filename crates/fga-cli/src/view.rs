//! `fga view`: a folder of runs in the browser.

use core::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use fga_view::{Folder, Server};

use crate::common::print;
use crate::failure::Failure;

/// Options of `fga view`.
#[derive(Args, Debug)]
pub(crate) struct ViewArgs {
    /// A folder of runs, of batches, or of a single run.
    path: PathBuf,
    /// Address to answer on; port 0 takes a free one.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8787")]
    listen: SocketAddr,
}

/// Serves the folder until the program is ended.
pub(crate) fn run(args: &ViewArgs) -> Result<ExitCode, Failure> {
    let folder = Folder::open(&args.path)
        .map_err(|error| Failure::Input(format!("{}: {error}", args.path.display())))?;
    let server = Server::catalogue(args.listen, folder)
        .map_err(|error| Failure::Input(format!("cannot answer on {}: {error}", args.listen)))?;
    print(&format!("http://{}/\n", server.address()))?;
    server.wait();
    Ok(ExitCode::SUCCESS)
}
