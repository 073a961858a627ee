//! The origin of results: `run.json`.

use std::time::{Instant, SystemTime, UNIX_EPOCH};

use fga_formats::build;
pub use fga_sim::fingerprint::fingerprint;
use serde_json::{Value, json};

/// The target of this build, for `run.json` and the table of a campaign.
pub const TARGET: &str = env!("FGA_TARGET");

/// Starts with the command.
#[derive(Debug)]
pub struct Provenance {
    begun: Instant,
    begun_unix_s: f64,
}

impl Provenance {
    /// Marks the start of the command.
    pub fn begin() -> Self {
        Self {
            begun: Instant::now(),
            begun_unix_s: SystemTime::now()
                .duration_since(UNIX_EPOCH)
                .map_or(0.0, |since| since.as_secs_f64()),
        }
    }

    /// Seconds since the command began.
    pub fn elapsed_s(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    /// The origin of results; `more` adds the command's figures.
    pub fn to_json(&self, command: &str, configuration: &Value, more: Value) -> Value {
        let mut document = json!({
            "command": command,
            "version": env!("CARGO_PKG_VERSION"),
            "commit": build::commit(),
            "target": TARGET,
            "configuration_hash": fingerprint(configuration.to_string().as_bytes()),
            "configuration": configuration,
            "begun_unix_s": self.begun_unix_s,
            "wall_s": self.elapsed_s(),
        });
        if let (Some(document), Value::Object(more)) = (document.as_object_mut(), more) {
            document.extend(more);
        }
        document
    }
}
