#!/bin/sh
# Seals the static library that Cargo builds: one object whose only global symbols are `fga_*`.
#
#   seal.sh BUILT.a SEALED.a
#
# Cargo's archive also holds the compiler's own runtime, whose hidden `sqrt`, `fmod`, `floor`, ... would take the place of the
# C library's in the program that links it. Linker and objcopy are those of the Rust toolchain, which know every ELF target;
# LD, OBJCOPY and AR name others.
set -eu
root=$(rustc --print sysroot)
tools=$root/lib/rustlib/$(rustc --print host-tuple)/bin
scratch=$(mktemp -d "$2.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
# Only what the interface needs of the archive.
"${LD:-$tools/gcc-ld/ld.lld}" -r --undefined=fga_abi_version -o "$scratch/fga.o" "$1"
# Its own library lies in the toolchain.
LD_LIBRARY_PATH="$root/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}" \
  "${OBJCOPY:-$tools/rust-objcopy}" --wildcard --keep-global-symbol='fga_*' "$scratch/fga.o"
"${AR:-ar}" rcs "$scratch/fga.a" "$scratch/fga.o"
mv "$scratch/fga.a" "$2"
