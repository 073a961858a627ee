//! `fga run`: flies one scenario or recording and shows the result.

use core::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use fga::situation::ProtectedVolume;
use fga_formats::number::fixed;
use fga_formats::words::counted;
use fga_formats::{InputError, conf, missions};
use fga_results::flight::{document, summary};
use fga_results::flight_files;
use fga_results::provenance::{Provenance, fingerprint};
use fga_sim::policy::PolicyChoice;
use fga_sim::run::{Plan, RunLog, fly};
use fga_sim::separation::Least;
use fga_sim::way_round;

use crate::common::{AnswerArgs, OutArgs, OverlayArgs, PolicyArgs, VehicleArgs, tell_failures};
use crate::failure::Failure;
use crate::live::LiveView;

/// Exit code of a run in which the aircraft entered a protected volume or the ground, broke a limit of altitude, or was on the wrong side of a
/// zone.
const ENTERED: u8 = 2;

/// Options of `fga run`.
#[derive(Args, Debug)]
pub(crate) struct RunArgs {
    /// A scenario (.toml), a recording (.daa), or a mission of QGroundControl (.plan) or Mission Planner (.waypoints).
    file: PathBuf,
    /// The aircraft of a recording that is the ownship; without it the file's first one.
    #[arg(long, value_name = "NAME")]
    ownship: Option<String>,
    /// Files of heights under a mission, which waypoints above the ground are above; again for each file.
    #[arg(long, value_name = "FILE")]
    terrain: Vec<PathBuf>,
    #[command(flatten)]
    policy: PolicyArgs,
    #[command(flatten)]
    vehicle: VehicleArgs,
    #[command(flatten)]
    overlay: OverlayArgs,
    /// Alerts and bands on the replay page, by a configuration in the .conf format of DAIDALUS.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    answer: AnswerArgs,
    /// Show the flight in the browser in real time.
    #[arg(long)]
    live: bool,
    /// With --live: speed as a multiple of real time.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, requires = "live", value_parser = factor)]
    speed: f64,
}

fn factor(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(factor) if factor.is_finite() && factor > 0.0 => Ok(factor),
        _ => Err("expected a number above 0".to_owned()),
    }
}

/// Flies the file and writes the output.
pub(crate) fn run(args: &RunArgs) -> Result<ExitCode, Failure> {
    let provenance = Provenance::begin();
    let policy = args.policy.choice()?;
    let overlay = args.overlay.choices(&policy)?;
    let guidance = args.config.as_deref().map(conf::read).transpose()?;
    let (ownship, terrain) = (args.ownship.as_deref(), args.terrain.as_slice());
    let (plan, source) = Plan::read_once(&args.file, args.vehicle.given()?, ownship, terrain)?;
    let input_hash = fingerprint(&source.bytes);
    if let Some(refusal) = plan.refusal() {
        return Err(InputError::in_file(&args.file, refusal).into());
    }
    say_beforehand(args, &plan, &source.notes);
    let mut policies = core::iter::once(&policy).chain(&overlay);
    let unknown = match (plan.world.zones.is_empty(), &plan.world.ground) {
        (true, None) => None,
        (true, Some(_)) => Some("no ground, which only judges"),
        (false, None) => Some("no zones, which only judge"),
        (false, Some(_)) => Some("no zones and no ground, which only judge"),
    };
    if let Some(unknown) = unknown {
        for policy in policies.clone().filter(|policy| !policy.knows_zones()) {
            let (shown, policy) = (args.file.display(), policy.name());
            eprintln!("fga: {shown}: warning: {policy} knows {unknown} its flight");
        }
    }
    if let Some(refusal) = policies.find_map(|policy| way_round::refusal(policy, &plan)) {
        return Err(InputError::in_file(&args.file, refusal).into());
    }
    let folder = args.out.prepare_run(&args.file)?;
    let overlaid = overlay
        .iter()
        .map(|policy| fly(plan.clone(), policy, &mut |_| ()))
        .collect::<Result<Vec<_>, _>>()?;
    let log = if args.live {
        let mut live = begin_live(&plan, &policy, args.speed)?;
        let log = fly(plan, &policy, &mut |moment| live.show(moment))?;
        live.end(&log);
        log
    } else {
        fly(plan, &policy, &mut |_| ())?
    };
    tell_failures(core::iter::once(&policy).chain(&overlay));
    let document = document(&provenance, (&args.file, &input_hash), &log, &overlaid);
    let guidance = guidance.as_ref().map(|read| &read.settings);
    flight_files::write_guided(&folder, &log, &overlaid, &document, guidance)?;
    args.answer
        .print(|| in_words(&log, &overlaid, &folder), &summary(&log))?;
    let is_clear = log.outcome.separated() && log.zones_kept() && log.ground_kept();
    Ok(if is_clear && log.limits_broken() == [false; 2] {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(ENTERED)
    })
}

