//! Flies seventeen encounters on the emulated board, and prints what the decisions take: one `name,number` a line.
//!
//! `qemu-system-arm -M mps2-an500 -icount shift=0 -nographic -semihosting-config enable=on,target=native -kernel target`: an
//! instruction takes a nanosecond, and the system timer counts every fortieth.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {}

#[cfg(target_os = "none")]
mod board {
    use core::ffi::CStr;
    use core::fmt::Write as _;

    use cortex_m::peripheral::SYST;
    use cortex_m_semihosting::{debug, hio};
    use fga_c::*;
    use fga_cortex_m7::*;

    /// Instructions of a tick of the system timer: 25 MHz, and a nanosecond each.
    const TICK: u64 = 40;

    /// Drawn situations of each aircraft, by an environment variable of the build.
    const DRAWN: u32 = match option_env!("DRAWN") {
        Some(text) => number(text),
        None => 100,
    };

    const fn number(text: &str) -> u32 {
        let (bytes, mut at, mut value) = (text.as_bytes(), 0, 0);
        while at < bytes.len() {
            value = value * 10 + (bytes[at] - b'0') as u32;
            at += 1;
        }
        value
    }

    /// The stack below the present frame that is watched, bytes.
    const WATCHED: usize = 768 << 10;

    /// What an untouched word of it holds.
    const PAINT: u32 = 0xfade_fade;

    /// The painted stack: where it ends, above which are the frames of the program itself.
    struct Painted {
        top: usize,
        /// The deepest word that was ever used.
        dirty: usize,
    }

    impl Painted {
        /// Paints what was used below the present frame.
        #[inline(never)]
        fn paint(&mut self) {
            let mut at = self.dirty.max(self.top - WATCHED);
            while at < self.top {
                // SAFETY: below all frames, and above everything else in the memory of the board.
                unsafe { (at as *mut u32).write_volatile(PAINT) };
                at += 4;
            }
        }

        /// Bytes used below the top since it was painted.
        #[inline(never)]
        fn used(&mut self) -> usize {
            let mut at = self.top - WATCHED;
            // SAFETY: as above.
            while at < self.top && unsafe { (at as *const u32).read_volatile() } == PAINT {
                at += 4;
            }
            self.dirty = self.dirty.min(at);
            self.top - at
        }
    }

    /// What steps of a kind took.
    #[derive(Clone, Copy, Default)]
    struct Taken {
        steps: u64,
        instructions: u64,
        most: u64,
        stack: usize,
    }

    const KINDS: [&str; 3] = ["quiet", "kept", "choosing"];

    fn kind(decision: &fga_decision) -> usize {
        match decision.reason {
            _ if decision.state == fga_state::Cruise => 0,
            fga_reason::ManeuverChosen
            | fga_reason::ManeuverReplaced
            | fga_reason::BestAvailable
            | fga_reason::RejoinChosen => 2,
            _ => 1,
        }
    }

    #[panic_handler]
    fn stop(_: &core::panic::PanicInfo<'_>) -> ! {
        loop {
            debug::exit(debug::EXIT_FAILURE);
        }
    }

    #[inline(never)]
    fn run() -> Option<()> {
        let mut out = hio::hstdout().ok()?;
        // SAFETY: nobody else uses the timer.
        let mut timer = unsafe { cortex_m::Peripherals::steal() }.SYST;
        timer.set_clock_source(cortex_m::peripheral::syst::SystClkSource::Core);
        timer.set_reload(0x00ff_ffff);
        timer.clear_current();
        timer.enable_counter();

        // Some room for the frames of this function and of the printing.
        let mark = 0_u32;
        let top = ((&raw const mark).addr() & !7) - 512;
        let mut stack = Painted { top, dirty: 0 };
        stack.paint();
        stack.dirty = top;

        writeln!(out, "bytes of an avoider for {OBSTACLES_MOST} obstacles and {WAYPOINTS_MOST} waypoints,{AVOIDER_BYTES}").ok()?;
        writeln!(out, "bytes of beliefs,{FGA_BELIEFS_BYTES}").ok()?;
        writeln!(out, "bytes of a prover,{FGA_PROVER_BYTES}").ok()?;
        writeln!(out, "bytes of a decision,{}", size_of::<fga_decision>()).ok()?;

        let mut taken = [[Taken::default(); 3]; Aircraft::ALL.len()];
        let mut init_stack = 0;
        let mut hash = HASH_SEED;
        for (row, aircraft) in Aircraft::ALL.into_iter().enumerate() {
            stack.paint();
            let mut flight = Flight::new(aircraft)?;
            init_stack = init_stack.max(stack.used());
            for (encounter, obstacles) in aircraft.encounters() {
                let mut flown = [0_u32; 3];
                let (mut last, mut at) = (None, 0_u32);
                let square = flight.fly(u64::from(encounter) + 10, obstacles, |step, decision| {
                    stack.paint();
                    let before = SYST::get_current();
                    let status = step(decision);
                    let passed = before.wrapping_sub(SYST::get_current()) & 0x00ff_ffff;
                    let used = stack.used();
                    if !matches!(status, fga_status::Ok) {
                        debug::exit(debug::EXIT_FAILURE);
                    }
                    if last.replace(decision.reason) != Some(decision.reason) {
                        // SAFETY: the texts of the library live for ever.
                        let reason =
                            unsafe { CStr::from_ptr(fga_reason_text(decision.reason as u32)) };
                        let (reason, tenths) = (reason.to_str().unwrap_or("?"), at % 10);
                        let _ = writeln!(out, "# {}.{tenths} s: {reason}", at / 10);
                    }
                    at += 1;
                    let kind = kind(decision);
                    flown[kind] += 1;
                    let of = &mut taken[row][kind];
                    let instructions = u64::from(passed) * TICK;
                    of.steps += 1;
                    of.instructions += instructions;
                    of.most = of.most.max(instructions);
                    of.stack = of.stack.max(used);
                });
                let [quiet, kept, chosen] = flown;
                // Whole numbers: the formatting of reals is no part of what is measured.
                let clear = square >= 30.0 * 30.0;
                writeln!(
                    out,
                    "# encounter {encounter}, {}: {quiet} quiet, {kept} kept, {chosen} choosing; {}",
                    aircraft.name(),
                    if clear { "clear" } else { "inside a volume" }
                )
                .ok()?;
            }
            hash = flight.hash_of_drawn(DRAWN, hash);
        }
        writeln!(
            out,
            "bytes of stack to construct an avoider, beliefs and a prover,{init_stack}"
        )
        .ok()?;
        for (row, aircraft) in Aircraft::ALL.into_iter().enumerate() {
            for (kind, name) in KINDS.into_iter().enumerate() {
                let of = taken[row][kind];
                if of.steps == 0 {
                    continue;
                }
                let aircraft = aircraft.name();
                writeln!(out, "{aircraft} {name} steps,{}", of.steps).ok()?;
                writeln!(
                    out,
                    "{aircraft} {name} instructions mean,{}",
                    of.instructions / of.steps
                )
                .ok()?;
                writeln!(out, "{aircraft} {name} instructions most,{}", of.most).ok()?;
                writeln!(out, "{aircraft} {name} bytes of stack,{}", of.stack).ok()?;
            }
        }
        writeln!(out, "hash {hash:016x}").ok()?;
        Some(())
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let done = run();
        loop {
            debug::exit(if done.is_some() {
                debug::EXIT_SUCCESS
            } else {
                debug::EXIT_FAILURE
            });
        }
    }
}
