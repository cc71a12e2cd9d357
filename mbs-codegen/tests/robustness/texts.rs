//! Valid texts, and words that are put among theirs.

const FOUR_BAR: &str = "
/// Four-bar linkage.
pub mechanism FourBar;
const L1: m = 0.10;
param L: [m; 3] = [0.25, 0.2, 300mm];
param omega: rad/s = TAU;
input u: rad, rates;
coord p: [m; 2];
coord phi1: rad = 0.0;
coord r#type: rad = 30deg;
coord phi3: rad = 1.8;
let a = L1*unit(phi1);
constraint point { p == a + rot(type)*[0.5*L[0], 0]; }
constraint closure {
    L[1]*cos(phi3) + L.2 == L1*cos(phi1) + L[0]*cos(type);
    for i in 0..1 { L1*sin(phi1) + L[i]*sin(type) == L[i + 1]*sin(phi3); }
}
drive crank: phi1 == omega*t + u - 2^-(-t/1s)^2;
branch open: sin(phi3 - type) > 0;
branch low at start: 0 < p.1 + 10m;
out angle: rad = phi3 - type;
out speed: [m/s; 2] = der(p);
out length: m = sum(i in 0..3: abs(L[i])) + max(norm(p), hypot(L1, L.0), 1m) + det([p, a])/1m;
";

/// Statements that the four-bar does not need.
const PRESS: &str = "
/// Press with a phase.
pub mechanism Press;
param omega: rad/s = 60rpm;
param stroke: [m; 2] = [20mm, 0.4];
input load: rad, rates;
coord phi: rad = 0.5;
coord rod: rad = -0.1;
coord x: m = 0.3;
constraint closure { 0.1m*unit(phi) + 0.3m*unit(rod) == [x, 0]; }
drive crank: rate(phi + 0.1*load) == omega*(1 + 0.1*sin(t/1s));
independent phi;
limit travel: stroke[0] - 0.1m <= x + 0.01m*sin(phi) <= 2*stroke.1;
limit lean: -1 <= rod <= 60deg;
branch ahead: cos(rod) > 0;
out speed: m/s = der(x);
out pull: m/s^2 = der2(x);
";

/// Functions and scenes.
const MACHINE: &str = "
/// A cam or a crank lifts a table.
pub mechanism Machine;
param r: m = 50mm;
function lift: m(rad), C4, periodic TAU;
coord theta: rad = 0.8;
coord y: m = 0.2;
drive motor: theta == 3*t/1s;
effect cam { constraint face { y == r + lift(theta) + 0.1*lift(r/1m); } out slope: m = lift.d1(2*theta); }
effect crank {
    param L: m = 180mm;
    coord rod: rad = -0.2;
    constraint closure { r*unit(theta) + L*unit(rod) == [y, 0]; }
    branch ahead: cos(rod) > 0;
}
effect seen { out bend: m = lift.d2(theta); }
/// Follows the law.
scene Cam = cam + seen;
scene Crank = crank;
";

/// Masses and forces.
const ARM: &str = "
/// A two-link arm whose hand slides.
pub mechanism Arm;
param m1: kg = 1.5;
param k: N/m = 120;
const C: N*m*s = 0.2;
input u: N*m;
function load: N(m), C3;
coord psi1: rad = 0.3;
coord psi2: rad = 0.8;
coord s: m = 0.2;
state z: N = 0.5;
let hand = 0.6*1m*unit(psi1) + s*unit(psi1 + psi2);
body upper { mass: m1, inertia: 0.02, com: 0.3*1m*unit(psi1), angle: psi1 }
body hold { mass: 0.4, com: hand }
gravity g { acceleration: [0.3, -9.81] }
force push: [2N + z, load(s)] on hand;
torque motor: u - C*der(psi1) on psi1;
force slip: -lambda(slot)*0.1 on s;
tsda strut { from: [200mm, -400mm], to: hand, stiffness: k, length: 0.35, damping: 4, actuator: 3N*sin(2*t/1s) }
rsda knee { angle: psi2, stiffness: 5, rest: 0.4, damping: 0.3, torque: 0.1 }
potential well = 3N/1m*s^2*cos(psi1);
kinetic rotor = 0.01 [kg*m^2]*der(psi2)*(der(psi2) + 3*der(psi1));
dissipation bearing = 0.05*C*der(psi1)^2*exp(psi2);
der(z) == (4N - z)/0.1s + 2N/1m*der(s);
constraint slot { s == 300mm + 50mm*cos(psi2); }
drive lead: psi1 == 0.3 + t/1s;
start psi2 = 0.7 rate 2;
out squeeze: N = lambda(slot) + z;
effect loose { release slot; }
out torque_1: N*m = effort(lead);
";

