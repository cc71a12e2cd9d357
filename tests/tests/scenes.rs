//! Effects and scenes end to end: one text, several mechanisms, one struct of parameters.
#![forbid(unsafe_code)]
#![deny(warnings, missing_docs, unreachable_pub)]

use mbs_runtime::{AllEffects, Kinematic, Lanes, Mechanism, Stepper, mechanism};

mechanism! {
    /// A crank whose rod pushes a slider; what is driven differs.
    pub mechanism Slide;
    param r: m = 0.05;
    effect crank_driven {
        param omega: rad/s = 2;
        let rod = L;
        drive motor: theta == omega*t;
    }
    param L: m = 0.18;
    coord theta: rad = 0.8;
    coord phi: rad = 0;
    coord x: m = 0.2;
    constraint closure { r*unit(theta) + rod*unit(phi) == [x, 0]; }
    branch ahead: cos(phi) > 0;
    /// The slider leads.
    effect slider_driven {
        param stroke: m = 0.02;
        let rod = L;
        drive ram: x == 0.18m + stroke*sin(t/1s);
        branch up: sin(theta) > 0;
    }
    effect telescope {
        input extension: m, rates;
        coord rod: m = 0.18;
        drive lock: x == 0.18m;
        drive cylinder: rod == L + extension;
        branch up: sin(theta) > 0;
    }
    effect weighed { out height: m = r*sin(theta); }
    /// The crank leads.
    scene Crank = crank_driven;
    scene Ram = slider_driven + weighed;
    scene Rod = telescope + weighed;
    out tip: [m; 2] = r*unit(theta);
}

mechanism! {
    /// Scenes of the same names in the same module, and a whole that is one too.
    pub mechanism Swing;
    param level: rad = 0.1;
    coord phi: rad = 0;
    drive sway: phi == level*sin(t/1s);
    effect tip_drawn { param length: m = 2; coord tip: [m; 2]; constraint place { tip == length*unit(phi); } }
    effect none {}
    scene Crank = none;
    scene Ram = tip_drawn;
}

mechanism! {
    /// No parameter at all.
    mechanism Bare;
    coord phi: rad;
    effect fast { drive run: phi == 2*t/1s; }
    effect slow { drive run: phi == t/1s; }
    scene Fast = fast;
    scene Slow = slow;
}

mechanism! {
    /// Effects without scenes are statements.
    mechanism Plain;
    param pace: rad/s = 3;
    coord phi: rad;
    effect run { drive motor: phi == pace*t; }
}

fn at<S: Kinematic<f64, N> + Clone, const N: usize>(mechanism: S, t: f64) -> [f64; N] {
    let guess = mechanism.guess(&mechanism.parameters());
    let mut stepper = Stepper::assemble(mechanism, guess, 0.0).expect("it assembles");
    stepper.advance_to(t).expect("it moves");
    *stepper.q()
}

#[test]
fn each_scene_is_a_mechanism_of_its_own() {
    let crank: Slide<f64, __SlideScenes::Crank> = Slide { r: 0.04, ..Slide::default() };
    let [theta, phi, x] = at(crank, 0.3);
    assert!((theta - 0.6).abs() < 1e-14);
    assert!((x - 0.04 * theta.cos() - 0.18 * phi.cos()).abs() < 1e-14);
    let ram: SlideRam = crank.scene();
    let named = SlideRamCoordinates::from(at(ram, 0.3));
    assert!((named.x - 0.18 - 0.02 * 0.3_f64.sin()).abs() < 1e-14);
    // Law of cosines in the triangle of crank, rod and guide.
    let cosine = (named.x.powi(2) + 0.04_f64.powi(2) - 0.18_f64.powi(2)) / (2.0 * named.x * 0.04);
    assert!((named.theta - cosine.acos()).abs() < 1e-12);
    let mut rod: SlideRod = ram.scene();
    rod.extension.value = 0.01;
    let q = SlideRodCoordinates::from(at(rod, 0.1));
    assert!((q.rod - 0.19).abs() < 1e-14 && (q.x - 0.18).abs() < 1e-14);
    let cosine = (0.18_f64.powi(2) + 0.04_f64.powi(2) - 0.19_f64.powi(2)) / (2.0 * 0.18 * 0.04);
    assert!((q.theta - cosine.acos()).abs() < 1e-12);
}

