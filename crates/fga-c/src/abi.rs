//! The version of this interface, and what both sides of it assume.

/// Version of this interface. It grows when a program compiled with an older header can no longer be linked.
pub const FGA_ABI_VERSION: u32 = 1;

/// Alignment of all storage, bytes.
pub const FGA_ALIGN: usize = 16;

/// Most obstacles and most waypoints for which an avoider can have room, and most aircraft of reports.
pub const FGA_CAPACITY_MOST: u32 = 65_536;

/// The version of the interface of the linked library: the program's header has it as `FGA_ABI_VERSION`.
#[unsafe(no_mangle)]
pub const extern "C" fn fga_abi_version() -> u32 {
    FGA_ABI_VERSION
}
