//! Closed form or published digits of a card, from the program that has them to that of a study.

use std::fs;
use std::path::{Path, PathBuf};

use super::CommandError;
use super::target::Target;
use crate::cost::kinematics::{self, DrivenStudy};
use crate::cost::moved::{self, MovedStudy};
use crate::cost::reference::Leg;
use crate::cost::third_leg::{Followed, ThirdLeg};
use crate::erased::facade::AnyEquations;
use crate::known_motion::KnownStates;
use crate::target_directory::target_directory;

/// Writes the states that the card of `target` knows at the instants of a study to `until` (s); the file. `is_changed`: parameters differ
/// from those of the text.
///
/// # Errors
/// The file cannot be written.
pub fn written(
    target: &Target,
    equations: &dyn AnyEquations,
    is_changed: bool,
    until: f64,
) -> Result<Option<PathBuf>, CommandError> {
    let parts = if target.is_free() { moved::PARTS } else { kinematics::PARTS };
    let times: Vec<f64> = (0..=parts).map(|k| until * f64::from(k) / f64::from(parts)).collect();
    let known = target.card().known.and_then(|known| known.states(equations, is_changed, &times));
    let Some(known) = known else { return Ok(None) };
    let directory = target_directory().join("mbs").join(target.file_name());
    let path = directory.join("known.json");
    let failed =
        |error: std::io::Error| CommandError::Failed(format!("cannot write {}: {error}", path.display()));
    fs::create_dir_all(&directory).map_err(failed)?;
    fs::write(&path, serde_json::to_string(&known).unwrap_or_default()).map_err(failed)?;
    Ok(Some(path))
}

/// The states of a file.
///
/// # Errors
/// The file cannot be read, or has no states.
pub fn read(path: &Path) -> Result<KnownStates, CommandError> {
    let failed = |error: String| CommandError::Failed(format!("cannot read {}: {error}", path.display()));
    let text = fs::read_to_string(path).map_err(|error| failed(error.to_string()))?;
    serde_json::from_str(&text).map_err(|error| failed(error.to_string()))
}

/// The third leg of a motion from forces.
pub fn of_moved(known: &KnownStates, study: &MovedStudy) -> ThirdLeg {
    let whole = study.references.iter().filter(|(_, reference)| reference.stuck.is_none());
    let followed: Vec<Followed> = whole
        .map(|(leg, reference)| Followed {
            name: match leg {
                Leg::Extrapolated => "extrapolated reference",
                Leg::Collocated => "collocated reference",
                Leg::Order8 => "explicit reference of order 8",
                Leg::Order5 => "explicit reference of order 5",
            },
            instants: reference
                .shots
                .iter()
                .map(|shot| (shot.at.t.high, &*shot.at.q, &*shot.at.qd))
                .collect(),
        })
        .collect();
    ThirdLeg::of(known, &followed, study.scales(), study.width)
}

/// The third leg of a motion from drives.
pub fn of_driven(known: &KnownStates, study: &DrivenStudy) -> ThirdLeg {
    let instants = study.motion.iter().map(|(t, [q, qd])| (*t, &**q, &**qd)).collect();
    let followed = [Followed { name: "reference", instants }];
    ThirdLeg::of(known, &followed, &study.scales, study.width_of_positions)
}
