//! The file of an encounter model: sections that begin with a `# name` line.

use super::network::{Network, NetworkNode};
use super::{EncounterModel, Variable};
use crate::error::{InputError, read_text, shown};
use crate::number::finite;
use std::collections::HashMap;
use std::path::Path;

/// Most variables of a network.
const MOST_VARIABLES: usize = 100;
/// Most bins of a variable, and most counts of a network.
const MOST_BINS: usize = 1000;
const MOST_COUNTS: usize = 100_000_000;

/// Reads a model.
///
/// # Errors
/// An unreadable file; a section that is missing or appears twice; a section of the wrong size or with
/// anything but numbers; a variable without counts; a resample rate above 1; variables that depend on
/// each other in a circle; boundaries that do not increase.
pub fn read(path: &Path) -> Result<EncounterModel, InputError> {
    parse(&read_text(path)?, path)
}

/// Reads a model from `text`; errors name it `path`. See [`read`].
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, path: &Path) -> Result<EncounterModel, InputError> {
    let file = File::new(text, path)?;
    let labels = file.labels("labels_initial")?;
    let bins = file.bins("r_initial", labels.len())?;
    let initial = file.network("initial", &labels, &bins, 0)?;
    let boundaries = file.boundaries(&bins)?;
    let resample = file.numbers("resample_rates", labels.len())?;
    if let Some(rate) = resample.iter().find(|rate| **rate > 1.0) {
        let message = format!("holds {rate}, expected chances from 0 to 1");
        return Err(file.error("resample_rates", &message));
    }

    let later_labels = file.labels("labels_transition")?;
    let later_bins = file.bins("r_transition", later_labels.len())?;
    let transition = file.network("transition", &later_labels, &later_bins, labels.len())?;
    let becomes = later_labels
        .iter()
        .skip(labels.len())
        .zip(later_bins.iter().skip(labels.len()))
        .map(|(label, bins_later)| {
            let base = label.strip_suffix("(t+1)").map(str::trim);
            labels
                .iter()
                .position(|now| Some(now.as_str()) == base)
                .filter(|index| bins.get(*index) == Some(bins_later))
                .ok_or_else(|| {
                    let label = shown(label);
                    file.error(
                        "labels_transition",
                        &format!("has {label}, expected an initial variable with (t+1)"),
                    )
                })
        })
        .collect::<Result<Vec<usize>, InputError>>()?;
    if later_labels.len() < labels.len() {
        let message = "has fewer labels than labels_initial, expected them and those of (t+1)";
        return Err(file.error("labels_transition", message));
    }

    let variables = labels
        .into_iter()
        .zip(bins)
        .zip(boundaries)
        .zip(resample)
        .map(|(((label, bins), boundaries), resample_per_s)| Variable {
            label,
            bins,
            boundaries,
            resample_per_s,
        })
        .collect();
    Ok(EncounterModel {
        variables,
        initial,
        transition,
        becomes,
    })
}

/// The sections of a file.
struct File<'a> {
    path: &'a Path,
    /// Line of the section's name, and its lines.
    sections: HashMap<&'a str, (u64, Vec<&'a str>)>,
}

impl<'a> File<'a> {
    fn new(text: &'a str, path: &'a Path) -> Result<Self, InputError> {
        let mut sections: HashMap<&str, (u64, Vec<&str>)> = HashMap::new();
        let mut current = None;
        for (line, number) in text.lines().zip(1..) {
            let line = line.trim();
            if let Some(name) = line.strip_prefix('#') {
                current = Some(name.trim());
                let before = sections.insert(name.trim(), (number, Vec::new()));
                if let Some((first, _)) = before {
                    let name = shown(name.trim());
                    let message =
                        format!("section {name} is on line {first} already, expected it once");
                    return Err(InputError::at_line(path, number, message));
                }
            } else if !line.is_empty()
                && let Some((_, lines)) = current.and_then(|name| sections.get_mut(name))
            {
                lines.push(line);
            }
        }
        Ok(Self { path, sections })
    }

    fn error(&self, section: &str, message: &str) -> InputError {
        let line = self.sections.get(section).map(|(line, _)| *line);
        InputError::at(self.path, line, format!("section {section} {message}"))
    }

    fn lines(&self, section: &str) -> Result<&[&'a str], InputError> {
        self.sections
            .get(section)
            .map(|(_, lines)| lines.as_slice())
            .ok_or_else(|| self.error(section, "is missing, expected it"))
    }

    fn labels(&self, section: &str) -> Result<Vec<String>, InputError> {
        let labels: Vec<String> = self
            .lines(section)?
            .iter()
            .flat_map(|line| line.split(','))
            .map(|label| label.trim().trim_matches('"').to_owned())
            .filter(|label| !label.is_empty())
            .collect();
        if labels.is_empty() || labels.len() > MOST_VARIABLES {
            let found = labels.len();
            let message = format!("has {found} labels, expected 1 to {MOST_VARIABLES}");
            return Err(self.error(section, &message));
        }
        Ok(labels)
    }