/// Statements of the picture.
const DRAWN: &str = "
/// A crank that is looked at.
pub mechanism Crank;
param r: [m; 2] = [50mm, 0.2];
param omega: rad/s = 30;
const N: 1 = 3;
coord theta: rad = 0.8;
drive motor: theta == omega*t;
body disc { mass: 2kg, com: 0.5*r[0]*unit(theta), inertia: 0.1, angle: theta }
pin hinge: disc, ground at [0, 0];
tsda strut { from: [0, 0], to: r[0]*unit(theta), stiffness: 3 }
out A: [m; 2] = r[0]*unit(theta);
out row: [m; 3, 2] = [[0, 0], [1, 0], A];
let A = r[0]*unit(theta);
title \"A crank\";
about \"It turns, \" \"always\";
preset fast \"at twice the speed\" { omega: 600rpm, r: [40mm, 0.1], r[1]: 2*N }
draw ground row[0], hinge;
for i in 1..N { let B = [i*r[0], 0]; draw link bars: row[i - 1], row[i], B; draw joint B; }
draw spring strut.from, strut.to;
draw slider A along [1, 0];
draw gear \"g\": hinge rim A teeth 2*N inside;
draw cam hinge contact disc.com turn theta;
draw road R: A speed 3 [m/s];
effect slow { span turn(omega); trace \"path\": A; }
effect short { span 2s; draw geneva A pin A wheel A rim A slots N; draw face A, A back A; }
scene Slow = slow { draw rail A along theta; }
scene Short = short;
";

/// Every statement of the language occurs in one of them.
/// Curves and what touches them.
const CAMS: &str = "
pub mechanism Cams;
function r: m(rad), C4, periodic TAU;
function xy: [m; 2](rad), C4, periodic TAU;
coord y: [m; 3] = 0.1m;
curve cam = polar r about [0m, 0m] turned t*3/1s;
curve rim = parametric xy[0], xy[1] about [0m, y[2]] turned -1rad;
foot u of circle([0, y[0]], 5mm) turned 2*t/1s on rim within 1m near 90deg;
foot v of flat([0m, y[1]], 80deg) on cam within 0.1m;
foot w of rim at z on cam within 8mm near 1, -2;
constraint rides { u_gap == 0; v_gap == 0m; w_gap == 0m; }
out slip: [m/s; 3] = [u_slip, v_slip, w_slip];
";

pub const TEXTS: [&str; 6] = [FOUR_BAR, PRESS, MACHINE, ARM, DRAWN, CAMS];

pub const SOUP: [&str; 118] = [
    "foot",
    "circle",
    "flat",
    "parametric",
    "within",
    "const",
    "param",
    "input",
    "coord",
    "let",
    "constraint",
    "drive",
    "branch",
    "out",
    "for",
    "in",
    "sum",
    "rates",
    "at",
    "start",
    "redundant",
    "limit",
    "independent",
    "effect",
    "release",
    "scene",
    "function",
    "periodic",
    "C2",
    "state",
    "body",
    "gravity",
    "force",
    "torque",
    "on",
    "tsda",
    "rsda",
    "potential",
    "kinetic",
    "dissipation",
    "event",
    "latch",
    "until",
    "never",
    "mass",
    "com",
    "angle",
    "lambda",
    "effort",
    "lift",
    "lift[0]",
    "[m; 2](rad)",
    "d1",
    "mechanism",
    "pub",
    "t",
    "PI",
    "TAU",
    "der",
    "der2",
    "rate",
    "sin",
    "atan2",
    "max",
    "norm",
    "dot",
    "cross",
    "det",
    "rot",
    "unit",
    "phi1",
    "p",
    "L",
    "L1",
    "omega",
    "x",
    "r#type",
    "self",
    "θ",
    "_",
    "0",
    "1",
    "2",
    "3",
    "0.5",
    "1e999",
    "1e-999",
    "100mm",
    "30deg",
    "3000rpm",
    "7furlong",
    "'c'",
    "\"s\"",
    "0x10",
    "m",
    "rad",
    "s",
    "+",
    "-",
    "*",
    "/",
    "^",
    "==",
    "<=",
    "->",
    "=",
    ">",
    "<",
    ";",
    ";",
    ",",
    ":",
    ".",
    "..",
    "#",
    "&",
    "1.",
    "\n",
];
