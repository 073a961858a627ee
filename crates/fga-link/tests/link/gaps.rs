//! Gaps in the telemetry, in every state of an encounter: the companion flies on a proven manoeuvre.

use crate::common::{GOOD, Intruder, World};
use fga::avoider::State;
use fga_emulator::PlaneMode;
use fga_link::authority::Authority;
use fga_link::traffic::{PlaceReport, ReportSender, ReportSource};
use mavlink::dialects::ardupilotmega::MavMessage;

const GAPS_S: [f64; 5] = [0.5, 1.0, 2.0, 3.0, 5.0];

/// After a longer time a vehicle that hears nothing turns back by itself (`GUIDED_TIMEOUT`), and nothing proves the
/// separation; seconds.
const PROVEN_S: f64 = 3.0;

/// The part that fails for a while.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Gap {
    /// All that the companion hears, heartbeats included; the vehicle hears it.
    Downlink,
    /// Position and attitude.
    Telemetry,
    /// The vehicle's processor stands still, and its clock with it.
    Frozen,
    /// Both ways.
    Cut,
}

/// The start of the gap.
#[derive(Debug, Clone, Copy, PartialEq)]
enum When {
    Cruise,
    Seen,
    Taking,
    InCommand,
    Turning,
    Recovering,
    Returning,
}

const STATES: [When; 7] = [
    When::Cruise,
    When::Seen,
    When::Taking,
    When::InCommand,
    When::Turning,
    When::Recovering,
    When::Returning,
];

fn is_at(world: &World, when: When) -> bool {
    let authority = world.companion.authority();
    let in_command = matches!(authority, Authority::InCommand { .. });
    let decided = world.companion.decision().map(|decision| decision.state);
    match when {
        When::Cruise => world.time_s >= 25.0,
        When::Seen => world.shown[0] && authority == Authority::Ready,
        When::Taking => matches!(authority, Authority::Taking { .. }),
        When::InCommand => in_command,
        When::Turning => in_command && world.emulator.plant().bank_rad().abs() > 0.5,
        When::Recovering => in_command && decided == Some(State::Recovering),
        When::Returning => matches!(authority, Authority::Returning { .. }),
    }
}

fn set(world: &mut World, gap: Gap, on: bool) {
    match gap {
        Gap::Downlink => world.deaf = on,
        Gap::Telemetry => world.no_telemetry = on,
        Gap::Frozen => world.frozen = on,
        Gap::Cut => world.cut = on,
    }
}

/// Flies an encounter with a gap; returns the fault, in words.
fn fly(gap: Gap, when: When, gap_s: f64) -> Vec<String> {
    let name = format!("{gap:?} of {gap_s} s in {when:?}");
    let mut wrong = Vec::new();
    let mut world = World::new("", GOOD, 3);
    world.add(Intruder::head_on());
    world.run_while(140.0, &name, |w| !is_at(w, when));
    set(&mut world, gap, true);
    world.run_until(world.time_s + gap_s);
    set(&mut world, gap, false);
    let end_s = world.time_s + 1.0;
    let able = |world: &World| {
        let authority = world.companion.authority();
        authority == Authority::Ready
            || world.companion.owed().is_some() && !matches!(authority, Authority::Released { .. })
    };
    while world.time_s < end_s && !able(&world) {
        world.step();
    }
    if !able(&world) {
        wrong.push(format!(
            "{name}: not able 1 s after: {:?}",
            world.companion.authority()
        ));
    }
    // Without a target for long the vehicle circles, and the way back is long.
    world.run_until(if gap == Gap::Cut { 200.0 } else { 150.0 });
    if std::env::var("FGA_GAP").is_ok_and(|wanted| wanted == name) {
        for line in world.companion.take_log() {
            eprintln!("{line}");
        }
    }
    let changes = world.emulator.mode_changes().len();
    if changes != 2 {
        wrong.push(format!("{name}: {:?}", world.emulator.mode_changes()));
    }
    let proven = gap != Gap::Cut || gap_s <= PROVEN_S;
    if proven && world.least_m[0].0 < 60.0 {
        wrong.push(format!("{name}: {:.1} m", world.least_m[0].0));
    }
    if world.mode() != PlaneMode::Auto {
        wrong.push(format!("{name}: {:?}", world.mode()));
    }
    wrong
}

