//! `fga view`: a folder of runs, or a campaign, in the browser.

use core::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use fga_formats::InputError;
use fga_view::{ServedFolder, Server};

use crate::campaign_catalogue::CampaignCatalogue;
use crate::common::{listen_address, print};
use crate::failure::Failure;

/// Options of `fga view`.
#[derive(Args, Debug)]
pub(crate) struct ViewArgs {
    /// A folder of runs, of batches, of a single run, or of a campaign.
    path: PathBuf,
    /// Address to listen on; port 0 takes a free one.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8787", value_parser = listen_address)]
    listen: SocketAddr,
}

/// Serves the folder until the program ends.
pub(crate) fn run(args: &ViewArgs) -> Result<ExitCode, Failure> {
    if args.path.is_file() {
        return Err(InputError::in_file(&args.path, "is a file, expected a folder").into());
    }
    let folder = ServedFolder::open(&args.path)
        .map_err(|error| InputError::unreadable(&args.path, &error))?;
    let server = match CampaignCatalogue::open(&args.path)? {
        Some(campaign) => Server::catalogue(args.listen, campaign),
        None => Server::catalogue(args.listen, folder),
    };
    let server = server
        .map_err(|error| Failure::Input(format!("cannot listen on {}: {error}", args.listen)))?;
    print(&format!("http://{}/\n", server.address()))?;
    server.wait();
    Ok(ExitCode::SUCCESS)
}
