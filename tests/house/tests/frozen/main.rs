//! Results and emitted code as they were before the sources were sorted into rooms: the same bits, the same tokens.
//!
//! `UPDATE_SNAPSHOTS=1 cargo test -p mbs-house --test frozen` writes both files anew, which a change of an algorithm needs and a
//! change of names does not.
#![forbid(unsafe_code)]

mod results;
mod texts;
mod tokens;

use std::path::Path;
use std::{env, fs};

/// FNV-1a over 64 bits. Source: Fowler, Noll & Vo 1991.
struct Hash {
    bits: u64,
    /// Steps that were refused, and analyses.
    refused: u32,
}

impl Hash {
    fn new() -> Self {
        Hash { bits: 0xCBF2_9CE4_8422_2325, refused: 0 }
    }

    fn take(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.bits = (self.bits ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3);
        }
    }

    /// A step or an analysis that was refused counts by its place.
    fn refuse(&mut self, place: usize) {
        self.refused += 1;
        self.take(&place.to_le_bytes());
    }
}

/// Compares lines `name hash refusals` with a stored file, or stores them.
fn compare(file: &str, found: &[(String, Hash)]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/frozen").join(file);
    let text: String =
        found.iter().map(|(name, hash)| format!("{name} {:016x} {}\n", hash.bits, hash.refused)).collect();
    if env::var_os("UPDATE_SNAPSHOTS").is_some() {
        return fs::write(path, text).expect("a writable file");
    }
    let stored = fs::read_to_string(path).expect("a stored file");
    let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
    let (stored, found) = (lines(&stored), lines(&text));
    let missing: Vec<&String> = stored.iter().filter(|line| !found.contains(line)).collect();
    let new: Vec<&String> = found.iter().filter(|line| !stored.contains(line)).collect();
    assert!(missing.is_empty() && new.is_empty(), "{file}: stored {missing:#?}, found {new:#?}");
}

#[test]
fn results_have_the_same_bits() {
    let mut found = results::of::<f64>("f64");
    found.extend(results::of::<f32>("f32"));
    compare("results.txt", &found);
}

#[test]
fn emitted_code_has_the_same_tokens() {
    compare("tokens.txt", &tokens::of_catalogue());
}
