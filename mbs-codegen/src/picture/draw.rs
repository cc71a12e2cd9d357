//! Shapes as written → shapes with the names of their points.

use proc_macro2::Span;

use super::content::Reader;
use super::places::{PlaceKind, Places, Wanted};
use super::shape::{Along, Shape};
use crate::model::initialiser::{initialiser, numbers};
use crate::model::units::Dimension;
use crate::model::value::Fault;
use crate::syntax::ast::Expression;
use crate::syntax::picture::forms::{Form, Points, ShapeKind, Takes};
use crate::syntax::picture::{Argument, Shape as Written};

/// Label of the view along the diagonal.
const DIAGONAL: &str = "from x = y = z, z upwards";

/// Largest product of the unit vectors of a view: a hundred times the rounding of their three products.
const PERPENDICULAR: f64 = 1e-14;

/// Values of the words after the points.
#[derive(Default)]
struct Words {
    points: Vec<(&'static str, String)>,
    along: Option<Along>,
    number: f64,
    axes: Vec<(&'static str, [f64; 3])>,
    flags: Vec<&'static str>,
}

impl Words {
    fn point(&mut self, word: &str) -> String {
        let place = self.points.iter().position(|(known, _)| *known == word);
        place.map(|place| self.points.swap_remove(place).1).unwrap_or_default()
    }

    fn axis(&self, word: &str) -> Option<[f64; 3]> {
        self.axes.iter().find(|(known, _)| *known == word).map(|(_, axis)| *axis)
    }
}

/// Before: a shape as written. After: it is in the content, one a point where its form has one a point; or its faults are
/// reported.
pub fn shape(reader: &mut Reader<'_, '_>, written: &Written) -> Result<(), Fault> {
    let form = written.form;
    check_form(&mut reader.places, written)?;
    let points: Result<Vec<String>, Fault> =
        each(&written.points, |point| reader.places.place(point, Wanted::Point));
    let words = words(&mut reader.places, written);
    let (points, mut words) = (points?, words?);
    let label = label(reader, written);
    if form.points == Points::Each {
        for point in points {
            let label = if label.is_empty() { point.clone() } else { label.clone() };
            let shape = at_point(form.kind, point, label, &words);
            reader.content.shapes.extend(shape);
        }
        return Ok(());
    }
    let shape = match form.kind {
        ShapeKind::View => view(reader, written, label, &words)?,
        _ => of_points(form.kind, points, label, &mut words).ok_or(Fault)?,
    };
    reader.content.shapes.push(shape);
    Ok(())
}

/// All results, so that every fault is reported.
fn each<T, R>(items: &[T], run: impl FnMut(&T) -> Result<R, Fault>) -> Result<Vec<R>, Fault> {
    let results: Vec<Result<R, Fault>> = items.iter().map(run).collect();
    results.into_iter().collect()
}

/// The number of points, and the words that must be given.
fn check_form(places: &mut Places<'_>, written: &Written) -> Result<(), Fault> {
    let (form, found) = (written.form, written.points.len());
    let wrong = match form.points {
        Points::Exactly(count) if found != count => Some(count.to_string()),
        Points::AtLeast(count) if found < count => Some(format!("{count} or more")),
        _ => None,
    };
    if let Some(expected) = wrong {
        let (name, points) = (form.name(), if expected == "1" { "point" } else { "points" });
        let message = format!("`{name}` takes {expected} {points}, not {found}");
        return Err(places.fault(written.span, message, form.help()));
    }
    let is_given = |word: &str| written.words.iter().any(|given| given.name.text == word);
    if let Some((missing, ..)) = form.words.iter().find(|(word, _, needed)| *needed && !is_given(word)) {
        let message = format!("`{}` has no `{missing}`", form.name());
        return Err(places.fault(written.span, message, form.help()));
    }
    Ok(())
}

fn words(places: &mut Places<'_>, written: &Written) -> Result<Words, Fault> {
    let mut words = Words::default();
    let results = each(&written.words, |word| {
        let known = written.form.words.iter().find(|(known, ..)| *known == word.name.text);
        let Some((known, takes, _)) = known else { return Err(Fault) };
        match (takes, &word.argument) {
            (Takes::Point, Argument::Place(place)) => {
                words.points.push((known, places.place(place, Wanted::Point)?));
            }
            (Takes::Angle, Argument::Place(place)) => {
                words.points.push((known, places.place(place, Wanted::Angle)?));
            }
            (Takes::Direction, Argument::Place(place)) => {
                words.along = Some(Along::Named(places.place(place, Wanted::Direction)?));
            }
            (Takes::Direction, Argument::Value(value)) => {
                words.along = Some(Along::Fixed(vector(places, value)?))
            }
            (Takes::Count, Argument::Value(value)) => words.number = count(places, value)?,
            (Takes::Speed, Argument::Value(value)) => {
                let speed = Dimension::METRE.over(Dimension::SECOND);
                let [number] = constants(places, value, speed)?;
                words.number = number;
            }
            (Takes::Axis, Argument::Value(value)) => words.axes.push((known, axis(places, value)?)),
            _ => words.flags.push(known),
        }
        Ok(())
    });
    results.map(|_| words)
}

/// The components of a value, so many numbers of a unit.
fn constants<const K: usize>(
    places: &mut Places<'_>,
    value: &Expression,
    unit: Dimension,
) -> Result<[f64; K], Fault> {
    places.elaborate(|work| {
        let found = work.value(value)?;
        let found = initialiser(work, found, unit)?;
        let fits = if K == 1 { found.shape.is_empty() } else { found.shape == [K] };
        if !fits {
            let expected = if K == 1 { "a number".into() } else { format!("{K} numbers") };
            let (message, help) = (
                format!("a picture takes {expected} here, not {}", found.describe()),
                "write numbers, or constants of the text",
            );
            return Err(work.fault(found.span, message, help));
        }
        let values = numbers(work, value, &found, "a picture")?;
        <[f64; K]>::try_from(values).map_err(|_| Fault)
    })
}

fn span(value: &Expression) -> Span {
    value.code.last().map_or_else(Span::call_site, |instruction| instruction.span)
}

/// A fixed direction.
fn vector(places: &mut Places<'_>, value: &Expression) -> Result<[f64; 2], Fault> {
    let vector: [f64; 2] = constants(places, value, Dimension::NUMBER)?;
    if vector == [0.0; 2] {
        return Err(places.fault(span(value), "a direction of length 0", "write `[1, 0]` or `[0, 1]`"));
    }
    Ok(vector)
}

fn count(places: &mut Places<'_>, value: &Expression) -> Result<f64, Fault> {
    let count = places.elaborate(|work| {
        let value = work.value(value)?;
        work.count(&value)
    })?;
    if count == 0 {
        return Err(places.fault(span(value), "this count must be positive", "write a number from 1 on"));
    }
    Ok(count as f64)
}

/// A unit vector; each component is rounded once.
fn axis(places: &mut Places<'_>, value: &Expression) -> Result<[f64; 3], Fault> {
    let vector: [f64; 3] = constants(places, value, Dimension::NUMBER)?;
    let square: f64 = vector.iter().map(|x| x * x).sum();
    let unit = vector.map(|x| libm::copysign(libm::sqrt(x * x / square), x));
    if unit.iter().any(|x| !x.is_finite()) {
        return Err(places.fault(span(value), "a direction of length 0", "write `[0, 0, 1]` for instance"));
    }
    // The sign of a zero is that of the number as written, which may be negated.
    Ok(unit.map(|x| x + 0.0))
}

/// The label; empty where an earlier round of a loop drew the body before by the same statement: the shape is a further part of it.
fn label(reader: &mut Reader<'_, '_>, written: &Written) -> String {
    let Some(label) = written.label.as_ref().filter(|label| !label.text.is_empty()) else {
        return String::new();
    };
    let before = match written.form.kind {
        ShapeKind::Spring => &mut reader.spring,
        ShapeKind::Link
        | ShapeKind::Plate
        | ShapeKind::Slot
        | ShapeKind::Wheel
        | ShapeKind::Gear
        | ShapeKind::Cam
        | ShapeKind::Face => &mut reader.body,
        _ => return label.text.clone(),
    };
    let start = label.span.start();
    let place = Some((start.line, start.column));
    if *before == place {
        return String::new();
    }
    *before = place;
    label.text.clone()
}

/// A shape of one point.
fn at_point(kind: ShapeKind, at: String, label: String, words: &Words) -> Option<Shape> {
    let along = words.along.clone();
    match kind {
        ShapeKind::Ground => Some(Shape::Ground { at }),
        ShapeKind::Joint => Some(Shape::Joint { at }),
        ShapeKind::Trace => Some(Shape::Trace { of: at, label }),
        ShapeKind::Slider => along.map(|along| Shape::Slider { at, along }),
        ShapeKind::Rail => along.map(|along| Shape::Rail { at, along }),
        _ => None,
    }
}

/// A shape of several points, their number checked.
fn of_points(kind: ShapeKind, points: Vec<String>, label: String, words: &mut Words) -> Option<Shape> {
    let number = words.number;
    let first = || points.first().cloned().unwrap_or_default();
    Some(match kind {
        ShapeKind::Link => Shape::Link { points, label },
        ShapeKind::Plate => Shape::Plate { points, label },
        ShapeKind::Slot => Shape::Slot { points, label },
        ShapeKind::Spring => Shape::Spring { points: points.try_into().ok()?, label },
        ShapeKind::Wheel => Shape::Wheel { at: first(), rim: words.point("rim"), label },
        ShapeKind::Gear => {
            let inside = words.flags.contains(&"inside");
            Shape::Gear { at: first(), rim: words.point("rim"), teeth: number as u32, inside, label }
        }
        ShapeKind::Cam => {
            Shape::Cam { at: first(), contact: words.point("contact"), turn: words.point("turn"), label }
        }
        ShapeKind::Face => Shape::Face { points: points.try_into().ok()?, back: words.point("back"), label },
        ShapeKind::Geneva => Shape::Geneva {
            at: first(),
            pin: words.point("pin"),
            wheel: words.point("wheel"),
            rim: words.point("rim"),
            slots: number as u32,
        },
        ShapeKind::Road => Shape::Road { at: first(), speed: number, label },
        _ => return None,
    })
}

/// The line of sight; one a scene.
fn view(
    reader: &mut Reader<'_, '_>,
    written: &Written,
    label: String,
    words: &Words,
) -> Result<Shape, Fault> {
    reader.once("draw view", written.span)?;
    let form: &Form = written.form;
    let (right, up) = (words.axis("right"), words.axis("up"));
    if words.flags.contains(&"diagonal") && right.is_none() && up.is_none() {
        return Ok(diagonal(label));
    }
    let (Some(right), Some(up), true) = (right, up, words.flags.is_empty()) else {
        let message = "`draw view` takes `diagonal`, or `right` and `up`";
        return Err(reader.places.fault(written.span, message, form.help()));
    };
    let product: f64 = right.iter().zip(up).map(|(a, b)| a * b).sum();
    if product.abs() > PERPENDICULAR {
        let help = "choose `up` at a right angle to `right`";
        return Err(reader.places.fault(written.span, "`right` and `up` are not perpendicular", help));
    }
    Ok(Shape::View { right, up, label })
}

/// Along the diagonal of the axes, z upwards.
pub fn diagonal(label: String) -> Shape {
    let label = if label.is_empty() { DIAGONAL.into() } else { label };
    let (half, third) = (libm::sqrt(0.5), libm::sqrt(1.0 / 6.0));
    Shape::View { right: [-half, half, 0.0], up: [-third, -third, 2.0 * third], label }
}

/// A view shows points of three components alone.
pub fn check_view(places: &mut Places<'_>, shapes: &[Shape]) {
    if !shapes.iter().any(|shape| matches!(shape, Shape::View { .. })) {
        return;
    }
    let flat = places.known.iter().filter(|known| known.place.kind == PlaceKind::Point);
    let flat: Vec<(String, Span)> = flat.map(|known| (known.place.name.clone(), known.span)).collect();
    for (name, span) in flat {
        let message = format!("the point `{name}` has 2 components, and a view shows points in space");
        places.fault(span, message, "give the point three components, or remove `draw view`");
    }
}
