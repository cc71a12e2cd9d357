//! Random linkages: a crank that turns fully, and dyads hung from points that move, or two points that only four rows fix together.

use std::f64::consts::TAU;
use std::fmt::Write;

/// Positions of a turn at which a linkage is looked at.
const POSITIONS: usize = 720;

/// Least sine between the bars of a dyad, and least pivot of a block over its largest entry.
const LEAST: f64 = 0.15;

type Point = [f64; 2];

/// Random numbers: xorshift with 64 bits.
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        (self.between(0.0, count as f64) as usize).min(count - 1)
    }
}

/// A dyad: two points that it hangs from, its bars, its side.
struct Dyad {
    from: [usize; 2],
    bars: [f64; 2],
    side: f64,
}

/// Texts of `count` linkages that move through a whole turn far from singular positions. Every fourth one is a block of four
/// unknowns, the others are one to five dyads; of these every second one has angles for coordinates.
pub fn texts(count: usize) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut seed = 0;
    while found.len() < count {
        seed += 1;
        let mut random = Random(0x9E37_79B9_7F4A_7C15_u64.wrapping_mul(seed));
        let name = format!("Random{}", found.len() + 1);
        let text = match found.len() % 4 {
            3 => block(&name, &mut random),
            kind => dyads(&name, &mut random, kind == 1),
        };
        found.extend(text.map(|text| (name, text)));
    }
    found
}

/// One to five dyads; `None` if it does not turn.
fn dyads(name: &str, random: &mut Random, angles: bool) -> Option<String> {
    let radius = random.between(0.1, 0.2);
    let grounds = [[0.0, 0.0], [random.between(0.7, 1.2), random.between(-0.3, 0.3)]];
    let crank = |theta: f64| [radius * theta.cos(), radius * theta.sin()];
    let mut dyads: Vec<Dyad> = Vec::new();
    let mut start = vec![crank(0.0), grounds[1], grounds[0]];
    for _ in 0..1 + random.below(5) {
        // The last two points are the ground: one of both moves.
        let moving: Vec<usize> = [0].into_iter().chain(3..start.len()).collect();
        let first = moving[random.below(moving.len())];
        let second = (first + 1 + random.below(start.len() - 1)) % start.len();
        let (p, q) = (start[first], start[second]);
        let middle = [(p[0] + q[0]) / 2.0, (p[1] + q[1]) / 2.0];
        let place =
            [middle[0] + random.between(-0.3, 0.3), middle[1] + random.between(0.4, 0.9) * sign(random)];
        let bars = [distance(place, p), distance(place, q)];
        let side = cross(p, q, place).signum();
        dyads.push(Dyad { from: [first, second], bars, side });
        start.push(place);
    }
    for k in 0..POSITIONS {
        let mut points = vec![crank(TAU * k as f64 / POSITIONS as f64), grounds[1], grounds[0]];
        for Dyad { from: [first, second], bars, side } in &dyads {
            let place = meet(points[*first], points[*second], *bars, *side)?;
            points.push(place);
        }
    }
    Some(text_of_dyads(name, radius, grounds[1], (&dyads, &start), angles))
}

fn text_of_dyads(
    name: &str,
    radius: f64,
    ground: Point,
    (dyads, start): (&[Dyad], &[Point]),
    angles: bool,
) -> String {
    let mut text = head(name, radius, ground);
    for (index, Dyad { from: [first, second], bars: [a, b], .. }) in dyads.iter().enumerate() {
        let (own, place) = (index + 3, start[index + 3]);
        if angles {
            let angle = |from: usize| (place[1] - start[from][1]).atan2(place[0] - start[from][0]);
            let (one, other) = (angle(*first), angle(*second));
            let _ = write!(
                text,
                "coord a{own}: rad = {one:.6};\ncoord b{own}: rad = {other:.6};\n\
                 let p{own} = p{first} + {a:?}m*unit(a{own});\n\
                 constraint c{own} {{ p{own} == p{second} + {b:?}m*unit(b{own}); }}\n"
            );
        } else {
            let [x, y] = place;
            let _ = write!(
                text,
                "coord p{own}: [m; 2] = [{x:.6}m, {y:.6}m];\n\
                 constraint c{own} {{\n{}{}}}\n",
                bar(&format!("p{own}"), &format!("p{first}"), *a),
                bar(&format!("p{own}"), &format!("p{second}"), *b),
            );
        }
    }
    text
}