    /// All numbers of a section, finite and not negative.
    fn numbers(&self, section: &str, expected: usize) -> Result<Vec<f64>, InputError> {
        let mut numbers = Vec::with_capacity(expected.min(1 << 20));
        for word in self
            .lines(section)?
            .iter()
            .flat_map(|l| l.split_whitespace())
        {
            match word.parse::<f64>() {
                Ok(number) if number.is_finite() && number >= 0.0 => numbers.push(number),
                _ => {
                    let message = format!("holds {}, expected a number from 0", shown(word));
                    return Err(self.error(section, &message));
                }
            }
        }
        if numbers.len() != expected {
            let found = numbers.len();
            let message = format!("has {found} numbers, expected {expected}");
            return Err(self.error(section, &message));
        }
        Ok(numbers)
    }

    fn bins(&self, section: &str, variables: usize) -> Result<Vec<usize>, InputError> {
        self.numbers(section, variables)?
            .into_iter()
            .map(|number| {
                (1..=MOST_BINS)
                    .find(|bins| *bins as f64 == number)
                    .ok_or_else(|| {
                        let message = format!("holds {number}, expected 1 to {MOST_BINS} bins");
                        self.error(section, &message)
                    })
            })
            .collect()
    }

    /// The network of sections `G_…` and `N_…`; the first `given` variables have no counts.
    fn network(
        &self,
        name: &str,
        labels: &[String],
        bins: &[usize],
        given: usize,
    ) -> Result<Network, InputError> {
        let graph_name = format!("G_{name}");
        let graph = self.numbers(&graph_name, bins.len() * bins.len())?;
        let counts_name = format!("N_{name}");
        let mut sizes = Vec::with_capacity(bins.len());
        let mut all_parents = Vec::with_capacity(bins.len());
        for (child, own) in bins.iter().enumerate() {
            let rows = graph.chunks(bins.len());
            let parents: Vec<usize> = rows
                .enumerate()
                .filter(|(_, row)| row.get(child).is_some_and(|link| *link != 0.0))
                .map(|(parent, _)| parent)
                .collect();
            let size = parents
                .iter()
                .try_fold(*own, |size, parent| {
                    size.checked_mul(bins.get(*parent).copied().unwrap_or(1))
                })
                .filter(|size| *size <= MOST_COUNTS)
                .ok_or_else(|| self.error(&graph_name, "asks for too many counts"))?;
            sizes.push(if child < given { 0 } else { size });
            all_parents.push(parents);
        }
        let total: usize = sizes.iter().sum();
        if total > MOST_COUNTS {
            return Err(self.error(&graph_name, "asks for too many counts"));
        }
        let counts = self.numbers(&counts_name, total)?;
        let mut rest = counts.as_slice();
        let mut nodes = Vec::with_capacity(bins.len());
        for ((bins, parents), size) in bins.iter().zip(all_parents).zip(sizes) {
            let (own, after) = rest.split_at_checked(size).unwrap_or_default();
            rest = after;
            let total: f64 = own.iter().sum();
            let can_be_drawn = own.is_empty() || (total > 0.0 && total.is_finite());
            if !can_be_drawn {
                let label = shown(labels.get(nodes.len()).map_or("", String::as_str));
                let message =
                    format!("has counts of {label} whose sum is {total}, expected a positive one");
                return Err(self.error(&counts_name, &message));
            }
            nodes.push(NetworkNode {
                bins: *bins,
                parents,
                counts: own.to_vec(),
            });
        }
        Network::new(nodes).ok_or_else(|| {
            let message = "has variables that depend on each other in a circle, expected none";
            self.error(&graph_name, message)
        })
    }

    fn boundaries(&self, bins: &[usize]) -> Result<Vec<Option<Vec<f64>>>, InputError> {
        let section = "boundaries";
        let lines = self.lines(section)?;
        if lines.len() != bins.len() {
            let (found, expected) = (lines.len(), bins.len());
            let message = format!("has {found} lines, expected {expected}, one a variable");
            return Err(self.error(section, &message));
        }
        lines
            .iter()
            .zip(bins)
            .map(|(line, bins)| {
                if *line == "*" {
                    return Ok(None);
                }
                let edges: Option<Vec<f64>> = line.split_whitespace().map(finite).collect();
                edges
                    .filter(|edges| {
                        edges.len() == bins + 1 && edges.is_sorted_by(|low, high| low < high)
                    })
                    .map(Some)
                    .ok_or_else(|| {
                        let line = shown(line);
                        let expected = bins + 1;
                        let message =
                            format!("holds {line}, expected * or {expected} growing numbers");
                        self.error(section, &message)
                    })
            })
            .collect()
    }
}