fn all(gap: Gap) -> Vec<String> {
    let cases = STATES
        .into_iter()
        .flat_map(|when| GAPS_S.map(|gap_s| (when, gap_s)));
    cases
        .flat_map(|(when, gap_s)| fly(gap, when, gap_s))
        .collect()
}

#[test]
fn a_gap_of_the_telemetry_is_flown_through() {
    let wrong = all(Gap::Telemetry);
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_companion_that_hears_nothing_flies_on() {
    let wrong = all(Gap::Downlink);
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_vehicle_whose_clock_stood_still_is_flown_on() {
    let wrong = all(Gap::Frozen);
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_cut_link_is_flown_through() {
    let wrong = all(Gap::Cut);
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A stalled link delivers what waited all at once: the reports' places are as old as the telemetry that waited with them, also where a
/// report comes first.
#[test]
fn reports_that_waited_in_a_stalled_link_show_no_false_velocity() {
    for begins_s in [0.0, 0.1] {
        let mut world = World::new("", GOOD, 3);
        world.add(Intruder::head_on());
        world.run_while(140.0, "the turn", |w| !is_at(w, When::Turning));
        world.run_until(world.time_s + begins_s);
        let open_s = world.time_s + 3.0;
        while world.time_s < open_s {
            world.network.delay_s = open_s - world.time_s;
            world.step();
        }
        world.network = GOOD;
        world.run_until(150.0);
        let texts = world.emulator.texts();
        let false_velocity = texts.iter().find(|text| text.contains("false velocity"));
        assert_eq!(false_velocity, None, "{begins_s}");
        assert_eq!(world.emulator.mode_changes().len(), 2);
        assert!(world.least_m[0].0 >= 60.0, "{:?}", world.least_m);
    }
}

/// A receiver stands still, and what it has missed comes at once, with the time of its arrival.
#[test]
fn reports_that_waited_in_a_stalled_feed_show_no_false_velocity() {
    for (stall_s, every_s) in [(10.0, 1.0), (10.0, 0.5), (4.0, 1.0)] {
        let mut world = World::new("", GOOD, 3);
        let sender = ReportSender::receiver(ReportSource::Sbs, "feed");
        let flights = [
            Intruder::straight(0x00AB_0001, [800.0, 2000.0, 160.0], [0.0, -60.0, 0.0]),
            Intruder::straight(0x00AB_0002, [-900.0, 200.0, 170.0], [30.0, 40.0, 0.0]),
        ];
        let (mut next_s, mut waiting) = (20.0, Vec::new());
        let open_s = 30.0 + stall_s;
        while world.time_s < 60.0 {
            world.step();
            if world.time_s >= next_s {
                next_s += every_s;
                for flight in &flights {
                    let mut here = *flight;
                    for (at, rate) in here.position_m.iter_mut().zip(flight.velocity_mps) {
                        *at += rate * (world.time_s - 20.0);
                    }
                    waiting.push(world.report_of(&here));
                }
            }
            if (30.0..open_s).contains(&world.time_s) {
                continue;
            }
            for message in waiting.drain(..) {
                let MavMessage::ADSB_VEHICLE(data) = message else {
                    panic!("no report");
                };
                let now_s = world.time_s;
                let report = PlaceReport::from_adsb(&data, sender, now_s, 15.0).expect("a place");
                world.companion.take_report(&report, now_s);
            }
        }
        let texts = world.emulator.texts();
        let false_velocity = texts.iter().find(|text| text.contains("false velocity"));
        assert_eq!(false_velocity, None, "{stall_s} {every_s}");
    }
}