/// A four-bar whose coupler a crank pushes through a rod.
fn block(name: &str, random: &mut Random) -> Option<String> {
    let radius = random.between(0.05, 0.12);
    let (other, ground) = (
        [random.between(0.4, 0.7), random.between(0.3, 0.6)],
        [random.between(1.1, 1.5), random.between(0.2, 0.6)],
    );
    let mut unknown = [
        other[0] + random.between(-0.2, 0.2),
        other[1] + random.between(0.5, 0.9),
        ground[0] + random.between(-0.2, 0.2),
        ground[1] + random.between(0.5, 0.9),
    ];
    let part = random.between(0.2, 0.8);
    let crank = |theta: f64| [radius * theta.cos(), radius * theta.sin()];
    let joint = |q: &[f64; 4]| [q[0] + part * (q[2] - q[0]), q[1] + part * (q[3] - q[1])];
    let (p, q) = ([unknown[0], unknown[1]], [unknown[2], unknown[3]]);
    let bars = [distance(p, other), distance(q, ground), distance(p, q)];
    let rod = distance(joint(&unknown), crank(0.0));
    let start = unknown;
    for k in 0..POSITIONS {
        let tip = crank(TAU * k as f64 / POSITIONS as f64);
        for _ in 0..4 {
            let [a, b, c, d] = unknown;
            let at = joint(&unknown);
            let [u, v] = [at[0] - tip[0], at[1] - tip[1]];
            let rows = [
                [a - other[0], b - other[1], 0.0, 0.0, half(distance([a, b], other), bars[0])],
                [0.0, 0.0, c - ground[0], d - ground[1], half(distance([c, d], ground), bars[1])],
                [a - c, b - d, c - a, d - b, half(distance([a, b], [c, d]), bars[2])],
                [(1.0 - part) * u, (1.0 - part) * v, part * u, part * v, half(distance(at, tip), rod)],
            ];
            let step = eliminated(rows)?;
            unknown.iter_mut().zip(step).for_each(|(value, step)| *value -= step);
        }
        let moved = distance([unknown[0], unknown[1]], [start[0], start[1]]);
        if moved.is_nan() || moved > 0.5 {
            return None;
        }
    }
    let [x, y, z, w] = start;
    let mut text = head(name, radius, ground);
    let _ = write!(
        text,
        "let p3 = [{:?}m, {:?}m];\ncoord p: [m; 2] = [{x:.6}m, {y:.6}m];\ncoord q: [m; 2] = [{z:.6}m, {w:.6}m];\n\
         let r = p + {part:?}*(q - p);\nconstraint loop_of_four {{\n{}{}{}}}\nconstraint rod {{\n{}}}\n",
        other[0],
        other[1],
        bar("p", "p3", bars[0]),
        bar("q", "p1", bars[1]),
        bar("p", "q", bars[2]),
        bar("r", "p0", rod),
    );
    Some(text)
}

fn head(name: &str, radius: f64, [x, y]: Point) -> String {
    format!(
        "pub mechanism {name};\ncoord theta: rad = 0;\nlet p0 = {radius:?}m*unit(theta);\nlet p1 = [{x:?}m, {y:?}m];\n\
         let p2 = [0m, 0m];\ndrive crank: theta == TAU*t/1s;\n"
    )
}

fn bar(a: &str, b: &str, length: f64) -> String {
    format!("dot({a} - {b}, {a} - {b}) == ({length:?}m)^2;\n")
}

/// Half the difference of the squares.
fn half(found: f64, length: f64) -> f64 {
    (found * found - length * length) / 2.0
}

/// The solution of four rows with their right-hand sides by pivoting; `None` next to a singular position.
fn eliminated(mut rows: [[f64; 5]; 4]) -> Option<[f64; 4]> {
    for k in 0..4 {
        let best = (k..4).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs()))?;
        rows.swap(k, best);
        if rows[k][k].abs() < LEAST {
            return None;
        }
        for i in (0..4).filter(|i| *i != k) {
            let (pivot, factor) = (rows[k], rows[i][k] / rows[k][k]);
            rows[i].iter_mut().zip(pivot).for_each(|(entry, upper)| *entry -= factor * upper);
        }
    }
    Some([0, 1, 2, 3].map(|k| rows[k][4] / rows[k][k]))
}

/// The point at these distances from two others on a side of their line; `None` where the bars come next to a line.
fn meet(p: Point, q: Point, [a, b]: [f64; 2], side: f64) -> Option<Point> {
    let d = distance(p, q);
    let along = (a * a - b * b + d * d) / (2.0 * d);
    let across = (a * a - along * along).max(0.0).sqrt();
    // d · across is twice the area, a · b · sine.
    if d * across < LEAST * a * b || !across.is_finite() {
        return None;
    }
    let [u, v] = [(q[0] - p[0]) / d, (q[1] - p[1]) / d];
    Some([p[0] + along * u - side * across * v, p[1] + along * v + side * across * u])
}

fn distance(p: Point, q: Point) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1])
}

fn cross(p: Point, q: Point, r: Point) -> f64 {
    (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
}

fn sign(random: &mut Random) -> f64 {
    if random.between(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 }
}
