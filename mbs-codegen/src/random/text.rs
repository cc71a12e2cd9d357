//! Texts that use the whole language, each well defined at every state.

use super::{Features, Random};
use crate::symbolic::Unary;

/// A random text: scalar and vector coordinates, parameters, inputs with rates, `let`s, loops, drives, outputs.
pub(super) fn write(kind: Features, random: &mut Random) -> String {
    match kind {
        Features::Plain | Features::Functions => begin(random, kind.has_functions()).0,
        Features::Scenes | Features::ScenesWithFunctions => with_scenes(random, kind.has_functions()),
        Features::Masses => with_masses(random),
    }
}

/// A text with every kind of body, force and energy; forces act where coordinates move, damping is positive.
fn with_masses(random: &mut Random) -> String {
    let (mut text, mut writer) = begin(random, false);
    let row = if text.contains("drive d0") { "d0" } else { "c0" };
    text += "state z: 1 = 0.1;\n";
    let acting = [format!("(lambda({row})/1N/1m)"), String::from("z")];
    let (heavy, turning) = (writer.design(2), writer.design(2));
    text += &format!(
        "body plate {{ mass: 1kg*(1.5 + sin({heavy})), inertia: 1 [kg*m^2]*(1.5 + cos({turning})), com: 1m*({}), angle: {} }}\n",
        writer.vector(2),
        writer.scalar(2)
    );
    text += &format!("body bob {{ mass: 1kg*(2 + cos({heavy})), com: 1m*({}) }}\n", writer.vector(1));
    text += &format!("gravity g {{ acceleration: 1 [m/s^2]*[{}, -9.81] }}\n", writer.speed(1));
    text += &format!("potential well = 1N*1m*({});\n", writer.scalar(2));
    let (a, b, c) = (writer.rate(), writer.rate(), writer.scalar(1));
    text += &format!("kinetic rotor = 1 [kg*m^2]*(1.5 + sin({c}))*{a}*{b}/1 [s^2];\n");
    text += &format!("dissipation bearing = 1N*1m/1s*(1 + {a}^2)^1.5*exp(sin({c}));\n");
    let [push, twist, actuator, torque] = [0; 4].map(|_| writer.acting(&acting));
    text +=
        &format!("force push: 1N*[{push}, {}] on 1m*({} + v/3);\n", writer.acting(&acting), writer.vector(2));
    text += &format!("torque twist: 1N*1m*({twist}) on {} + 0.3*q0;\n", writer.scalar(2));
    let stiffness = if writer.random.below(2) == 0 { writer.design(1) } else { writer.scalar(1) };
    text += &format!(
        "tsda strut {{ from: 1m*[p0, 3], to: 1m*({} + v/3), stiffness: 1N/1m*(1.5 + sin({stiffness})), length: 1m*({}), damping: 1N*1s/1m*(1.5 + sin({})), actuator: 1N*({actuator}) }}\n",
        writer.vector(1),
        writer.design(1),
        writer.design(1)
    );
    text += &format!(
        "rsda knee {{ angle: {} + 0.3*q0, stiffness: 1N*1m*(1.5 + cos({})), rest: {}, damping: 1N*1m*1s*(1.5 + cos({})), torque: 1N*1m*({torque}) }}\n",
        writer.scalar(2),
        writer.design(1),
        writer.design(1),
        writer.design(1)
    );
    text += &format!("der(z) == ({})/1s;\n", writer.acting(&acting));
    text += &format!("out load: 1 = z*lambda({row})/1N/1m + {};\n", writer.acting(&acting));
    text
}

/// A text with two effects that give the same names different meanings, before or after the rest, and three scenes.
fn with_scenes(random: &mut Random, functions: bool) -> String {
    let (text, mut writer) = begin(random, functions);
    let (header, common) = text.split_once('\n').unwrap_or((&text, ""));
    writer.names.extend(["r", "own"].map(String::from));
    let mut effects = String::new();
    let owns =
        [format!("param own: 1 = {:?};", writer.random.number()), format!("let own = {};", writer.common(2))];
    for (effect, own) in ["one", "two"].iter().zip(owns) {
        effects += &format!(
            "effect {effect} {{ coord r: 1 = 0.1; {own} drive extra: r*(2.5 + sin(own)) == {}; out e: 1 = {}; }}\n",
            writer.common(2),
            writer.scalar(3)
        );
    }
    effects += &format!("effect seen {{ out also: 1 = {}; }}\n", writer.common(3));
    let scenes = "scene First = one;\nscene Second = two + seen;\nscene Third = seen;\n";
    match writer.random.below(2) {
        0 => format!("{header}\n{effects}{common}{scenes}"),
        _ => format!("{header}\n{scenes}{common}{effects}"),
    }
}