/// Says on standard error who flies a file that names no vehicle, what of it is not flown, and what probably is not meant.
fn say_beforehand(args: &RunArgs, plan: &Plan, notes: &[String]) {
    let shown = args.file.display();
    let is_mission = missions::is_mission_file(&args.file);
    let is_recording = args.file.extension().is_some_and(|is| is == "daa");
    if args.vehicle.vehicle.is_none() && (is_mission || is_recording) {
        let kind = if is_mission { "mission" } else { "recording" };
        let name = &plan.model.name;
        eprintln!("a {kind} names no vehicle: {name} flies it; --vehicle names another");
    }
    for note in notes {
        eprintln!("fga: {shown}: {note}");
    }
    for warning in plan.warnings() {
        eprintln!("fga: {shown}: warning: {warning}");
    }
}

fn begin_live(plan: &Plan, policy: &PolicyChoice, speed: f64) -> Result<LiveView, Failure> {
    let live = LiveView::begin(plan, &policy.name(), speed)
        .map_err(|error| Failure::Input(format!("the live view cannot be served: {error}")))?;
    eprintln!("live at http://{}/", live.address());
    Ok(live)
}

/// The summary in words, with a line for each further flight.
pub(crate) fn in_words(log: &RunLog, overlaid: &[RunLog], folder: &Path) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = describe(&mut text, log, overlaid);
    let _ = writeln!(text, "results in {}", folder.display());
    text
}

/// One line for each obstacle, the nearest first.
fn describe_obstacles(text: &mut String, log: &RunLog) -> core::fmt::Result {
    let mut rows: Vec<_> = log.obstacles.iter().collect();
    rows.sort_by(|a, b| a.margin.value_m.total_cmp(&b.margin.value_m));
    if rows.is_empty() {
        writeln!(text, "no obstacles")?;
    } else {
        writeln!(
            text,
            "{:<24} {:>14} {:>9} {:>20} {:>10}",
            "obstacle", "separation (m)", "at (s)", "protected (m)", "margin (m)"
        )?;
    }
    for obstacle in rows {
        let name: String = obstacle
            .name
            .chars()
            .filter(|c| !c.is_control())
            .take(24)
            .collect();
        let protected = match obstacle.volume {
            ProtectedVolume::Sphere { radius_m } => format!("{radius_m:.1}"),
            ProtectedVolume::Cylinder {
                radius_m,
                half_height_m,
            } => format!("{radius_m:.1} x +-{half_height_m:.1}"),
        };
        if obstacle.separation.value_m.is_finite() {
            writeln!(
                text,
                "{name:<24} {:>14.2} {:>9.2} {protected:>20} {:>10.2}{}",
                obstacle.separation.value_m,
                obstacle.separation.time_s,
                obstacle.margin.value_m,
                if obstacle.margin.value_m < 0.0 {
                    "  ENTERED"
                } else {
                    ""
                }
            )?;
        } else {
            writeln!(
                text,
                "{name:<24} {:>14} {:>9} {protected:>20}",
                "never there", ""
            )?;
        }
    }
    Ok(())
}

/// One line for each zone.
fn describe_zones(text: &mut String, log: &RunLog) -> core::fmt::Result {
    for zone in &log.zones {
        let name: String = zone
            .name
            .chars()
            .filter(|c| !c.is_control())
            .take(24)
            .collect();
        let (kind, broken) = if zone.keep_in {
            ("keep in", "LEFT")
        } else {
            ("keep out", "ENTERED")
        };
        let Least { value_m, time_s } = zone.margin;
        let margin = if value_m >= 0.0 {
            format!("least distance {value_m:.2} m at {time_s:.2} s")
        } else {
            format!("{broken} by {:.2} m at {time_s:.2} s", -value_m)
        };
        writeln!(text, "zone {name} ({kind}): {margin}")?;
    }
    Ok(())
}

