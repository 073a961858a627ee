//! The hash of the drawn situations on this machine.

#[cfg(not(target_os = "none"))]
fn main() {
    use fga_cortex_m7::{Aircraft, Flight, HASH_SEED};
    let text = std::env::args().nth(1).expect("a number of situations");
    let count: u32 = text.parse().expect("a number of situations");
    let mut hash = HASH_SEED;
    for aircraft in Aircraft::ALL {
        let mut flight = Flight::new(aircraft).expect("a flight");
        hash = flight.hash_of_drawn(count, hash);
    }
    println!("hash {hash:016x}");
}

#[cfg(target_os = "none")]
compile_error!("for a machine with an operating system");
