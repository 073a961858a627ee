//! Streams a synthetic flight for the viewer's browser test: `cargo run -p fga-view --example
//! live_fixture [-- DIR]` prints the address of a live run; with a folder also the address of its
//! table. It ends when its standard input ends.

use core::net::{Ipv4Addr, SocketAddr};
use core::time::Duration;
use std::io::{self, Read as _};
use std::path::Path;
use std::{env, thread};

use fga::situation::ProtectedVolume;
use fga_report::replay::{
    LiveMessage, ReplayDecision, ReplayDecisionTime, ReplayEvent, ReplayFutures, ReplayObstacle,
    ReplayOutcome, ReplayPath, ReplayPathKind, ReplayPiece, ReplayRun, ReplaySample, ReplayState,
};
use fga_view::{Live, ServedFolder, Server};

const STEPS: u32 = 300;

fn main() -> io::Result<()> {
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
    let (server, live) = Server::live(address, "Live <flight>")?;
    println!("http://{}", server.address());
    let table = match env::args().nth(1) {
        Some(folder) => Some(Server::catalogue(
            address,
            ServedFolder::open(Path::new(&folder))?,
        )?),
        None => None,
    };
    if let Some(table) = &table {
        println!("http://{}", table.address());
    }
    // The first browser sees the run from its beginning.
    while live.listeners() == 0 {
        thread::sleep(Duration::from_millis(20));
    }
    fly(&live);
    io::stdin().read_to_end(&mut Vec::new())?;
    drop(table);
    Ok(())
}

/// Thirty seconds of flight in three.
fn fly(live: &Live) {
    let mut run = ReplayRun::named("turn-aware");
    run.mission_m = vec![[0.0, 0.0, 100.0], [600.0, 0.0, 100.0]];
    live.send(&LiveMessage::Run(Box::new(run)));
    live.send(&LiveMessage::Obstacle {
        run: 0,
        obstacle: intruder(),
    });
    let mut sample = ReplaySample {
        position_m: [0.0, 0.0, 100.0],
        ..ReplaySample::default()
    };
    for step in 0..=STEPS {
        sample.t_s = f64::from(step) * 0.1;
        sample.state = match step {
            80..160 => ReplayState::Avoiding,
            160..240 => ReplayState::Recovering,
            _ => ReplayState::Cruise,
        };
        sample.course_rad = match sample.state {
            ReplayState::Avoiding => 0.6,
            ReplayState::Recovering => -0.6,
            _ => 0.0,
        };
        sample.position_m[0] += 1.5 * sample.course_rad.cos();
        sample.position_m[1] += 1.5 * sample.course_rad.sin();
        live.send(&LiveMessage::Sample { run: 0, sample });
        if step % 80 == 0 {
            live.send(&LiveMessage::Decision {
                run: 0,
                decision: decision(&sample),
            });
            live.send(&LiveMessage::Event {
                run: 0,
                event: ReplayEvent {
                    t_s: sample.t_s,
                    text: format!("{:?}", sample.state).to_lowercase(),
                },
            });
        }
        live.send(&LiveMessage::DecisionTime {
            run: 0,
            time: ReplayDecisionTime {
                t_s: sample.t_s,
                decision_us: 12.0,
            },
        });
        thread::sleep(Duration::from_millis(10));
    }
    live.send(&LiveMessage::End {
        run: 0,
        outcome: Some(ReplayOutcome {
            min_margin_m: 7.25,
            t_s: 15.0,
            obstacle: 3,
        }),
    });
}

fn intruder() -> ReplayObstacle {
    ReplayObstacle {
        id: 3,
        name: "N3".into(),
        volume: ProtectedVolume::Cylinder {
            radius_m: 40.0,
            half_height_m: 30.0,
        },
        motion: vec![ReplayPiece {
            start_s: 0.0,
            position_m: [450.0, 0.0, 100.0],
            velocity_mps: [-10.0, 0.0, 0.0],
        }],
        present_s: None,
        known_from_s: Some(3.0),
    }
}

fn decision(sample: &ReplaySample) -> ReplayDecision {
    let [x, y, z] = sample.position_m;
    let is_avoiding = sample.state == ReplayState::Avoiding;
    let futures = ReplayFutures {
        obstacle: 3,
        ways: vec![(1.0, vec![[x + 300.0, 0.0, z], [x - 300.0, 0.0, z]])],
    };
    ReplayDecision {
        t_s: sample.t_s,
        state: sample.state,
        lines: vec![format!("Decided live at {:.1} s.", sample.t_s)],
        threat: is_avoiding.then_some(3),
        latest_start_s: None,
        paths: vec![ReplayPath {
            kind: ReplayPathKind::Chosen,
            margin_m: Some(7.25),
            points_m: vec![[x, y, z], [x + 80.0, y + 50.0, z]],
        }],
        p_loss: is_avoiding.then_some([0.4, 0.02]),
        futures: is_avoiding.then_some(futures).into_iter().collect(),
    }
}
