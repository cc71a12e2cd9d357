//! The study of a mechanism of one's own: what of it varies, and all its variants.

use std::rc::Rc;
use std::time::{Duration, Instant};

use crate::erased::facade::AnyEquations;
use crate::erased::variations::{MovedVariants, Variable};
use crate::hard_cases::driven::driven_outcomes;
use crate::hard_cases::instants::{Instants, PARTS};
use crate::hard_cases::list::description::{Description, MethodKind};
use crate::hard_cases::list::sampled::Encoder;
use crate::hard_cases::moved::moved_outcomes;
use crate::hard_cases::oracle::{Gap, Jet, Oracle};
use crate::hard_cases::similarity::{Dimension, Similarity};
use crate::hard_cases::variation::{Class, VariedParts};
use crate::hard_cases::verdict::Outcome;
use crate::setting::{MotionMethod, Resolution};

/// Extent of a study.
#[derive(Clone, Debug)]
pub struct Extent {
    /// Methods for motions from forces.
    pub methods: Vec<MotionMethod>,
    /// Seeds of the variants.
    pub seeds: Vec<u64>,
    /// Each method runs one of the variants, in turn, the first method that of this index; none: each runs all.
    pub in_turn: Option<usize>,
    /// End of the motion (s).
    pub until: f64,
    /// Known values and bounds of a case of the list.
    pub description: Option<Description>,
}

impl Extent {
    /// `true` where a kind of method is run.
    pub fn has(&self, kind: MethodKind) -> bool {
        self.description.as_ref().is_none_or(|case| case.refused.is_some() || case.bounds.contains_key(&kind))
    }

    /// Instants of a run.
    pub fn instants(&self, resolution: Resolution) -> Instants {
        let own = self.description.as_ref().and_then(|case| case.instants);
        Instants::of(self.until, resolution, own.unwrap_or(PARTS))
    }

    /// `true` where a method runs a variant, both by their indices.
    pub fn runs(&self, method: usize, variant: usize) -> bool {
        self.in_turn.is_none_or(|first| (first + method) % self.seeds.len().max(1) == variant)
    }

    /// `true` where no run has an answer.
    pub fn is_refused(&self) -> bool {
        self.description.as_ref().is_some_and(|case| case.refused.is_some())
    }
}

/// Time that a study may take.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    began: Instant,
    allowed: Duration,
}

impl Clock {
    /// From now on.
    pub fn of(allowed: Duration) -> Self {
        Clock { began: Instant::now(), allowed }
    }

    /// `true` behind the end.
    pub fn is_over(&self) -> bool {
        self.began.elapsed() > self.allowed
    }
}

/// All variants of a mechanism.
#[derive(Clone, Debug)]
pub struct Study {
    /// One a variant and method.
    pub outcomes: Vec<Outcome>,
    /// Kinds of variants that do not suit the mechanism, with the reasons.
    pub left_out: Vec<String>,
    /// Variants that there was no time for.
    pub not_run: usize,
}

/// Makes a mechanism with values of parameters by index.
pub type Make = fn(&[(usize, f64)]) -> Variable;

/// A mechanism as the command line has it.
pub struct Own<'a> {
    /// Makes it in all variants.
    pub make: Make,
    /// Its names, values and scales.
    pub equations: &'a dyn AnyEquations,
}