#[test]
fn parameters_of_all_effects_are_fields_of_every_scene() {
    let mut rod = SlideRod::default();
    (rod.omega, rod.stroke, rod.r) = (7.0, 0.01, 0.03);
    let crank: SlideCrank = rod.scene();
    assert_eq!((crank.omega, crank.stroke, crank.r, crank.L), (7.0, 0.01, 0.03, 0.18));
    assert_eq!(crank.scene::<__SlideScenes::Rod>(), rod);
}

#[test]
fn a_scene_lists_what_its_statements_declare() {
    let names = |entries: &'static [mbs_runtime::Entry]| entries.iter().map(|e| e.name).collect::<Vec<_>>();
    assert_eq!(names(<SlideCrank as Mechanism<f64, 3, 3>>::VARIABLES), ["r", "omega", "L"]);
    assert_eq!(names(<SlideCrank as Mechanism<f64, 3, 3>>::OUTPUTS), ["tip.0", "tip.1"]);
    assert_eq!(names(<SlideRam as Mechanism<f64, 3, 3>>::OUTPUTS), ["height", "tip.0", "tip.1"]);
    assert_eq!(names(<SlideRam as Mechanism<f64, 3, 3>>::BRANCHES), ["ahead", "up"]);
    assert_eq!(names(<SlideRod as Mechanism<f64, 4, 4>>::COORDINATES), ["theta", "phi", "x", "rod"]);
    let mut ram = SlideRam::default();
    let stroke = <SlideRam as Mechanism<f64, 3, 3>>::variable("stroke").expect("a parameter");
    assert!(Mechanism::set(&mut ram, stroke, 0.015) && ram.stroke == 0.015);
    assert_eq!(<SlideRam as Mechanism<f64, 3, 3>>::variable("omega"), None);
}

#[test]
fn the_text_and_its_names_are_those_of_all_scenes() {
    assert_eq!(<SlideRam as Mechanism<f64, 3, 3>>::SCENE, "Ram");
    assert_eq!(<SlideRam as Mechanism<f64, 3, 3>>::NAME, "Slide");
    assert_eq!(<SlideRam as Mechanism<f64, 3, 3>>::SOURCE, <SlideRod as Mechanism<f64, 4, 4>>::SOURCE);
    assert_eq!(<Plain as Mechanism<f64, 1, 1>>::SCENE, "AllEffects");
}

#[test]
fn equal_names_of_scenes_in_one_module_are_told_apart() {
    // `Crank` alone would be ambiguous; the aliases are not.
    let [phi] = at(SwingCrank::default(), 0.5);
    assert_eq!(phi, 0.1 * 0.5_f64.sin());
    let ram = SwingRamCoordinates::from(at(SwingRam::default(), 0.5));
    assert!((ram.tip[0] - 2.0 * phi.cos()).abs() < 1e-15);
}

#[test]
fn the_whole_text_is_a_scene_where_its_effects_agree() {
    let whole: Swing = Swing { level: 0.2, ..Default::default() };
    let q = SwingCoordinates::from(at(whole, 0.5));
    assert!((q.tip[1] - 2.0 * (0.2 * 0.5_f64.sin()).sin()).abs() < 1e-15);
    let same: Swing<f64, AllEffects> = whole;
    assert_eq!(same.scene::<__SwingScenes::Ram>().length, 2.0);
}

#[test]
fn a_name_of_one_module_alone_is_the_scene() {
    assert_eq!(at(Bare::<f64, Fast>::default(), 1.5), [3.0]);
    assert_eq!(at(Bare::<f64, Slow>::default(), 1.5), [1.5]);
    assert_eq!(at(BareSlow::default(), 1.5), [1.5]);
    assert_eq!(at(Plain { pace: 2.0 }, 1.5), [3.0]);
}

#[test]
fn lanes_and_single_precision_keep_the_scene() {
    let lanes = SlideRam::<Lanes<f64, 2>> { stroke: Lanes([0.01, 0.02]), ..Default::default() };
    let second: SlideRam = lanes.lane(1);
    assert_eq!((second.stroke, second.r), (0.02, 0.05));
    let single = SlideCrank::<f32>::default();
    assert_eq!(single.omega, 2.0_f32);
}

#[test]
fn a_function_may_declare_its_own_scenes() {
    mechanism! {
        mechanism Local;
        param pace: rad/s = 3;
        coord phi: rad;
        effect ahead { drive motor: phi == pace*t; }
        effect back { drive motor: phi == -pace*t; }
        scene Ahead = ahead;
        scene Back = back;
    }
    assert_eq!(at(Local::<f64, Back>::default(), 1.0), [-3.0]);
    assert_eq!(at(LocalAhead { pace: 1.0, ..Default::default() }, 1.0), [1.0]);
}
