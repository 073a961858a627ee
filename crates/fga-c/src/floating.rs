//! The floating-point environment of a call: the default one, whatever the caller's is.
//!
//! Inside, a quotient by zero is a number like others, and the compiler divides before it knows whether the quotient is needed.
//! A program that traps such operations must not see them; one that rounds otherwise or flushes small numbers to zero must get
//! the same decisions. So a call holds the caller's environment, its flags included, and gives it back unchanged.

#[cfg(target_arch = "x86_64")]
mod registers {
    use core::arch::asm;

    /// Control and flags of SSE, in which all numbers are computed.
    pub(super) type Environment = u32;

    /// To the nearest, nothing trapped, no flag set.
    static DEFAULT: u32 = 0x1F80;

    pub(super) fn hold() -> Environment {
        let mut held = 0_u32;
        // SAFETY: reads the register and writes a value that it may have.
        unsafe {
            asm!(
                "stmxcsr [{held}]", "ldmxcsr [{default}]",
                held = in(reg) &raw mut held, default = in(reg) &raw const DEFAULT, options(nostack),
            );
        }
        held
    }

    pub(super) fn give_back(held: Environment) {
        // SAFETY: writes what the register had.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const held, options(nostack)) }
    }
}

#[cfg(target_arch = "aarch64")]
mod registers {
    use core::arch::asm;

    /// Control and flags.
    pub(super) type Environment = (u64, u64);

    pub(super) fn hold() -> Environment {
        let (control, flags): (u64, u64);
        // SAFETY: reads the registers and writes values that they may have: to the nearest, nothing trapped, no flag set.
        unsafe {
            asm!(
                "mrs {control}, fpcr", "mrs {flags}, fpsr", "msr fpcr, xzr", "msr fpsr, xzr",
                control = out(reg) control, flags = out(reg) flags, options(nostack),
            );
        }
        (control, flags)
    }

    pub(super) fn give_back((control, flags): Environment) {
        // SAFETY: writes what the registers had.
        unsafe {
            asm!("msr fpcr, {}", "msr fpsr, {}", in(reg) control, in(reg) flags, options(nostack));
        }
    }
}

/// Elsewhere it is the caller's: a microcontroller traps nothing.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
mod registers {
    pub(super) type Environment = ();

    pub(super) const fn hold() -> Environment {}

    pub(super) const fn give_back((): Environment) {}
}

/// Computes in the default environment.
pub(crate) fn by_default<T>(compute: impl FnOnce() -> T) -> T {
    let held = registers::hold();
    let answer = apart(compute);
    registers::give_back(held);
    answer
}

/// Not inlined: else the compiler may compute a number before the environment is held.
#[inline(never)]
fn apart<T>(compute: impl FnOnce() -> T) -> T {
    compute()
}