/// The text, and the writer that knows its names.
fn begin(random: &mut Random, functions: bool) -> (String, Writer<'_>) {
    let mut writer = Writer { random, names: Vec::new(), functions };
    let scalars = 1 + writer.random.below(3) as usize;
    let mut text = String::from("pub mechanism Random;\nconst C: 1 = 1.25;\nconst N: 1 = 2;\n");
    for index in 0..3 {
        text += &format!("param p{index}: 1 = {:?};\n", writer.random.number());
        writer.names.push(format!("p{index}"));
    }
    text += "param L: [1; 3] = [0.5, -1.5, 0.75];\ninput u: 1, rates;\ninput w: [1; 2], rates;\n";
    writer.names.extend(["L[0]", "L.2", "u", "w[1]", "C", "(t/1s)", "v[0]", "v.1"].map(String::from));
    if functions {
        text += "function rise: 1(1), C9;\nfunction sag: 1(1), C9;\n";
    }
    for index in 0..scalars {
        text += &format!("coord q{index}: 1 = 0.1;\n");
        // Coordinates matter most: name them often.
        writer.names.extend([format!("q{index}"), format!("q{index}")]);
    }
    text += "coord v: [1; 2] = [p0, 1];\n";
    for index in 0..writer.random.below(4) {
        text += &format!("let a{index} = {};\n", writer.scalar(3));
        writer.names.push(format!("a{index}"));
    }
    text += &format!("let b = {};\n", writer.vector(2));
    writer.names.extend(["b[0]", "b.1"].map(String::from));
    let surplus = writer.random.below(4) == 0;
    let marked = if surplus && writer.random.below(2) == 0 { "redundant " } else { "" };
    // Both sides of rows that surplus ones can follow from; a phase has no name in the text.
    let mut sides = Vec::new();
    for index in 0..scalars {
        let (left, right) = (writer.scalar(3), writer.scalar(4));
        let (before, [left, right]) = match writer.random.below(4) {
            0 => (format!("drive d{index}:"), [format!("q{index}"), writer.scalar(4)]),
            1 => {
                let driven = format!("rate(q{index}*(2.5 + sin({left})))");
                text += &format!("drive d{index}: {driven} == ({})/1s;\n", writer.speed(3));
                continue;
            }
            2 => (format!("drive d{index}:"), [format!("q{index}*(2.5 + sin({left}))"), right]),
            _ => (format!("constraint c{index} {marked}{{"), [right, format!("q{index}*(1.1 + ({left})^2)")]),
        };
        let after = if before.ends_with('{') { " }" } else { "" };
        text += &format!("{before} {left} == {right};{after}\n");
        sides.push([left, right]);
    }
    text += &match writer.random.below(3) {
        0 => {
            let (left, right) = (writer.scalar(2), writer.vector(3));
            sides.push([format!("(v*({left}) + {right})[1]"), String::from("q0")]);
            format!("constraint pair {marked}{{ v*({left}) + {right} == [v[0], q0]; }}\n")
        }
        1 => format!(
            "constraint pair {{ for i in 0..N {{ v[i]*(i + {}) == {}*L[i + 1]; }} }}\n",
            writer.scalar(2),
            writer.scalar(3)
        ),
        _ => format!("for i in 0..N {{ drive each: v[i] == {} - L[i]*v[1 - i]; }}\n", writer.scalar(3)),
    };
    if surplus && !sides.is_empty() {
        text += &writer.surplus(&sides);
    }
    text += &format!("branch open: {} > q0 + {};\n", writer.scalar(3), writer.scalar(2));
    if functions {
        // A function that is not called is a fault.
        text += &format!("out x: 1 = rise({}) - sag.d1({});\n", writer.scalar(2), writer.scalar(1));
    }
    text += &format!("out y: 1 = {};\nout z: [1; 2] = {};\n", writer.scalar(4), writer.vector(3));
    (text, writer)
}

struct Writer<'a> {
    random: &'a mut Random,
    names: Vec<String>,
    /// `true` if declared functions may be called.
    functions: bool,
}