impl Own<'_> {
    /// All values, with some of them changed.
    fn values(&self, changed: &[(usize, f64)]) -> Vec<(usize, f64)> {
        let own = |index: usize| Some((index, self.equations.get(index)?));
        let mut values: Vec<(usize, f64)> = (0..self.equations.variables().len()).filter_map(own).collect();
        for (index, value) in changed {
            values.iter_mut().filter(|(own, _)| own == index).for_each(|(_, own)| *own = *value);
        }
        values
    }

    fn made(&self, changed: &[(usize, f64)]) -> Variable {
        (self.make)(&self.values(changed))
    }

    /// The text with these values.
    ///
    /// # Errors
    /// The part of the text that cannot be read.
    fn oracle(&self, changed: &[(usize, f64)]) -> Result<Oracle, Gap> {
        let values = self.values(changed);
        let known = |name: &str| {
            let index = self.equations.variables().iter().position(|entry| entry.name == name)?;
            values.iter().find(|(own, _)| *own == index).map(|(_, value)| *value)
        };
        let scene = Some(self.equations.scene()).filter(|scene| *scene != mbs_codegen::WHOLE);
        let jets = self.equations.jets();
        let functions = |name: &str| {
            let index = self.equations.functions().iter().position(|entry| entry.name == name)?;
            let jets = jets.clone();
            Some(Rc::new(move |x| jets(index, x)) as Jet)
        };
        let oracle = Oracle::with_functions(self.equations.source(), scene, &known, &functions)?;
        let [text, code] = [
            [oracle.size(), oracle.row_count()],
            [self.equations.coordinates().len(), self.equations.rows().len()],
        ];
        match text == code {
            true => Ok(oracle),
            false => Err(Gap(format!(
                "the text: it counts {} coordinates and {} rows, the code {} and {}",
                text[0], text[1], code[0], code[1]
            ))),
        }
    }

    /// Parts of it that can be varied, and the kinds of variants that do not suit it.
    fn subject(&self, moved: Option<&dyn MovedVariants>) -> Result<(VariedParts, Vec<String>), String> {
        let equations = self.equations;
        let declared = mbs_codegen::variables(equations.source(), Some(equations.scene()))?;
        let index = |name: &str| equations.variables().iter().position(|entry| entry.name == name);
        let ranges = declared.iter().filter_map(|variable| {
            let [low, high] = variable.range;
            let is_range = !variable.is_input && low.is_finite() && high.is_finite() && low < high;
            Some((index(&variable.name).filter(|_| is_range)?, low, high))
        });
        let ranges: Vec<_> = ranges.collect();
        let started = moved.map(MovedVariants::started).unwrap_or_default();
        let count = equations.coordinates().len();
        let shaken: Vec<usize> = (0..count).filter(|j| !started.contains(j)).collect();
        let redundant = moved.map(MovedVariants::redundant).unwrap_or_default();
        let kinds = equations.rows().iter().enumerate().map(|(row, entry)| {
            let unit =
                entry.unit.bytes().fold(7_u64, |hash, byte| hash.wrapping_mul(31).wrapping_add(byte.into()));
            2 * unit + u64::from(redundant.get(row).copied().unwrap_or(false))
        });
        let kinds: Vec<u64> = kinds.collect();
        let points = points(equations);
        let (sized, dimensions) = self.dimensions();
        let is_similar = self.is_similar(&sized, &dimensions);
        let mut left_out = Vec::new();
        let reason = |class: Class| match class {
            Class::Parameters if ranges.is_empty() => Some("no parameter declares a range, `in 0.1..0.2`"),
            Class::Guess if shaken.is_empty() => Some("the text starts every coordinate"),
            Class::Rows | Class::Frame if moved.is_none() => {
                Some("positions of drives are solved by the blocks of the text, which no adapter has")
            }
            Class::Rows if kinds.is_empty() => Some("there are no rows"),
            Class::Frame if points.is_empty() => Some("no coordinates are the components of a point"),
            Class::Lanes if moved.is_some() => Some("lanes are for motions that drives prescribe"),
            Class::Similar if !is_similar => {
                Some("numbers with units stand in the text, or no parameter has a length or a mass")
            }
            _ => None,
        };
        let mut classes = Vec::new();
        for class in Class::ALL {
            match reason(class) {
                Some(reason) => left_out.push(format!("{}: {reason}", class.name())),
                None => classes.push(class),
            }
        }
        let scales = equations.coordinate_scales();
        Ok((VariedParts { classes, ranges, scales, shaken, points, sized, dimensions, kinds }, left_out))
    }

    /// Index, value and dimension of each parameter, and the dimensions of the coordinates; none where a unit is not known.
    fn dimensions(&self) -> (Vec<(usize, f64, Dimension)>, Vec<Dimension>) {
        let variables = self.equations.variables().iter().enumerate();
        let sized = variables
            .map(|(index, entry)| Some((index, self.equations.get(index)?, Dimension::of(entry.unit)?)));
        let coordinates = self.equations.coordinates().iter().map(|entry| Dimension::of(entry.unit));
        let (sized, coordinates): (Option<Vec<_>>, Option<Vec<_>>) = (sized.collect(), coordinates.collect());
        (sized.unwrap_or_default(), coordinates.unwrap_or_default())
    }

    /// `true` where the parameters alone give the mechanism its size.
    fn is_similar(&self, sized: &[(usize, f64, Dimension)], coordinates: &[Dimension]) -> bool {
        let similarity = Similarity { power: 3 };
        let values: Vec<_> = sized
            .iter()
            .map(|(index, value, dimension)| (*index, value * similarity.factor(*dimension)))
            .collect();
        let has_size = sized.iter().any(|(_, _, dimension)| *dimension != Dimension::default());
        let (Ok(own), Ok(other)) = (self.oracle(&[]), self.oracle(&values)) else { return false };
        has_size && coordinates.len() == own.size() && similarity.holds(&own, &other, coordinates)
    }
}

