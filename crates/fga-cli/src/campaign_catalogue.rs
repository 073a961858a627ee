//! A campaign in the browser: its worst encounters; a click flies one again.

use std::io;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use fga_campaign::campaign::{Campaign, CampaignError, Folder, Manifest, Row, RowFiles};
use fga_report::listing::{Listing, ListingRow, ListingTally};
use fga_sim::policy::PolicyChoice;
use fga_view::Catalogue;

use fga_results::replay_page;
use fga_results::worst::Worst;

/// Most rows listed, over all policies.
const MOST_ROWS: usize = 5_000;

/// Offset that ranks lost but avoidable flights before every margin, metres.
const FIRST_M: f64 = 1e9;

/// Most flights on one page: as many as keys can switch.
const MOST_FLIGHTS: usize = 9;

/// A campaign for the browser, which flies an encounter again on request, with the code of
/// `fga campaign show`.
pub(crate) struct CampaignCatalogue {
    folder: Folder,
    campaign: Campaign,
    /// The last listing, and the files that it came from.
    listed: Mutex<Option<(RowFiles, Listing)>>,
    /// Flies one encounter at a time, however many requests come.
    flying: Mutex<()>,
}

impl CampaignCatalogue {
    /// The campaign of a folder; `None` if the folder holds none.
    pub(crate) fn open(path: &Path) -> Result<Option<Self>, CampaignError> {
        let folder = Folder::at(path);
        let Some(Manifest { configuration, .. }) = folder.manifest()? else {
            return Ok(None);
        };
        let catalogue = Self {
            campaign: Campaign::new(configuration, path)?,
            folder,
            listed: Mutex::default(),
            flying: Mutex::default(),
        };
        // Reports a damaged table at once, not in the browser.
        catalogue.read()?;
        Ok(Some(catalogue))
    }

    /// The listing, read again only when the files change.
    fn read(&self) -> Result<Listing, CampaignError> {
        // The data behind a poisoned lock is complete: it is replaced in one step.
        let mut listed = self.listed.lock().unwrap_or_else(PoisonError::into_inner);
        let files = RowFiles::of(&self.folder)?;
        if let Some((known, listing)) = &*listed
            && *known == files
        {
            return Ok(listing.clone());
        }
        let listing = self.list(&files)?;
        *listed = Some((files, listing.clone()));
        Ok(listing)
    }

    fn list(&self, files: &RowFiles) -> Result<Listing, CampaignError> {
        let policies = &self.campaign.policies;
        let of_each = MOST_ROWS.div_ceil(policies.len().max(1));
        // Lost but avoidable flights come first.
        let mut worst: Vec<Worst<Row>> = policies.iter().map(|_| Worst::new(of_each)).collect();
        let mut tallies = vec![ListingTally::default(); policies.len()];
        let mut flights = 0_u64;
        files.read(&self.campaign, |row| {
            flights += 1;
            let place = row.policy as usize;
            if let (Some(worst), Some(tally)) = (worst.get_mut(place), tallies.get_mut(place)) {
                let is_first = !row.separated && row.avoidable() == Some(true);
                let rank_m = if is_first {
                    row.min_margin_m - FIRST_M
                } else {
                    row.min_margin_m
                };
                worst.take([rank_m, row.min_separation_m], *row);
                tally.take(row.separated, row.avoidable());
            }
        })?;
        let rows: Vec<ListingRow> = worst
            .into_iter()
            .flat_map(Worst::into_items)
            .map(|row| self.row(&row))
            .collect();
        let names = &self.campaign.configuration.policies;
        let shares = names
            .iter()
            .zip(tallies)
            .map(|(name, tally)| tally.shares(name.clone()))
            .collect();
        Ok(Listing {
            title: format!("Campaign {}", self.campaign.configuration.name),
            note: self.note(flights, rows.len() as u64, of_each),
            shares,
            rows,
        })
    }

    fn note(&self, flights: u64, listed: u64, of_each: usize) -> String {
        let configuration = &self.campaign.configuration;
        let policies = configuration.policies.len() as u64;
        let mut sentences = vec![format!(
            "{} of {} encounters flown, each by {policies} {}.",
            flights / policies.max(1),
            configuration.encounters,
            if policies == 1 { "policy" } else { "policies" }
        )];
        if listed < flights {
            sentences.push(format!(
                "Of {flights} flights the {listed} with the least margin are listed, {of_each} of \
                 each policy; those lost although avoidable come first."
            ));
        }
        sentences.push("An encounter is flown again when it is opened.".into());
        let version = env!("CARGO_PKG_VERSION");
        if configuration.version != version {
            sentences.push(format!(
                "The campaign was flown by version {}, this is {version}: what is shown may differ.",
                configuration.version
            ));
        }
        sentences.join(" ")
    }

    fn row(&self, row: &Row) -> ListingRow {
        let name = |names: &[String], index: u32| names.get(index as usize).cloned();
        let finite = |value: f64| value.is_finite().then_some(value);
        ListingRow {
            name: row.encounter.to_string(),
            source: name(self.campaign.source_names(), row.source).unwrap_or_default(),
            policy: name(&self.campaign.configuration.policies, row.policy).unwrap_or_default(),
            separated: Some(row.separated),
            avoidable: row.avoidable(),
            min_margin_m: finite(row.min_margin_m),
            max_cross_track_m: finite(row.max_cross_track_m),
            extra_path_m: finite(row.extra_path_m),
            link: Some(format!("{}/{}", row.encounter, row.policy)),
        }
    }

    /// The encounter and the policies of a key, the requested one first.
    fn asked(&self, key: &str) -> Option<(u64, Vec<PolicyChoice>)> {
        let (encounter, first) = key.split_once('/')?;
        let encounter = encounter.parse().ok()?;
        let mut policies = self.campaign.policies.clone();
        let first: usize = first.parse().ok()?;
        if first >= policies.len() || encounter >= self.campaign.configuration.encounters {
            return None;
        }
        policies[..=first].rotate_right(1);
        policies.truncate(MOST_FLIGHTS);
        Some((encounter, policies))
    }
}

impl Catalogue for CampaignCatalogue {
    fn listing(&self) -> io::Result<Listing> {
        self.read().map_err(io::Error::other)
    }

    fn page(&self, key: &str) -> io::Result<Option<String>> {
        let Some((encounter, policies)) = self.asked(key) else {
            return Ok(None);
        };
        let _flying = self.flying.lock().unwrap_or_else(PoisonError::into_inner);
        let logs = policies
            .iter()
            .map(|policy| self.campaign.show(encounter, policy))
            .collect::<Result<Vec<_>, _>>()
            .map_err(io::Error::other)?;
        Ok(Some(replay_page::page(&logs)))
    }
}