impl Writer<'_> {
    /// A number at every state, of moderate size.
    fn scalar(&mut self, depth: u32) -> String {
        if depth == 0 || self.random.below(8) == 0 {
            return self.leaf();
        }
        let choice = self.random.below(if self.functions { 44 } else { 36 });
        let a = self.scalar(depth - 1);
        let b = if (18..36).contains(&choice) { self.scalar(depth - 1) } else { String::new() };
        match choice {
            0..=14 => self.of_one(&a),
            15 => format!("(2 + cos({a}))^-1.5"),
            16 => format!("(1.2 + sin({a}))^3"),
            17 => format!("sum(k{depth} in 0..3: L[k{depth}]*sin({a} + k{depth}))"),
            18 | 19 => format!("({a} + {b})"),
            20 | 21 => format!("({a} - {b})"),
            22..=24 => format!("{a}*({b})"),
            25 => format!("({a})/(2.5 + sin({b}))"),
            26 => format!("min({a}, {b})"),
            27 => format!("max({a}, {b}, 0.1)"),
            28 => format!("hypot({a}, 1 + ({b})^2)"),
            29 => format!("atan2({a}, 2 + cos({b}))"),
            30 => format!("(1.5 + sin({a}))^tanh({b})"),
            31 => format!("dot([{a}, C], [{b}, {a}])"),
            32 => format!("cross([{a}, {b}], [{b}, p1])"),
            33 => format!("norm([1.5 + cos({a}), {b}])"),
            34 => format!("det([[{a}, {b}, 1], [p0, {a}, 2], [C, 3, {b}]])"),
            35 => format!("(rot({a})*[{b}, p2])[{}]", self.random.below(2)),
            36 | 37 => format!("rise({a})"),
            38 | 39 => format!("sag({a})"),
            40 | 41 => format!("rise.d1({a})"),
            _ => format!("sag.d2({a})"),
        }
    }

    /// A function of one argument, any one of the table.
    fn of_one(&mut self, a: &str) -> String {
        let function = Unary::ALL[self.random.below(Unary::ALL.len() as u64) as usize];
        let argument = function.entry().domain.replace("{}", a);
        match function {
            Unary::Negate => format!("-({a})"),
            // A factor without a unit, for any unit of the argument.
            Unary::Sign => format!("sign({argument})*C"),
            _ => format!("{}({argument})", function.entry().name),
        }
    }

    /// A constraint of rows that follow from those of `sides`: multiples, sums, differences of squares.
    fn surplus(&mut self, sides: &[[String; 2]]) -> String {
        let mut rows = String::new();
        for _ in 0..=self.random.below(2) {
            let pick = |random: &mut Random| &sides[random.below(sides.len() as u64) as usize];
            let ([a, b], [c, d]) = (pick(self.random), pick(self.random));
            rows += &match self.random.below(4) {
                0 => format!(" (1.5 + sin({}))*(({a}) - ({b})) == 0;", self.scalar(1)),
                1 => format!(" ({a})^2 == ({b})^2;"),
                2 => format!(" 2*({a}) + p1*({c}) == 2*({b}) + p1*({d});"),
                _ => format!(" {b} == {a};"),
            };
        }
        format!("constraint again redundant {{{rows} }}\n")
    }

    /// A number of the names that every scene has.
    fn common(&mut self, depth: u32) -> String {
        let own = self.names.split_off(self.names.len() - 2);
        let value = self.scalar(depth);
        self.names.extend(own);
        value
    }

    /// A number that depends on no coordinate.
    fn speed(&mut self, depth: u32) -> String {
        let all = self.names.clone();
        self.names.retain(|name| !name.starts_with(['q', 'v', 'a', 'b']));
        let value = self.scalar(depth);
        self.names = all;
        value
    }

    /// A number of the parameters alone.
    fn design(&mut self, depth: u32) -> String {
        let all = self.names.clone();
        self.names.retain(|name| name.starts_with(['p', 'L', 'C']));
        let value = self.scalar(depth);
        self.names = all;
        value
    }

    /// A rate without unit.
    fn rate(&mut self) -> String {
        format!("(der(q0*cos({}))*1s)", self.scalar(1))
    }

    /// A number that may contain rates and the names of `acting` too.
    fn acting(&mut self, acting: &[String]) -> String {
        let known = self.names.len();
        let rates = [self.rate(), self.rate()];
        self.names.extend(rates);
        self.names.extend_from_slice(acting);
        let value = self.scalar(3);
        self.names.truncate(known);
        value
    }

    fn vector(&mut self, depth: u32) -> String {
        let a = self.scalar(depth);
        match self.random.below(5) {
            0 => format!("unit({a})"),
            1 => format!("rot({a})*v"),
            2 => format!("({a})*w + v/3"),
            3 => format!("-[{a}, {}]", self.scalar(depth)),
            _ => format!("[{a}, {}]", self.scalar(depth)),
        }
    }

    fn leaf(&mut self) -> String {
        if self.random.below(6) == 0 {
            return format!("({:?})", self.random.number());
        }
        let index = self.random.below(self.names.len() as u64) as usize;
        self.names[index].clone()
    }
}