/// Components of each point among the coordinates: arrays of metres whose last length is 2 or 3.
fn points(equations: &dyn AnyEquations) -> Vec<Vec<usize>> {
    let mut points: Vec<(&str, Vec<usize>)> = Vec::new();
    for (index, entry) in equations.coordinates().iter().enumerate() {
        let Some((array, _)) = entry.name.rsplit_once('.').filter(|_| entry.unit == "m") else { continue };
        match points.iter_mut().find(|(known, _)| *known == array) {
            Some((_, components)) => components.push(index),
            None => points.push((array, vec![index])),
        }
    }
    points
        .into_iter()
        .map(|(_, components)| components)
        .filter(|point| matches!(point.len(), 2 | 3))
        .collect()
}

/// Runs all variants of a mechanism.
///
/// # Errors
/// It does not move, or its text cannot be read by the oracle at all.
pub fn study(
    own: &Own<'_>,
    extent: &Extent,
    clock: &Clock,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Study, String> {
    own.oracle(&[]).map_err(|Gap(reason)| format!("the oracle does not evaluate {reason}"))?;
    let variants = extent.seeds.len();
    let (outcomes, left_out) = match own.made(&[]) {
        Variable::Still => return Err("its rows leave coordinates free, and it has no masses".to_string()),
        Variable::Driven(_) => {
            let (subject, left_out) = own.subject(None)?;
            if let Some(case) = &extent.description
                && let Some(samples) = &case.samples
            {
                let index = own.equations.variables().iter().position(|entry| entry.name == samples.input);
                let index = index.ok_or_else(|| format!("`{}` is no input", samples.input))?;
                let mut oracle = own.oracle(&[]).map_err(|Gap(reason)| reason)?;
                let Variable::Driven(mechanism) = own.made(&[]) else { return Err("no drives".to_string()) };
                let encoder = Encoder { case, samples, index };
                let outcomes = encoder.outcomes(mechanism.as_ref(), &mut oracle, &subject, extent)?;
                return Ok(Study { outcomes, left_out, not_run: 0 });
            }
            let make = |values: &[(usize, f64)]| match own.made(values) {
                Variable::Driven(mechanism) => Some((mechanism, own.oracle(values).ok()?)),
                _ => None,
            };
            (driven_outcomes(&make, &subject, extent, clock, progress)?, left_out)
        }
        Variable::Moved(mechanism) => {
            let (subject, left_out) = own.subject(Some(mechanism.as_ref()))?;
            let make = |values: &[(usize, f64)]| match own.made(values) {
                Variable::Moved(mechanism) => Some((mechanism, own.oracle(values).ok()?)),
                _ => None,
            };
            (moved_outcomes(&make, &subject, extent, clock, progress)?, left_out)
        }
    };
    let mut run: Vec<u64> = outcomes.iter().map(|outcome| outcome.seed).collect();
    run.sort_unstable();
    run.dedup();
    // Of variants in turn no method runs some.
    let not_run = if extent.in_turn.is_some() { 0 } else { variants - run.len() };
    Ok(Study { not_run, outcomes, left_out })
}
