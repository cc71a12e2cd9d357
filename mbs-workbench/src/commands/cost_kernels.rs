//! Sines of motions from drives: programs with the features `fma` and `libm` of the runtime, and their points.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use super::CommandError;
use super::of_file::first_that_compiles;
use crate::cost::kernels;
use crate::cost::points::Point;
use crate::forge::{Blueprint, Forge};
use crate::setting::Kernel;
use crate::target_directory::target_directory;

/// Flag of the compiler for fused products.
const FUSED: &str = "-C target-feature=+fma";

/// Sines beside the runtime's own.
const KERNELS: [Kernel; 2] = [Kernel::Fused, Kernel::Library];

/// `true` where the processor has fused products.
fn is_fused() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::is_x86_feature_detected!("fma");
    #[cfg(not(target_arch = "x86_64"))]
    return cfg!(target_arch = "aarch64");
}

fn file(directory: &Path, kernel: Kernel) -> PathBuf {
    directory.join(format!("{}.json", kernel.feature().unwrap_or("own")))
}

/// Builds a program for each kernel, of the first of `blueprints` that compiles, and runs it with `words`; the directory with their points.
///
/// # Errors
/// A program does not build, or its study fails.
pub fn compared(
    forge: &Forge,
    blueprints: &[Blueprint],
    words: &[OsString],
) -> Result<PathBuf, CommandError> {
    let name = blueprints.first().map_or("", |blueprint| &blueprint.name);
    let directory = target_directory().join("mbs").join(format!("{name}_sines"));
    fs::create_dir_all(&directory)
        .map_err(|error| CommandError::Failed(format!("cannot make {}: {error}", directory.display())))?;
    for kernel in KERNELS {
        let path = file(&directory, kernel);
        // Points of an earlier study are not those of this one.
        let _ = fs::remove_file(&path);
        let Some(feature) = kernel.feature().filter(|_| kernel != Kernel::Fused || is_fused()) else {
            continue;
        };
        // Flags of the compiler hold for all crates, so their results have a directory of their own.
        let own = match kernel {
            Kernel::Fused => {
                Forge { target: forge.target.join("mbs").join("fused"), flags: FUSED, ..forge.clone() }
            }
            _ => forge.clone(),
        };
        let mut words = words.to_vec();
        words.extend(["--points".into(), path.clone().into_os_string()]);
        let with_feature = |blueprint: &Blueprint| blueprint.clone().with_feature(feature);
        let featured: Vec<Blueprint> = blueprints.iter().map(with_feature).collect();
        let ended = first_that_compiles(&own, &featured, &words)?;
        if ended != ExitCode::SUCCESS {
            return Err(CommandError::Failed(format!("the study with the feature `{feature}` failed")));
        }
    }
    Ok(directory)
}

/// Writes the points of a program.
///
/// # Errors
/// The file cannot be written.
pub fn write(path: &Path, points: &[Point]) -> Result<ExitCode, CommandError> {
    fs::write(path, kernels::written(points))
        .map_err(|error| CommandError::Failed(format!("cannot write {}: {error}", path.display())))?;
    Ok(ExitCode::SUCCESS)
}

/// Adds the points of other sines. Returns a name and words for each kernel, the reason where there are none.
pub fn read(directory: &Path, points: &mut Vec<Point>) -> Vec<(String, String)> {
    let of = |kernel: Kernel| {
        let name = format!("sines of the feature {}", kernel.feature().unwrap_or_default());
        let found = fs::read_to_string(file(directory, kernel))
            .map_err(|error| error.to_string())
            .and_then(|text| kernels::read(&text, kernel));
        let words = match found {
            Ok(found) => {
                points.extend(found);
                match kernel {
                    Kernel::Fused => format!("timed in a process of their own, built with `{FUSED}`"),
                    _ => "timed in a process of their own".to_string(),
                }
            }
            Err(_) if kernel == Kernel::Fused && !is_fused() => {
                "this processor has no fused products".to_string()
            }
            Err(reason) => format!("none: {reason}"),
        };
        (name, words)
    };
    KERNELS.map(of).into()
}