/// One line for the ground.
fn describe_ground(text: &mut String, log: &RunLog) -> core::fmt::Result {
    let Some((flown, ground)) = log.ground.as_ref().zip(log.plan.world.ground.as_ref()) else {
        return Ok(());
    };
    let Least { value_m, time_s } = flown.least;
    let (asked_m, error_m) = (ground.clearance_m(), ground.error_m());
    if value_m < 0.0 {
        write!(
            text,
            "ground: ENTERED by {:.1} m at {time_s:.2} s",
            -value_m
        )?;
    } else if value_m.is_finite() {
        write!(text, "ground: least height {value_m:.1} m at {time_s:.2} s")?;
    } else {
        write!(text, "ground: not known")?;
    }
    write!(
        text,
        ", {asked_m:.1} m of clearance and {error_m:.1} m of vertical error are asked for"
    )?;
    match flown.unknown_s {
        Some(from_s) => writeln!(text, "; over unknown ground first at {from_s:.2} s"),
        None => writeln!(text),
    }
}

/// One line for each conflict.
fn describe_conflicts(text: &mut String, log: &RunLog) -> core::fmt::Result {
    let at = |time_s: Option<f64>| time_s.map_or("never".into(), |t| format!("{t:.1} s"));
    let conflicts = log.conflicts();
    if conflicts.is_empty() {
        return match log.policy.as_str() {
            "none" => writeln!(text, "no policy looked for threats"),
            _ => writeln!(text, "nothing threatened"),
        };
    }
    for conflict in conflicts {
        let names: Vec<String> = conflict
            .obstacles
            .iter()
            .map(|id| {
                log.name_of(*id)
                    .chars()
                    .filter(|c| !c.is_control())
                    .collect()
            })
            .collect();
        writeln!(
            text,
            "threat seen {:.1} s{}; {}",
            conflict.threat_s,
            // A policy of one's own need not say what it avoids.
            if names.is_empty() {
                String::new()
            } else {
                format!(" ({})", names.join(", "))
            },
            match conflict.start_s {
                None => "no manoeuvre".to_owned(),
                Some(start_s) => format!(
                    "manoeuvre began {start_s:.1} s; clear {}; mission rejoined {}",
                    at(conflict.clear_s),
                    at(conflict.rejoined_s)
                ),
            }
        )?;
    }
    Ok(())
}

fn describe(text: &mut String, log: &RunLog, overlaid: &[RunLog]) -> core::fmt::Result {
    let outcome = &log.outcome;
    writeln!(
        text,
        "{}: policy {}, vehicle {}, {:.1} s flown",
        log.plan.name, log.policy, log.plan.model.name, outcome.end_s
    )?;
    describe_obstacles(text, log)?;
    describe_zones(text, log)?;
    describe_ground(text, log)?;
    describe_conflicts(text, log)?;
    writeln!(
        text,
        "largest distance from the mission {:.1} m, extra path {} m{}",
        outcome.max_cross_track_m,
        // Never -0.0.
        fixed(outcome.extra_path_m, 1),
        if outcome.mission_flown {
            ", mission flown to its end"
        } else {
            ""
        }
    )?;
    if let Some(farthest) = log
        .missed
        .iter()
        .max_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
    {
        writeln!(
            text,
            "{} of {} missed, waypoint {} by {:.1} m",
            log.missed.len(),
            counted(log.plan.world.mission_m.len(), "waypoint"),
            farthest.index + 1,
            farthest.distance_m
        )?;
    }
    let (floor_m, ceiling_m) = log.plan.world.limits_m;
    let limits = [("floor", floor_m), ("ceiling", ceiling_m)];
    for ((name, limit_m), _) in limits
        .into_iter()
        .zip(log.limits_broken())
        .filter(|limit| limit.1)
    {
        writeln!(text, "{name} of {limit_m:.1} m BROKEN")?;
    }
    let times = log.decision_times();
    writeln!(
        text,
        "decision time: median {:.2} us, 99 % {:.2} us, longest {:.2} us ({})",
        times.median_us,
        times.p99_us,
        times.max_us,
        counted(log.decisions.len(), "decision")
    )?;
    for log in overlaid {
        let least_m = log.outcome.min_margin_m;
        writeln!(
            text,
            "laid over the replay page: {}{}",
            log.policy,
            if least_m.is_finite() {
                format!(", least margin {least_m:.2} m")
            } else {
                String::new()
            }
        )?;
    }
    Ok(())
}
